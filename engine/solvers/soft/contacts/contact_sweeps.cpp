#include "solvers/soft/contacts/contact_sweeps.hpp"

#include <algorithm>
#include <cstring>

namespace carom {
namespace {

/// Share of an overlap that one substep takes away. Below 0.15 piles sink deeper, above 0.5 they jitter.
constexpr double kRecovery = 0.4;
// Factors by which a substep's first sweep over pairs goes farther: docs/decisions/0004-soft-solver.md has
// the measurements.
constexpr double kOverRelaxation = 1.7;  // of normal impulses
constexpr double kCalmOverRelaxation = 1.3;
/// The factor of the next sweeps over pairs but the last, without friction:
/// docs/decisions/0023-frictionless-heaps.md.
constexpr double kSmoothOverRelaxation = 1.7;
/// Without friction, heaps leave contacts an overlap of so many smaller radii:
/// what moves bodies within it would not let them rest. Decision 0023 as well.
constexpr double kSmoothSlop = 0.005;
/// A contact is calm if the first sweep changes it by less than gravity does in this share of a substep.
constexpr double kCalm = 1;
/// Likewise where masses are uneven: docs/decisions/0064-uneven-masses-in-sweeps.md.
constexpr double kCalmOfUnevenMasses = 0.1;

// ns a contact on one thread, for the executor: docs/decisions/0012-threads-of-soft.md.
constexpr double kNanosecondsToSweep = 2;

/// One colour after the other. Within a batch no two contacts share a body that moves, so a whole run of
/// colours is one call, and may be cut anywhere: to leave out the blocks that the first sweep found calm.
template <class Real>
void sweep_pairs(ContactRows<Real>& pairs, std::size_t group,
                 const typename ContactSweeps<Real>::Sweep& sweep, const SolveContacts<Real>& on_pairs) {
    using Blocks = typename ContactSweeps<Real>::Blocks;
    const std::size_t first = pairs.first_place(group) / kContactBlock,
                      last = pairs.first_place(group + 1) / kContactBlock;
    const std::span<const typename ContactRows<Real>::Run> runs =
        sweep.of_runs ? sweep.of_runs->of_group(group)
                      : std::span(pairs.run.data() + first, pairs.run_count[group]);
    std::uint8_t* needs_second_sweep = pairs.needs_second_sweep.data();
    if (sweep.blocks == Blocks::all_and_mark)
        std::fill(needs_second_sweep + first, needs_second_sweep + last, std::uint8_t{0});
    if (sweep.blocks != Blocks::restless) {
        for (const auto& run : runs)
            sweep.pair_kernel(on_pairs, kHalfBlock * run.first, kHalfBlock * run.last);
        return;
    }
    const auto find = [&](int mark, std::size_t block, std::size_t last_of_run) {
        const void* found = std::memchr(needs_second_sweep + block, mark, last_of_run - block);
        return found ? static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - needs_second_sweep)
                     : last_of_run;
    };
    for (const auto& run : runs) {
        const std::size_t end = kHalfBlock * run.last, behind = (end + kHalfBlock) / kContactBlock;
        std::size_t block = kHalfBlock * run.first / kContactBlock;
        while ((block = find(1, block, behind)) < behind) {
            const std::size_t begin = kContactBlock * block;
            block = find(0, block, behind);
            sweep.pair_kernel(on_pairs, begin, std::min(kContactBlock * block, end));
        }
    }
}

/// @param candidates  which have the colours of `supports`
template <class Real>
void sweep_supports(const ContactRows<Real>& candidates, const ContactRows<Real>& supports, std::size_t group,
                    const typename ContactSweeps<Real>::Sweep& sweep,
                    const SolveContacts<Real>& on_supports) {
    for (std::size_t c = candidates.first_colour[group]; c < candidates.first_colour[group + 1]; ++c)
        sweep.support_kernel(on_supports, supports.begin[c], supports.begin[c] + supports.length(c));
}

}  // namespace

template <class Real>
SolveContacts<Real> ContactSweeps<Real>::arguments(const StepView<Real>& step, ContactRows<Real>& rows) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    SolveContacts<Real> k{};
    k.contacts = rows.columns();
    k.velocity = step.records.velocity.data(), k.displacement = step.records.displacement.data();
    k.uniform_friction = real(step.settings.friction), k.uniform_rolling = real(step.settings.rolling);
    k.inverse_h = real(1 / step.terms.substep_dt), k.h = real(step.terms.substep_dt);
    k.elapsed = real(step.terms.elapsed);
    k.recovery = real(kRecovery * step.settings.pace), k.push = real(step.settings.largest_correction);
    const double fall = step.terms.fall_speed();
    const bool is_smooth = step.settings.is_smooth_heap, are_uneven = step.settings.has_uneven_sweeps;
    const bool may_be_calm = fall > 0 && (are_uneven || !is_smooth);
    k.calm = real(may_be_calm ? (are_uneven ? kCalmOfUnevenMasses : kCalm) * fall : -1);
    k.slop = real(is_smooth ? kSmoothSlop * step.settings.radius : 0);
    const bool has_next = step.settings.iterations > 1;  // which takes back what was too much
    k.over_relaxation = has_next ? real(kOverRelaxation) : Real(1);
    k.calm_over_relaxation = has_next ? real(kCalmOverRelaxation) : Real(1);
    k.needs_second_sweep = rows.needs_second_sweep.data();
    return k;
}

template <class Real>
auto ContactSweeps<Real>::next(const StepView<Real>& step, Blocks blocks, int times) -> std::array<Sweep, 2> {
    const ContactKernels<Real>& kernels = *step.loops.contacts;
    const int relaxed = step.settings.is_smooth_heap ? std::max(times - 1, 0) : 0;
    const double farther = step.settings.has_uneven_sweeps ? kUnevenOverRelaxation : kSmoothOverRelaxation;
    return {{{kernels.next_pairs, kernels.next_supports, blocks, relaxed, farther},
             {kernels.next_pairs, kernels.next_supports, blocks, times - relaxed}}};
}

/// The phases of `sweeps` sweeps, listed anew if there have never been so many, or other parts.
template <class Real>
void ContactSweeps<Real>::list_phases(std::size_t sweeps, bool has_far, bool has_crowded) {
    has_far_ = has_far, has_crowded_ = has_crowded;
    phases_.clear(), parts_ = 0;
    part_[parts_++] = Part::chunks;
    if (has_far) part_[parts_++] = Part::far;
    part_[parts_++] = Part::borders;
    if (has_crowded) part_[parts_++] = Part::crowded_supports;
    for (std::size_t i = 0; i < parts_ * sweeps; ++i) {
        const Part part = part_[i % parts_];
        const bool is_alone = part == Part::far || part == Part::crowded_supports;
        phases_.push_back(is_alone ? PhaseKind::alone : PhaseKind::side_by_side);
    }
}

template <class Real>
void ContactSweeps<Real>::run(const StepView<Real>& step, std::span<const Sweep> sweeps,
                              const SolveContacts<Real>& on_pairs, const SolveContacts<Real>& on_supports) {
    std::size_t times = 0;
    for (const Sweep& sweep : sweeps) times += static_cast<std::size_t>(sweep.times);
    const TaskGroups& groups = step.graph.groups;
    const std::size_t* first_colour = step.graph.supports.first_colour.data();
    const bool has_far = step.graph.pairs.run_count[groups.far()] > 0,
               has_crowded = first_colour[groups.chunks] < first_colour[groups.chunks + 1];
    if (phases_.size() < parts_ * times || parts_ == 0 || has_far != has_far_ || has_crowded != has_crowded_)
        list_phases(times, has_far, has_crowded);
    const std::span<const PhaseKind> phases(phases_.data(), parts_ * times);
    const auto do_part = [&](std::size_t phase, std::size_t task) {
        const auto place = static_cast<std::uint32_t>(phase);  // a division of 32 bits is the cheaper one
        int repetition = static_cast<int>(place / parts_);
        const Part part = part_[place % parts_];
        const Sweep* of_phase = sweeps.data();
        for (; repetition >= of_phase->times; ++of_phase) repetition -= of_phase->times;
        const Sweep& sweep = *of_phase;
        const auto pair_group = [&](std::size_t group) {
            if (sweep.over_relaxation == 1) return sweep_pairs(step.graph.pairs, group, sweep, on_pairs);
            SolveContacts<Real> k = on_pairs;
            k.next_over_relaxation = static_cast<Real>(sweep.over_relaxation);
            sweep_pairs(step.graph.pairs, group, sweep, k);
        };
        const auto support_group = [&](std::size_t group) {
            sweep_supports(step.graph.supports, step.supports, group, sweep, on_supports);
        };
        const std::size_t chunk = 2 * task;
        if (part == Part::far) return pair_group(groups.far());
        if (part == Part::crowded_supports) return support_group(groups.chunks);
        if (part == Part::chunks) {
            if (chunk >= groups.chunks) return;
            pair_group(TaskGroups::inside(chunk));
            if (!groups.has_border(chunk)) return;
            pair_group(TaskGroups::across(chunk));
            pair_group(TaskGroups::inside(chunk + 1));
            return;
        }
        if (chunk > 0) {
            if (groups.has_border(chunk - 1)) pair_group(TaskGroups::across(chunk - 1));
            support_group(chunk - 1);
        }
        if (chunk < groups.chunks) support_group(chunk);
    };
    const double work = kNanosecondsToSweep * static_cast<double>(contacts_);
    step.loops.executor->for_each_phase(phases, groups.tasks(), work * static_cast<double>(sweeps.size()),
                                        do_part);
}

template class ContactSweeps<float>;
template class ContactSweeps<double>;

}  // namespace carom
