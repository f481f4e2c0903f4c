#include "solvers/soft/warm_start.hpp"

#include <algorithm>

namespace carom {
namespace {

/// Impulses of substeps that were longer or shorter by this factor are of no use.
constexpr double kOtherLength = 2;

}  // namespace

/// What lasts from step to step is force: after substeps of another length the impulses are of another size.
/// If that differs much, what was noise would become a kick: better to start from nothing, with more sweeps.
template <class Real>
void WarmStart<Real>::begin_step(ContactGraph<Real>& graph, double substep_dt) {
    is_rebalanced_ = false;
    are_known_ = substep_dt < kOtherLength * substep_dt_ && substep_dt_ < kOtherLength * substep_dt;
    kept_ = are_known_ ? substep_dt / substep_dt_ : 0;
    if (substep_dt == substep_dt_) return;
    const auto kept = static_cast<Real>(kept_);
    for (ContactRows<Real>* rows : {&graph.pairs, &graph.supports})
        for (Column<Real>* impulses :
             {&rows->normal_impulse, &rows->friction_impulse, &rows->rolling_impulse})
            for (Real& impulse : *impulses) impulse *= kept;
    substep_dt_ = substep_dt;
}

template <class Real>
void WarmStart<Real>::rebalance(const StepView<Real>& step, const Bodies<Real>& bodies) {
    is_rebalanced_ = true;
    std::vector<LostContact>& lost = step.graph.lost;
    std::sort(lost.begin(), lost.end());
    rebalance_.balance(lost, step.graph.pairs, step.supports, bodies, step.settings.friction,
                       step.settings.rolling, step.terms.gravity_change);
    lost.clear();
}

template class WarmStart<float>;
template class WarmStart<double>;

}  // namespace carom
