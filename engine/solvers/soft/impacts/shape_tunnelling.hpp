#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "narrowphase/convex_impact_time.hpp"
#include "solvers/manifolds/manifolds.hpp"
#include "solvers/substeps/body_records.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/columns/chunked_list.hpp"
#include "state/world_state.hpp"

namespace carom {

/// What Tunnelling does for discs at edges, for everything else that nothing moves: no convex shape ends a
/// step behind an edge, and no body in or behind a static or kinematic shape, that it was before.
///
/// Contacts are found by the velocities of the step's start. What a blow throws aside within the step, or a
/// kinematic shape sweeps along, may come upon what it had no contact with.
template <class Real>
class ShapeTunnelling {
  public:
    /// Puts bodies that have passed something in this step back to where they met it.
    /// Cost: 1 ns a body and 3 ns a contact with what nothing moves; about 1 us for each body that came
    /// farther than half its inradius while it had such a contact, or farther than its speed at the start
    /// tells.
    void undo(WorldState<Real>& world, const StepFlight<Real>& flight, const BodyRecords<Real>& records,
              const Manifolds<Real>& manifolds, const Executor& executor);

    std::size_t bytes() const {
        return swift_.capacity() * sizeof(std::int32_t) + chosen_.bytes() + is_swift_.capacity() +
               near_.bytes() + near_bodies_.capacity() * sizeof(std::int32_t);
    }

  private:
    /// What undo() is called with.
    struct Inputs {
        WorldState<Real>& world;
        const StepFlight<Real>& flight;
        const BodyRecords<Real>& records;
    };
    /// A body over a step: straight on, and evenly turned.
    struct Way {
        std::size_t row;
        Vec2 start, end;       // m
        double angle, turned;  // rad, at the start; over the step
    };
    /// The middle of a body, or of a piece of it, which is to be in nothing else.
    struct Core {
        Vec2 from, to;  // m, at the start and at the end of the step
        double radius;  // m
        Core seen_from(const EdgePose& pose) const;
    };
    /// What the core of a body has met first.
    struct Passed {
        double time = 2;                 // share of the step; above 1: nothing
        EdgePose pose;                   // of the body that was passed
        Vec2 point, normal;              // m, in its frame: where; into it, of length 1
        ConvexShape<double> obstacle{};  // in its frame
    };
    void list_swift(const Inputs& in, const Manifolds<Real>& manifolds, const Executor& executor);
    void mark(std::size_t row);
    bool comes_upon_edges(const Inputs& in, std::span<const EdgePair> pairs) const;
    void look_at(const Inputs& in, std::size_t row);
    Passed first_passed(const Inputs& in, const Way& way, bool is_last);
    static bool sinks_in(const Core& core, const Edge& edge);
    void look_at_edges(const Inputs& in, const Way& way, const Core& core, bool is_last, Passed& first);
    void look_at_body(const Inputs& in, const Way& way, const Core& core, std::size_t other,
                      Passed& first) const;
    void put_back(const Inputs& in, Way& way, const Passed& passed, bool to_start);
    void stop(const Inputs& in, const Way& way, const Passed& passed);

    std::vector<std::int32_t> swift_;     // rows that may have passed something
    ChunkedList chosen_;                  // of rows, then of contacts, before they are marked
    std::vector<std::uint8_t> is_swift_;  // by row; all zero but within undo()
    Column<std::int32_t> near_;
    std::vector<std::int32_t> near_bodies_;  // with edges
};

extern template class ShapeTunnelling<float>;
extern template class ShapeTunnelling<double>;

}  // namespace carom
