#pragma once

#include "solvers/contact_sets/coarse_correction.hpp"
#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/contacts/contact_sweeps.hpp"

namespace carom {

/// The loads of large piles are corrected on a coarse grid, between the first sweep of a step's last substep
/// and the next (solvers/contact_sets/coarse_correction.hpp).
template <class Real>
class LoadCorrection {
  public:
    /// Fewer bodies are never corrected.
    static constexpr std::size_t fewest_bodies(bool heaves_if_slender) {
        return heaves_if_slender ? CoarseCorrection<Real>::kFewestOfSlender
                                 : CoarseCorrection<Real>::kFewestLoaded;
    }
    /// To be called once a substep, `number` from 0 on.
    /// @return whether it is for `correct` to do what follows the first sweep
    bool begin_substep(const StepView<Real>& step, int number, bool is_last);
    /// Corrects the loads, if that is due, and sweeps once more.
    void correct(const StepView<Real>& step, const StepFlight<Real>& flight, ContactSweeps<Real>& sweeps,
                 PathSolver<Real>& paths);
    /// Takes back from the impulses what is not to last. After the books of the step, which have them as they
    /// were.
    void retain(const StepView<Real>& step, ContactSweeps<Real>& sweeps, PathSolver<Real>& paths);

    std::size_t bytes() const { return coarse_.bytes(); }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.coarse_);
    }

  private:
    PathLoads<Real> path_arguments(const StepView<Real>& step, const Real* motion);
    SolveContacts<Real> arguments(const StepView<Real>& step, ContactRows<Real>& rows);

    CoarseCorrection<Real> coarse_;
    bool is_due_ = false;        // in this substep
    bool is_corrected_ = false;  // in this step
};

extern template class LoadCorrection<float>;
extern template class LoadCorrection<double>;

}  // namespace carom
