#pragma once

#include <cstdint>
#include <vector>

#include "solvers/soft/contacts/contact_sweeps.hpp"
#include "solvers/soft/contacts/step_view.hpp"

namespace carom {

/// Pairs that the sweeps of a substep leave closing so fast that they would be deep in each other behind it,
/// or pushed apart: discs that lie on others and are hit by a third one, faster than two sweeps can hand on.
///
/// In the chunks of rows in which something is hit in the step (constraints/task_groups.hpp) further sweeps
/// go over all contacts that can touch, until none is deep. A contact that the first sweep found calm is
/// among them: what presses it may have come later in the sweep. docs/decisions/0089-discs-that-are-hit.md.
template <class Real>
class DeepContacts {
  public:
    /// To be called when the contacts of a step are found.
    /// @param motion  [rows][4] at the start of the step
    /// @param chunks  in which pairs meet in the step as in a hit; empty: none
    void begin_step(const StepView<Real>& step, const Column<Real>& motion,
                    const std::vector<std::uint8_t>& chunks);
    /// Nothing can touch any more.
    void clear() { is_hit_.clear(), follows_hit_ = false; }
    /// Whether something may be hit in this step.
    bool expects_hits() const { return !is_hit_.empty(); }
    /// After all else that solves contacts in a substep, where something may be hit.
    /// Cost: a third of a sweep over the contacts of these chunks, and, where some are deep, up to
    /// kMostFurtherSweeps sweeps over those and their neighbours.
    void solve(const StepView<Real>& step, ContactSweeps<Real>& sweeps);

    std::size_t bytes() const {
        return is_hit_.capacity() + is_deep_.capacity() + is_swept_.capacity() + runs_.bytes();
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.follows_hit_);
    }

  private:
    bool find_deep(const StepView<Real>& step, const SolveContacts<Real>& k,
                   const std::vector<std::uint8_t>& chunks);
    void list_runs(const StepView<Real>& step);

    bool follows_hit_ = false;            // the next step: it begins with the impulses of a hit
    std::vector<std::uint8_t> is_hit_;    // [chunks]; empty: nothing is
    std::vector<std::uint8_t> is_deep_;   // [groups]
    std::vector<std::uint8_t> is_swept_;  // [chunks]: those that deep contacts are in, and beside them
    PairRuns<Real> runs_;                 // of these
};

extern template class DeepContacts<float>;
extern template class DeepContacts<double>;

}  // namespace carom
