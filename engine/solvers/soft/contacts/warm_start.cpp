#include "solvers/soft/contacts/warm_start.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

/// While steps vary, forces of contacts are means over so many times in which a body of the usual radius
/// falls .005 of it from rest, .05 s for discs of .5 m: what a short step needed to stop a slow approach
/// would be a kick in a long one, and a longer mean lags behind what presses on small bodies
/// (docs/decisions/0030-steps-of-any-length.md).
constexpr double kFallsOfMean = 2.2;
/// Steps count as varying until their length has been the same for so many of these means.
constexpr double kMeansOfVarying = 10;

}  // namespace

/// What lasts from step to step is force: after substeps of another length the impulses are of another size.
/// Without gravity they are those of blows, mostly, which are no larger for a longer substep.
template <class Real>
void WarmStart<Real>::begin_step(ContactGraph<Real>& graph, double substep_dt, double dt,
                                 double longest_substep) {
    is_rebalanced_ = false;
    are_known_ = substep_dt_ > 0;
    kept_ = are_known_ ? substep_dt / substep_dt_ : 0;
    if (longest_substep == 0) kept_ = std::fmin(kept_, 1);
    dt_ = dt, mean_over_ = kFallsOfMean * longest_substep;
    if (substep_dt == substep_dt_ && varying_left_ == 0) return;
    varying_left_ = are_known_ && substep_dt != substep_dt_ ? kMeansOfVarying * mean_over_
                                                            : std::max(0.0, varying_left_ - dt);
    const auto kept = static_cast<Real>(kept_);
    const std::array<Column<Real>*, 6> impulses = impulses_of(graph);
    if (substep_dt != substep_dt_)
        for (Column<Real>* column : impulses)
            for (Real& impulse : *column) impulse *= kept;
    substep_dt_ = substep_dt;
    if (!(varying_left_ > 0) || !(dt < mean_over_)) return;
    for (std::size_t i = 0; i < impulses.size(); ++i) before_[i] = *impulses[i];
}

template <class Real>
void WarmStart<Real>::end_step(ContactGraph<Real>& graph) {
    if (!(varying_left_ > 0) || !(dt_ < mean_over_)) return;
    const auto share = static_cast<Real>(dt_ / mean_over_);
    const std::array<Column<Real>*, 6> impulses = impulses_of(graph);
    for (std::size_t i = 0; i < impulses.size(); ++i)
        for (std::size_t k = 0; k < std::min(impulses[i]->size(), before_[i].size()); ++k) {
            Real& impulse = (*impulses[i])[k];
            impulse = before_[i][k] + share * (impulse - before_[i][k]);
        }
}

template <class Real>
void WarmStart<Real>::rebalance(const StepView<Real>& step, const Bodies<Real>& bodies) {
    std::vector<LostContact>& lost = step.graph.lost;
    std::sort(lost.begin(), lost.end());
    is_rebalanced_ = rebalance_.balance(lost, step.graph.pairs, step.supports, bodies, step.settings.friction,
                                        step.settings.rolling, step.terms.gravity_change);
    lost.clear();
}

template class WarmStart<float>;
template class WarmStart<double>;

}  // namespace carom
