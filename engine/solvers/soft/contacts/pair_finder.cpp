#include "solvers/soft/contacts/pair_finder.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

// ns a contact on one thread, for the executor: docs/decisions/0012-threads-of-soft.md.
constexpr double kNanosecondsToFindPair = 3;

/// Computes what stays the same in a group until the pairs change.
/// @param inverse  1/kg, of bodies, with any sign; null: all have the same
template <class Real>
void describe_group(ContactRows<Real>& pairs, std::size_t group, const Bodies<Real>& bodies,
                    const Real* inverse) {
    for (std::size_t c = pairs.first_colour[group]; c < pairs.first_colour[group + 1]; ++c) {
        const std::size_t end = pairs.begin[c] + padded(pairs.length(c)),
                          from = pairs.stride(c) > 1 ? pairs.begin[c] : pairs.begin[c] + pairs.count[c];
        for (Column<Real>* column : {&pairs.mass, &pairs.reach, &pairs.smaller, &pairs.friction,
                                     &pairs.rolling, &pairs.rolling_share})
            if (!column->empty()) std::fill(column->data() + from, column->data() + end, Real(0));  // padding
    }
    const Real same = static_cast<Real>(bodies.inverse_mass(0)), same_radius = bodies.radius.uniform_value();
    // Locals, which no store of a number can change.
    const std::int32_t *row_a = pairs.a.data(), *row_b = pairs.b.data();
    const Real* radius = bodies.radius.data();
    Real *reach = pairs.reach.data(), *mass = pairs.mass.data(),
         *smaller = pairs.smaller.empty() ? nullptr : pairs.smaller.data();
    pairs.for_each(group, group + 1, [&](std::size_t i) {
        const auto a = static_cast<std::size_t>(row_a[i]), b = static_cast<std::size_t>(row_b[i]);
        const Real radius_a = radius ? radius[a] : same_radius, radius_b = radius ? radius[b] : same_radius;
        reach[i] = radius_a + radius_b;
        if (smaller) smaller[i] = std::min(radius_a, radius_b);
        const Real of_a = inverse ? std::fabs(inverse[a]) : same,
                   of_b = inverse ? std::fabs(inverse[b]) : same;
        mass[i] = Real(1) / (of_a + of_b);
        if (!pairs.friction.empty()) pairs.friction[i] = std::sqrt(bodies.friction[a] * bodies.friction[b]);
        if (!pairs.rolling.empty())
            pairs.rolling[i] = std::max(bodies.rolling_resistance[a], bodies.rolling_resistance[b]);
        if (!pairs.rolling_share.empty()) pairs.rolling_share[i] = radius_b / reach[i];
    });
}

/// Lists runs of blocks of a group that have contacts which can touch. Inlined where all groups are found: a
/// call for each is .1 % of a step of 30 discs.
template <class Real>
[[gnu::always_inline]] inline void list_runs(ContactRows<Real>& pairs, std::size_t group) {
    typename ContactRows<Real>::Run* const list = pairs.run.data() + pairs.first_place(group) / kContactBlock;
    std::size_t runs = 0;
    for (std::size_t c = pairs.first_colour[group]; c < pairs.first_colour[group + 1]; ++c) {
        const std::size_t stride = pairs.stride(c), end = pairs.begin[c] + pairs.length(c);
        for (std::size_t at = pairs.begin[c]; at < end; at += kContactBlock) {
            if (!pairs.is_live[at / kContactBlock]) continue;
            const std::size_t half = at / kHalfBlock, filled = stride > 1 ? 1 : end - at;
            if (runs == 0 || list[runs - 1].last != half)
                list[runs++].first = static_cast<std::uint32_t>(half);
            list[runs - 1].last = static_cast<std::uint32_t>(half + (filled > kHalfBlock ? 2 : 1));
        }
    }
    pairs.run_count[group] = runs;
}

template <class Real>
FindContacts<Real> arguments(ContactRows<Real>& pairs, const ContactSettings& settings, double dt,
                             const Column<Real>& motion) {
    const bool radius_varies = settings.effects.radius_varies;
    FindContacts<Real> k{};
    k.motion = motion.data();
    k.a = pairs.a.data(), k.b = pairs.b.data(), k.reach = pairs.reach.data();
    k.normal_impulse = pairs.normal_impulse.data(), k.friction_impulse = pairs.friction_impulse.data();
    k.rolling_impulse = settings.effects.rolling ? pairs.rolling_impulse.data() : nullptr;
    k.normal_x = pairs.normal_x.data(), k.normal_y = pairs.normal_y.data();
    k.separation = pairs.separation.data();
    k.approach = settings.effects.restitution ? pairs.approach.data() : nullptr;
    k.smaller = radius_varies ? pairs.smaller.data() : nullptr;
    k.dt = static_cast<Real>(dt);
    k.near = static_cast<Real>(settings.contact_distance(radius_varies ? 0 : settings.radius));
    k.near_of_smaller = static_cast<Real>(kNearFraction);
    k.deep = static_cast<Real>(-settings.deep_overlap(settings.radius));
    k.is_live = pairs.is_live.data(), k.pace = static_cast<Real>(settings.pace);
    if (settings.sweeps_hits)
        k.is_struck = pairs.is_struck.data(), k.strike = static_cast<Real>(kStrike * settings.radius);
    return k;
}

/// Leaves out blocks of a group whose contacts are near only because all of their bodies are fast.
/// @return how many contacts of the group can touch
template <class Real>
std::size_t leave_out_flying(const FindContacts<Real>& k, const FlightFrames<Real>& frames,
                             ContactRows<Real>& pairs, std::size_t group) {
    std::size_t count = 0;
    const std::size_t first = pairs.first_place(group) / kContactBlock,
                      last = pairs.first_place(group + 1) / kContactBlock;
    for (std::size_t block = first; block < last; ++block) {
        if (!pairs.is_live[block]) continue;
        std::size_t live = 0;
        for (std::size_t i = kContactBlock * block; i < kContactBlock * (block + 1); ++i) {
            if (!(k.reach[i] > 0)) continue;  // padding
            const Real *a = k.motion + 4 * static_cast<std::size_t>(k.a[i]),
                       *b = k.motion + 4 * static_cast<std::size_t>(k.b[i]), *frame = frames.of(k.a[i]);
            const Real ways = std::fabs(a[2] - frame[0]) + std::fabs(a[3] - frame[1]) +
                              std::fabs(b[2] - frame[0]) + std::fabs(b[3] - frame[1]);
            const Real at_rest = k.near + (k.smaller ? k.near_of_smaller * k.smaller[i] : Real(0));
            const Real near = k.reach[i] + at_rest + k.dt * ways, dx = b[0] - a[0], dy = b[1] - a[1];
            live += dx * dx + dy * dy < near * near;
        }
        count += live;
        if (live > 0 || pairs.is_live[block] == kDeepBlock) continue;
        pairs.is_live[block] = 0;
        for (Real* impulse : {k.normal_impulse, k.friction_impulse, k.rolling_impulse})
            if (impulse) std::fill_n(impulse + kContactBlock * block, kContactBlock, Real(0));
    }
    return count;
}

}  // namespace

template <class Real>
bool PairFinder<Real>::find(const StepView<Real>& step, const Bodies<Real>& bodies,
                            const BodyMasses<Real>& masses, const Column<Real>& motion, bool flies_together) {
    const ContactGraph<Real>& graph = step.graph;
    ContactRows<Real>& pairs = step.graph.pairs;
    // What is added between renewals changes the last group alone.
    const bool is_new = version_ != graph.version, are_all_new = renewal_ != graph.renewals;
    if (is_new) pairs.resize_for_step(step.settings.effects);
    const FindContacts<Real> k = arguments(pairs, step.settings, step.terms.dt, motion);
    frames_.clear();
    if (flies_together) frames_.find(graph, bodies, motion);
    const double work = kNanosecondsToFindPair * static_cast<double>(pairs.a.size());
    step.loops.executor->for_each_task(graph.groups.count(), work, [&](std::size_t group) {
        if (are_all_new || (is_new && group == graph.groups.far()))
            describe_group(pairs, group, bodies, masses.inverse());
        pairs.live_count[group] =
            step.loops.kernels->find_contacts(k, pairs.first_place(group), pairs.first_place(group + 1));
        if (!frames_.empty()) pairs.live_count[group] = leave_out_flying(k, frames_, pairs, group);
        list_runs(pairs, group);
    });
    has_thrown_.clear();
    if (k.is_struck && find_thrown(step, k)) reach_thrown(step, k);
    has_deep_pairs_ =
        std::find(pairs.is_live.begin(), pairs.is_live.end(), kDeepBlock) != pairs.is_live.end();
    version_ = graph.version, renewal_ = graph.renewals;
    return is_new;
}

/// Finds how fast bodies that are hit in this step are thrown at most: as fast as those come that hit them.
/// @return whether there are any
template <class Real>
bool PairFinder<Real>::find_thrown(const StepView<Real>& step, const FindContacts<Real>& k) {
    const ContactRows<Real>& pairs = step.graph.pairs;
    const TaskGroups& groups = step.graph.groups;
    bool any = false;
    for (std::size_t block = 0; block < pairs.is_struck.size(); ++block) {
        if (!k.is_struck[block]) continue;
        if (!any) thrown_.assign(step.records.count(), Real(0)), has_thrown_.assign(groups.chunks, 0);
        any = true;
        for (std::size_t i = kContactBlock * block; i < kContactBlock * (block + 1); ++i) {
            if (!(k.reach[i] > 0)) continue;  // padding
            const auto a = static_cast<std::size_t>(k.a[i]), b = static_cast<std::size_t>(k.b[i]);
            const Real approach = (k.motion[4 * a + 2] - k.motion[4 * b + 2]) * k.normal_x[i] +
                                  (k.motion[4 * a + 3] - k.motion[4 * b + 3]) * k.normal_y[i];
            const Real strike = k.smaller ? k.strike * k.smaller[i] : k.strike;
            if (!(k.dt * approach > strike) || !(k.dt * approach > k.separation[i])) continue;
            for (const std::size_t row : {a, b}) {
                thrown_[row] = std::max(thrown_[row], approach);
                has_thrown_[groups.chunk_of(static_cast<std::int32_t>(row))] = 1;
            }
        }
    }
    return any;
}

/// Takes in the blocks that bodies which are thrown may come to touch in this step.
template <class Real>
void PairFinder<Real>::reach_thrown(const StepView<Real>& step, const FindContacts<Real>& k) {
    ContactRows<Real>& pairs = step.graph.pairs;
    const TaskGroups& groups = step.graph.groups;
    const double work = static_cast<double>(pairs.a.size());
    step.loops.executor->for_each_task(groups.count(), work, [&](std::size_t group) {
        if (!groups.touches(group, has_thrown_)) return;
        std::size_t found = 0;
        for (std::size_t block = pairs.first_place(group) / kContactBlock;
             block < pairs.first_place(group + 1) / kContactBlock; ++block) {
            if (pairs.is_live[block]) continue;
            std::size_t live = 0;
            for (std::size_t i = kContactBlock * block; i < kContactBlock * (block + 1); ++i) {
                if (!(k.reach[i] > 0)) continue;
                const auto a = static_cast<std::size_t>(k.a[i]), b = static_cast<std::size_t>(k.b[i]);
                const Real thrown = std::max(thrown_[a], thrown_[b]);
                if (!(thrown > 0)) continue;
                const Real *x_a = k.motion + 4 * a, *x_b = k.motion + 4 * b;
                const Real ways =
                               std::fabs(x_a[2]) + std::fabs(x_a[3]) + std::fabs(x_b[2]) + std::fabs(x_b[3]),
                           near = k.reach[i] + k.dt * (ways + thrown), dx = x_b[0] - x_a[0],
                           dy = x_b[1] - x_a[1];
                live += dx * dx + dy * dy < near * near;
            }
            if (live > 0) pairs.is_live[block] = 1, found += live;
        }
        if (found == 0) return;
        pairs.live_count[group] += found;
        list_runs(pairs, group);
    });
}

template class PairFinder<float>;
template class PairFinder<double>;

}  // namespace carom
