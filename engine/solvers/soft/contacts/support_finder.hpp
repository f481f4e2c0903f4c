#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "constraints/support_surface.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Finds which of the coloured supports can touch in a step, and how: what nothing moves, as contacts see it,
/// which is walls, static and kinematic bodies, sleepers and edges. Contacts that are out of reach lose their
/// impulses; a disc that rolls from one edge of a chain to the next takes them along.
template <class Real>
class SupportFinder {
  public:
    /// Fills step.supports, and turns the velocities of discs as the curves do that hold them. Cost:
    /// O(supports).
    /// @param joined  [rows], above zero for bodies that have joints; null where there are none
    /// @param books   gets what turns discs
    void find(const StepView<Real>& step, const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
              const Real* joined, Books& books);

    /// A curve that led a disc has held it, whatever it carried besides: the next step is told so.
    /// @param candidates  with the impulses of the step that ends
    void remember_led(ContactRows<Real>& candidates, const ContactRows<Real>& supports) const;

    std::size_t bytes() const {
        return left_edges_.capacity() * sizeof(LeftEdge) + hold_.capacity() +
               velocity_.capacity() * sizeof(Vec2);
    }

  private:
    /// What a body felt from an edge that it has left.
    struct LeftEdge {
        std::int32_t row, track, candidate;  // of the disc; of the edge
        Real normal_impulse, friction_impulse, rolling_impulse;
    };
    /// What `find` is called with.
    struct Search {
        const StepView<Real>& step;
        const WorldState<Real>& world;
        const EdgeCandidates<Real>& edges;
    };
    void note_pressing(const Search& search);
    void lead_discs(const Search& search, const Real* joined, Books& books);
    static bool is_curve_at_rest(const Search& search, std::int32_t edge);
    std::optional<Vec2> velocity_along_curve(const Search& search, std::size_t row, std::int32_t edge) const;
    void give_turn(const Search& search, std::size_t row, std::size_t of_edge, Books& books);
    Vec2 velocity_of(const Bodies<Real>& bodies, std::size_t row) const {
        if (!hold_.empty() && hold_[row] == EdgeHold::led) return velocity_[row];
        return {bodies.velocity_x[row], bodies.velocity_y[row]};
    }
    void find_in_group(std::size_t group, const Search& search);
    void note_left_edge(std::size_t candidate, std::size_t group, const Search& search);
    void hand_on_impulses(const Search& search);

    std::vector<EdgeHold> hold_;                        // by row; none where there are no edges
    std::vector<Vec2> velocity_;                        // m/s, by row, of what is led
    std::vector<LeftEdge> left_edges_;                  // of this step
    std::vector<std::vector<LeftEdge>> left_edges_of_;  // a group of supports
};

extern template class SupportFinder<float>;
extern template class SupportFinder<double>;

}  // namespace carom
