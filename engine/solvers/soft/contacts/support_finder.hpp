#pragma once

#include <cstdint>
#include <vector>

#include "solvers/soft/step_view.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Finds which of the coloured supports can touch in a step, and how: what nothing moves, as contacts see it,
/// which is walls, static and kinematic bodies, sleepers and edges. Contacts that are out of reach lose their
/// impulses; a disc that rolls from one edge of a chain to the next takes them along.
template <class Real>
class SupportFinder {
  public:
    /// Fills step.supports. Cost: O(supports).
    void find(const StepView<Real>& step, const WorldState<Real>& world, const EdgeCandidates<Real>& edges);

    std::size_t bytes() const {
        return left_edges_.capacity() * sizeof(LeftEdge) + presses_on_edges_.capacity();
    }

  private:
    /// What a body felt from an edge that it has left.
    struct LeftEdge {
        std::int32_t row, body, candidate;  // of the disc; number of the edge's body
        Real normal_impulse, friction_impulse, rolling_impulse;
    };
    /// What `find` is called with.
    struct Search {
        const StepView<Real>& step;
        const WorldState<Real>& world;
        const EdgeCandidates<Real>& edges;
    };
    void note_pressing(const Search& search);
    void find_in_group(std::size_t group, const Search& search);
    void note_left_edge(std::size_t candidate, std::size_t group, const Search& search);
    void hand_on_impulses(const Search& search);

    std::vector<std::uint8_t> presses_on_edges_;        // by row; unused where there are no edges
    std::vector<LeftEdge> left_edges_;                  // of this step
    std::vector<std::vector<LeftEdge>> left_edges_of_;  // a group of supports
};

extern template class SupportFinder<float>;
extern template class SupportFinder<double>;

}  // namespace carom
