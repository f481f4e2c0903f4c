// The loads of large piles are corrected on a coarse grid, between the first sweep of a substep and the next.
#include "solvers/soft/soft_solver.hpp"

namespace carom {

template <class Real>
SolveContacts<Real> SoftSolver<Real>::coarse_arguments(ContactRows<Real>& live) {
    SolveContacts<Real> k = arguments(live);
    k.reach = live.reach.data();
    k.load = coarse_.load(), k.stress = coarse_.stress(), k.scale = coarse_.scale();
    k.kept = static_cast<Real>(coarse_.kept());
    return k;
}

template <class Real>
void SoftSolver<Real>::correct_loads(const Column<Real>& motion) {
    if (!is_correction_due_) return;
    const ContactKernels<Real>& kernels = contact_kernels();
    coarse_.begin(velocity_.size() / 4);
    const SolveContacts<Real> on_pairs = coarse_arguments(graph.pairs),
                              on_supports = coarse_arguments(supports_);
    const Sweep sum{kernels.sum_loads_pairs, kernels.sum_loads_supports},
        scale{kernels.scale_loads_pairs, kernels.scale_loads_supports};
    sweep({&sum, 1}, on_pairs, on_supports);
    is_corrected_ = coarse_.find_scale(count_, motion.data(), velocity_.data(), largest_radius_,
                                       gravity_change_, *executor_);
    if (is_corrected_) sweep({&scale, 1}, on_pairs, on_supports);
    const Sweep next = next_sweep(Sweep::Blocks::all, iterations - 1);
    sweep({&next, 1}, arguments(graph.pairs), arguments(supports_));
}

/// After the books of the step, which have the impulses as they were.
template <class Real>
void SoftSolver<Real>::retain_correction() {
    if (!is_corrected_) return;
    is_corrected_ = false;
    const ContactKernels<Real>& kernels = contact_kernels();
    const Sweep keep{kernels.keep_loads_pairs, kernels.keep_loads_supports};
    sweep({&keep, 1}, coarse_arguments(graph.pairs), coarse_arguments(supports_));
}

template SolveContacts<float> SoftSolver<float>::coarse_arguments(ContactRows<float>&);
template SolveContacts<double> SoftSolver<double>::coarse_arguments(ContactRows<double>&);
template void SoftSolver<float>::correct_loads(const Column<float>&);
template void SoftSolver<double>::correct_loads(const Column<double>&);
template void SoftSolver<float>::retain_correction();
template void SoftSolver<double>::retain_correction();

}  // namespace carom
