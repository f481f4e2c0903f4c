#include "solvers/soft/corrections/load_correction.hpp"

namespace carom {

template <class Real>
bool LoadCorrection<Real>::begin_substep(const StepView<Real>& step, int number, bool is_last) {
    const bool has_next = step.settings.iterations > 1;
    return is_due_ = has_next && is_last && length_squared(step.terms.gravity_change) > 0 &&
                     coarse_.is_due(step.records.moving(), number + 1,
                                    fewest_bodies(step.settings.heaves_if_slender));
}

template <class Real>
SolveContacts<Real> LoadCorrection<Real>::arguments(const StepView<Real>& step, ContactRows<Real>& rows) {
    SolveContacts<Real> k = ContactSweeps<Real>::arguments(step, rows);
    k.reach = rows.reach.data();
    k.load = coarse_.load(), k.stress = coarse_.stress(), k.scale = coarse_.scale();
    k.kept = static_cast<Real>(coarse_.kept());
    return k;
}

template <class Real>
PathLoads<Real> LoadCorrection<Real>::path_arguments(const StepView<Real>& step, const Real* motion) {
    return {.load = coarse_.load(),
            .stress = coarse_.stress(),
            .scale = coarse_.scale(),
            .motion = motion,
            .last_row = static_cast<std::int32_t>(step.records.count()) - 1,
            .kept = static_cast<Real>(coarse_.kept())};
}

template <class Real>
void LoadCorrection<Real>::correct(const StepView<Real>& step, const StepFlight<Real>& flight,
                                   ContactSweeps<Real>& sweeps, PathSolver<Real>& paths) {
    if (!is_due_) return;
    using Sweep = typename ContactSweeps<Real>::Sweep;
    const ContactKernels<Real>& kernels = *step.loops.contacts;
    const BodyRecords<Real>& records = step.records;
    coarse_.begin(records.velocity.size() / 4);
    const SolveContacts<Real> on_pairs = arguments(step, step.graph.pairs),
                              on_supports = arguments(step, step.supports);
    const Sweep sum{kernels.sum_loads_pairs, kernels.sum_loads_supports},
        scale{kernels.scale_loads_pairs, kernels.scale_loads_supports};
    sweeps.run(step, {&sum, 1}, on_pairs, on_supports);
    const PathLoads<Real> on_paths = path_arguments(step, flight.motion.data());
    using PathPasses = PathKernels<Real>;
    paths.run_loads(&PathPasses::sum_loads, on_paths, step.terms, step.records, step.loops);
    is_corrected_ = coarse_.find_scale(records.moving(), flight.motion.data(), records.velocity.data(),
                                       flight.candidates.largest_radius(), step.terms.gravity_change,
                                       *step.loops.executor);
    if (is_corrected_) {
        sweeps.run(step, {&scale, 1}, on_pairs, on_supports);
        paths.run_loads(&PathPasses::scale_loads, on_paths, step.terms, step.records, step.loops);
        paths.sweep(step.terms, step.records, step.loops);
    }
    sweeps.run(step,
               ContactSweeps<Real>::next(step, ContactSweeps<Real>::Blocks::all, step.settings.next_sweeps));
}

template <class Real>
void LoadCorrection<Real>::retain(const StepView<Real>& step, ContactSweeps<Real>& sweeps,
                                  PathSolver<Real>& paths) {
    if (!is_corrected_) return;
    is_corrected_ = false;
    const ContactKernels<Real>& kernels = *step.loops.contacts;
    const typename ContactSweeps<Real>::Sweep keep{kernels.keep_loads_pairs, kernels.keep_loads_supports};
    sweeps.run(step, {&keep, 1}, arguments(step, step.graph.pairs), arguments(step, step.supports));
    paths.run_loads(&PathKernels<Real>::retain_loads, path_arguments(step, nullptr), step.terms, step.records,
                    step.loops);
}

template class LoadCorrection<float>;
template class LoadCorrection<double>;

}  // namespace carom
