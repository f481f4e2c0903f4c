#pragma once

#include <cstdint>
#include <vector>

#include "constraints/contact_rows.hpp"
#include "parallel/executor.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/columns/chunked_list.hpp"
#include "state/world_state.hpp"

namespace carom {

/// The last line of defence of solver `soft` against tunnelling: nothing ends a step behind an edge that it
/// was before.
///
/// Contacts are planes for the length of a step. That is wrong where a very fast disc slides along one edge
/// into another, where an edge turns so far in one step that it overtakes what it pushes, and where a slow
/// disc is shot out of its margin, in the middle of a step, through an edge that was none of its candidates.
template <class Real>
class Tunnelling {
  public:
    /// Puts discs that have got past an edge in this step back to it.
    /// @param supports  all that the contact graph has
    /// Cost: O(bodies + supports); for each disc that was shot out of its margin O(bodies with edges that
    /// move) and what is near its way
    void undo(WorldState<Real>& world, const StepFlight<Real>& flight, const ContactRows<Real>& supports,
              const Executor& executor);

    std::size_t bytes() const {
        return crossings_.capacity() * sizeof(Crossing) + strays_.bytes() +
               near_bodies_.capacity() * sizeof(std::int32_t);
    }

  private:
    /// A disc whose centre crossed an edge.
    struct Crossing {
        std::int32_t row, edge;
        double time;       // share of the step
        Vec2 from, point;  // m, in the frame of the edge's body: before, and where it crossed
    };
    void note_crossing(const WorldState<Real>& world, const StepFlight<Real>& flight, std::int32_t disc,
                       std::int32_t number);
    void note_crossings(const WorldState<Real>& world, const StepFlight<Real>& flight, std::int32_t disc);
    void find_strays(const WorldState<Real>& world, const StepFlight<Real>& flight, const Executor& executor);
    void find_crossings(const WorldState<Real>& world, const StepFlight<Real>& flight,
                        const ContactRows<Real>& supports);
    void put_back(WorldState<Real>& world, const StepFlight<Real>& flight, const Crossing& passed,
                  bool to_start);

    std::vector<Crossing> crossings_;  // of this step
    bool is_last_ = false;             // round of undo()
    ChunkedList strays_;               // rows that have left their margins in this step
    std::vector<std::int32_t> near_bodies_;
};

extern template class Tunnelling<float>;
extern template class Tunnelling<double>;

}  // namespace carom
