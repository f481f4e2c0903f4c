#include "solvers/soft/corrections/deep_contacts.hpp"

#include <algorithm>

#include "state/columns/index.hpp"

namespace carom {
namespace {

// docs/decisions/0089-discs-that-are-hit.md has what else was tried.

// Shares of the smaller radius.

/// Bodies are pressed into each other if they come nearer by so much in a substep than they may,
constexpr double kPressed = 0.012;
/// and overlap by more than this behind it.
constexpr double kOverlap = 0.05;

/// Further sweeps of a substep at most.
constexpr int kMostFurtherSweeps = 16;
/// The factor by which they go farther.
constexpr double kFurtherOverRelaxation = 1.3;
// ns a contact on one thread, for the executor.
constexpr double kNanosecondsToLook = 0.7;

}  // namespace

/// What falls on a wall may be pressed by others that fly with it: no pair tells of that.
template <class Real>
void DeepContacts<Real>::begin_step(const StepView<Real>& step, const Column<Real>& motion,
                                    const std::vector<std::uint8_t>& chunks) {
    is_hit_ = chunks;
    const TaskGroups& groups = step.graph.groups;
    const ContactRows<Real>& supports = step.supports;
    const auto dt = static_cast<Real>(step.terms.dt),
               strike = static_cast<Real>(kStrike * step.settings.radius);
    supports.for_each([&](std::size_t i) {
        const Real* at = motion.data() + 4 * index(supports.a[i]);
        const Real way =
            dt * (at[2] * supports.normal_x[i] + at[3] * supports.normal_y[i] - supports.surface_normal[i]);
        const Real least = supports.smaller.empty() ? strike : strike * supports.smaller[i];
        if (!(way > least) || !(way > supports.separation[i])) return;
        if (is_hit_.empty()) is_hit_.assign(groups.chunks, 0);
        is_hit_[groups.chunk_of(supports.a[i])] = 1;
    });
    const bool is_hit = expects_hits();
    if (follows_hit_) is_hit_.assign(groups.chunks, 1);
    follows_hit_ = is_hit;
}

/// Finds the groups that have deep contacts, among those of bodies of some chunks. @return whether there are
/// any
template <class Real>
bool DeepContacts<Real>::find_deep(const StepView<Real>& step, const SolveContacts<Real>& k,
                                   const std::vector<std::uint8_t>& chunks) {
    const ContactRows<Real>& pairs = step.graph.pairs;
    is_deep_.assign(pairs.groups(), 0);
    const double radius = step.settings.radius;
    const DeepPairs<Real> what{static_cast<Real>(kPressed * radius), static_cast<Real>(kOverlap * radius)};
    const double work = kNanosecondsToLook * static_cast<double>(pairs.a.size());
    step.loops.executor->for_each_task(pairs.groups(), work, [&](std::size_t group) {
        if (!step.graph.groups.touches(group, chunks)) return;
        const auto* const run = pairs.run.data() + pairs.first_place(group) / kContactBlock;
        is_deep_[group] = std::any_of(run, run + pairs.run_count[group], [&](const auto& blocks) {
            return step.loops.kernels->find_deep(k, what, kHalfBlock * blocks.first,
                                                 kHalfBlock * blocks.last);
        });
    });
    return std::find(is_deep_.begin(), is_deep_.end(), 1) != is_deep_.end();
}

/// Lists the contacts of the chunks that have deep ones, and of those beside them.
template <class Real>
void DeepContacts<Real>::list_runs(const StepView<Real>& step) {
    const ContactRows<Real>& pairs = step.graph.pairs;
    const TaskGroups& groups = step.graph.groups;
    is_swept_.assign(groups.chunks, 0);
    for (std::size_t group = 0; group < pairs.groups(); ++group) {
        if (!is_deep_[group]) continue;
        // Far contacts may be anywhere.
        const std::size_t chunk = group / 2, first = group == groups.far() ? 0 : chunk - (chunk > 0),
                          last = group == groups.far() ? groups.chunks : chunk + 2 + group % 2;
        std::fill(is_swept_.begin() + static_cast<std::ptrdiff_t>(first),
                  is_swept_.begin() + static_cast<std::ptrdiff_t>(std::min(last, groups.chunks)),
                  std::uint8_t{1});
    }
    runs_.list(step.graph, is_swept_);
}

template <class Real>
void DeepContacts<Real>::solve(const StepView<Real>& step, ContactSweeps<Real>& sweeps) {
    using Sweep = typename ContactSweeps<Real>::Sweep;
    const SolveContacts<Real> on_pairs = ContactSweeps<Real>::arguments(step, step.graph.pairs),
                              on_supports = ContactSweeps<Real>::with_rows(on_pairs, step.supports);
    if (!find_deep(step, on_pairs, is_hit_)) return;
    Sweep further{step.loops.contacts->next_pairs, step.loops.contacts->next_supports};
    further.over_relaxation = kFurtherOverRelaxation, further.of_runs = &runs_;
    for (int i = 0; i < kMostFurtherSweeps; ++i) {
        list_runs(step);
        sweeps.run(step, {&further, 1}, on_pairs, on_supports);
        if (!find_deep(step, on_pairs, is_swept_)) return;
    }
}

template class DeepContacts<float>;
template class DeepContacts<double>;

}  // namespace carom
