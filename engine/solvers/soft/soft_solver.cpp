#include "solvers/soft/soft_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "effects/flight.hpp"
#include "effects/friction.hpp"
#include "effects/restitution.hpp"
#include "effects/touching.hpp"

namespace carom {
namespace {

/// Share of an overlap that one substep takes away. Below 0.15 piles sink deeper, above 0.5 they jitter.
constexpr double kRecovery = 0.4;
// Of pairs in a substep's first sweep: docs/decisions/0004-soft-solver.md has the measurements.
constexpr double kOverRelaxation = 1.7;  // of normal impulses
constexpr double kCalmOverRelaxation = 1.3;
/// A contact is calm if the first sweep changes it by less than gravity does in this share of a substep.
constexpr double kCalm = 1;
/// Bodies as near as this, in radii of the smaller one, are solved together even if they hardly move: what
/// pushes one of them in the middle of a step is felt by the other.
constexpr double kNearFraction = 0.04;
/// Bodies that start a step with an overlap of this share of the smaller radius are parted at its end.
constexpr double kDeep = 0.1;
/// Next sweeps of the first substep if there are no impulses to start from, unless none are asked for.
constexpr int kFirstSweeps = 32;
/// Impulses of substeps that were longer or shorter by this factor are of no use.
constexpr double kOtherLength = 2;

static_assert(kContactBlock == kRowPadding);

// ns a contact on one thread, for the executor: docs/decisions/0012-threads-of-soft.md.
constexpr double kNanosecondsToFind = 3, kNanosecondsToSweep = 2;
constexpr double kNanosecondsToBegin = 0.7, kNanosecondsToAdvance = 1;  // a body
constexpr std::size_t kRowsPerTask = 1024;                              // where there is but one group

}  // namespace

template <class Real>
void SoftSolver<Real>::derive_masses(const Bodies<Real>& bodies) {
    if (masses_are_known_) return;
    described_version_ = described_renewal_ = -1;
    masses_vary_ = !bodies.mass.is_uniform() || bodies.has_flags;
    some_are_fixed_ = false;
    if (masses_vary_) inverse_mass_.resize(bodies.count);
    double lightest = 0, heaviest = 0;  // inverse
    for (std::size_t row = 0; row < bodies.count && masses_vary_; ++row) {
        const bool is_fixed = has_friction_ && (bodies.flags_of(row) & kFixedAngle) != 0;
        const double inverse = bodies.inverse_mass(row);
        inverse_mass_[row] = static_cast<Real>(is_fixed ? -inverse : inverse);
        some_are_fixed_ = some_are_fixed_ || is_fixed;
        if (!(inverse > 0)) continue;
        lightest = std::fmax(lightest, inverse);
        heaviest = heaviest > 0 ? std::fmin(heaviest, inverse) : inverse;
    }
    are_masses_uneven_ = lightest > LocalSolve<Real>::kUneven * heaviest;
    uneven_.clear();
    masses_are_known_ = true;
}

template <class Real>
StartColumns<Real> SoftSolver<Real>::start_columns() {
    return {start_x_.data(), start_y_.data(), has_rotation_ ? start_rim_.data() : nullptr};
}

template <class Real>
std::size_t SoftSolver<Real>::rows_per_task() const {
    return graph.groups.chunks > 1 ? graph.groups.rows_per_chunk : kRowsPerTask;
}

template <class Real>
const ContactKernels<Real>& SoftSolver<Real>::contact_kernels() const {
    if (!has_friction_) return kernels_->contacts[0];
    return kernels_->contacts[(rolls_ ? 3u : 1u) + (some_are_fixed_ ? 1u : 0u)];
}

template <class Real>
void SoftSolver<Real>::begin_substeps(const WorldState<Real>& world, const Column<Real>& motion, double h,
                                      const Vec2 gravity, const KernelTable<Real>& kernels,
                                      const Executor& executor) {
    const Bodies<Real>& bodies = world.bodies;
    kernels_ = &kernels, executor_ = &executor;
    count_ = bodies.count, substep_dt_ = h;
    has_friction_ = world.effects.friction, has_rotation_ = world.effects.rotation;
    bounces_ = world.effects.restitution;
    friction_varies_ = has_friction_ && !bodies.friction.is_uniform();
    uniform_friction_ =
        bodies.friction.is_uniform() ? static_cast<double>(bodies.friction.uniform_value()) : 0;
    rolls_ = world.effects.rolling_resistance;
    rolling_varies_ = rolls_ && !bodies.rolling_resistance.is_uniform();
    uniform_rolling_ = static_cast<double>(bodies.rolling_resistance.uniform_value());
    radius_varies_ = !bodies.radius.is_uniform();
    uniform_radius_ = radius_varies_ ? 1 : static_cast<double>(bodies.radius.uniform_value());
    derive_masses(bodies);
    const FlightClock clock = flight_clock_at(h, world.drag.linear);
    gravity_change_ = clock.s * gravity, decay_ = clock.u;
    spin_decay_ = flight_clock_at(h, world.drag.angular).u;

    // Beyond the bodies a record for the padding of each group, so that no two tasks write to the same.
    const std::size_t rows = padded(count_ + ContactGraph<Real>::padding_rows(graph.groups));
    velocity_.resize(4 * rows), displacement_.resize(2 * rows);
    turn_.resize(has_rotation_ ? rows : 0);
    start_x_.resize(rows), start_y_.resize(rows), start_rim_.resize(has_rotation_ ? rows : 0);
    const auto real = [](double value) { return static_cast<Real>(value); };
    BeginSubsteps<Real> k{};
    k.motion = motion.data();
    k.angular_velocity = has_rotation_ ? bodies.angular_velocity.data() : nullptr;
    k.radius = bodies.radius.data(), k.uniform_radius = bodies.radius.uniform_value();
    k.inverse_mass = masses_vary_ ? inverse_mass_.data() : nullptr;
    k.uniform_inverse_mass = count_ > 0 ? real(bodies.inverse_mass(0)) : Real(0);
    k.gain_x = real(gravity_change_.x), k.gain_y = real(gravity_change_.y), k.decay = real(decay_),
    k.spin_decay = real(spin_decay_);
    k.velocity = velocity_.data(), k.start = start_columns();
    k.displacement = displacement_.data(), k.turn = has_rotation_ ? turn_.data() : nullptr;
    const auto kernel = kernels.begin_substeps[has_rotation_ ? 1 : 0];
    executor.for_each_chunk(
        count_, rows_per_task(), kNanosecondsToBegin,
        [&](std::size_t, std::size_t first, std::size_t last) { kernel(k, first, padded(last)); });
    // Padding must not fall.
    std::fill(velocity_.data() + 4 * count_, velocity_.data() + 4 * rows, Real(0));
    for (Column<Real>* column : {&start_x_, &start_y_, &start_rim_})
        if (!column->empty()) std::fill(column->data() + count_, column->data() + rows, Real(0));
    elapsed_ = 0;
}

template <class Real>
ContactEffects SoftSolver<Real>::contact_effects() const {
    return {has_friction_,   bounces_,       rolls_,        friction_varies_,
            rolling_varies_, radius_varies_, radius_varies_};
}

template <class Real>
SolveContacts<Real> SoftSolver<Real>::arguments(ContactRows<Real>& live) {
    SolveContacts<Real> k{};
    k.contacts = live.columns();
    k.velocity = velocity_.data(), k.displacement = displacement_.data();
    k.uniform_friction = static_cast<Real>(uniform_friction_);
    k.uniform_rolling = static_cast<Real>(uniform_rolling_);
    k.inverse_h = static_cast<Real>(1 / substep_dt_), k.h = static_cast<Real>(substep_dt_);
    k.elapsed = static_cast<Real>(elapsed_);
    k.recovery = static_cast<Real>(kRecovery), k.push = static_cast<Real>(push_);
    const double fall = std::sqrt(length_squared(gravity_change_));
    k.calm = static_cast<Real>(fall > 0 ? kCalm * fall : -1);
    const bool has_next = iterations > 1;  // which takes back what was too much
    k.over_relaxation = has_next ? static_cast<Real>(kOverRelaxation) : Real(1);
    k.calm_over_relaxation = has_next ? static_cast<Real>(kCalmOverRelaxation) : Real(1);
    k.needs_second_sweep = live.needs_second_sweep.data();
    return k;
}

template <class Real>
double SoftSolver<Real>::contact_distance(double radius) const {
    return kNearFraction * radius + fall_;
}

template <class Real>
double SoftSolver<Real>::deep_overlap(double radius) const {
    return kDeep * radius;
}

/// What stays the same until the pairs change.
template <class Real>
void SoftSolver<Real>::describe_group(const Bodies<Real>& bodies, std::size_t group) {
    ContactRows<Real>& pairs = graph.pairs;
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
    const Real *radius = bodies.radius.data(), *inverse = masses_vary_ ? inverse_mass_.data() : nullptr;
    Real *reach = pairs.reach.data(), *mass = pairs.mass.data(),
         *smaller = radius_varies_ ? pairs.smaller.data() : nullptr;
    pairs.for_each(group, group + 1, [&](std::size_t i) {
        const auto a = static_cast<std::size_t>(row_a[i]), b = static_cast<std::size_t>(row_b[i]);
        const Real radius_a = radius ? radius[a] : same_radius, radius_b = radius ? radius[b] : same_radius;
        reach[i] = radius_a + radius_b;
        if (smaller) smaller[i] = std::min(radius_a, radius_b);
        const Real of_a = inverse ? std::fabs(inverse[a]) : same,
                   of_b = inverse ? std::fabs(inverse[b]) : same;
        mass[i] = Real(1) / (of_a + of_b);
        if (friction_varies_) pairs.friction[i] = std::sqrt(bodies.friction[a] * bodies.friction[b]);
        if (!pairs.rolling.empty())
            pairs.rolling[i] = std::max(bodies.rolling_resistance[a], bodies.rolling_resistance[b]);
        if (!pairs.rolling_share.empty()) pairs.rolling_share[i] = radius_b / reach[i];
    });
}

/// Runs of blocks of a group that have contacts which can touch.
template <class Real>
void SoftSolver<Real>::list_runs(std::size_t group) {
    const std::size_t first = graph.pairs.first_place(group) / kContactBlock,
                      last = graph.pairs.first_place(group + 1) / kContactBlock;
    ContactRows<Real>& live = graph.pairs;
    std::size_t runs = 0;
    for (std::size_t block = first; block < last; ++block) {
        if (!live.is_live[block]) continue;
        const bool follows = runs > 0 && live.run[first + runs - 1].last == block;
        if (!follows) live.run[first + runs++].first = static_cast<std::uint32_t>(block);
        live.run[first + runs - 1].last = static_cast<std::uint32_t>(block + 1);
    }
    live.run_count[group] = runs;
}

template <class Real>
void SoftSolver<Real>::find_pairs(const Bodies<Real>& bodies, const Column<Real>& motion) {
    // What is added between renewals changes the last group alone.
    const bool is_new = described_version_ != graph.version,
               are_all_new = described_renewal_ != graph.renewals;
    if (is_new) graph.pairs.resize_for_step(contact_effects());
    FindContacts<Real> k{};
    k.motion = motion.data();
    k.a = graph.pairs.a.data(), k.b = graph.pairs.b.data(), k.reach = graph.pairs.reach.data();
    k.normal_impulse = graph.pairs.normal_impulse.data(),
    k.friction_impulse = graph.pairs.friction_impulse.data();
    k.rolling_impulse = rolls_ ? graph.pairs.rolling_impulse.data() : nullptr;
    k.normal_x = graph.pairs.normal_x.data(), k.normal_y = graph.pairs.normal_y.data();
    k.separation = graph.pairs.separation.data(),
    k.approach = bounces_ ? graph.pairs.approach.data() : nullptr;
    k.smaller = radius_varies_ ? graph.pairs.smaller.data() : nullptr;
    k.dt = static_cast<Real>(dt_);
    k.near = static_cast<Real>(contact_distance(radius_varies_ ? 0 : uniform_radius_));
    k.near_of_smaller = static_cast<Real>(kNearFraction);
    k.deep = static_cast<Real>(-deep_overlap(uniform_radius_));
    k.is_live = graph.pairs.is_live.data();
    const double work = kNanosecondsToFind * static_cast<double>(graph.pairs.a.size());
    executor_->for_each_task(graph.groups.count(), work, [&](std::size_t group) {
        if (are_all_new || (is_new && group == graph.groups.far())) describe_group(bodies, group);
        graph.pairs.live_count[group] =
            kernels_->find_contacts(k, graph.pairs.first_place(group), graph.pairs.first_place(group + 1));
        list_runs(group);
    });
    is_crowded_ = std::find(graph.pairs.is_live.begin(), graph.pairs.is_live.end(), kDeepBlock) !=
                  graph.pairs.is_live.end();
    described_version_ = graph.version, described_renewal_ = graph.renewals;
    if (is_new && are_masses_uneven_) uneven_.find(graph.pairs, inverse_mass_, count_);
}

/// What lasts from step to step is force: after substeps of another length the impulses are of another size.
/// If that differs much, what was noise would become a kick: better to start from nothing, with more sweeps.
template <class Real>
void SoftSolver<Real>::rescale_impulses(ContactRows<Real>& candidates) const {
    if (substep_dt_ == impulses_of_h_) return;
    const double ratio = impulses_of_h_ > 0 ? substep_dt_ / impulses_of_h_ : 0;
    const auto kept = static_cast<Real>(are_impulses_known_ ? ratio : 0);
    for (Column<Real>* impulses :
         {&candidates.normal_impulse, &candidates.friction_impulse, &candidates.rolling_impulse})
        for (Real& impulse : *impulses) impulse *= kept;
}

template <class Real>
void SoftSolver<Real>::find_contacts(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                     const EdgeCandidates<Real>& edges, Column<Real>& motion, double dt) {
    motion.resize(4 * padded(count_ + ContactGraph<Real>::padding_rows(graph.groups)));
    dt_ = dt;
    largest_radius_ = candidates.largest_radius();
    // A body that falls from rest, in substeps h of g h each, beside one that is held, comes nearer by
    // g dt (dt + h) / 2 at most.
    fall_ = 0.5 * std::sqrt(length_squared(gravity_change_)) * dt * (dt / substep_dt_ + 1);
    push_ = kPushRadiiPerSecond * uniform_radius_ * substep_dt_;
    are_impulses_known_ =
        substep_dt_ < kOtherLength * impulses_of_h_ && impulses_of_h_ < kOtherLength * substep_dt_;
    rescale_impulses(graph.pairs), rescale_impulses(graph.supports);
    impulses_of_h_ = substep_dt_;
    find_pairs(world.bodies, motion);
    find_supports(world, edges);
    uneven_.begin_step(graph.pairs, supports_);
    is_unloaded_ = false;
    for (ContactRows<Real>* live : {&graph.pairs, &supports_})
        if (bounces_)
            for (Column<Real>* column : {&live->largest_impulse, &live->bounce_impulse})
                std::fill(column->begin(), column->end(), Real(0));
    counters.contacts = static_cast<std::int64_t>(
        std::accumulate(graph.pairs.live_count.begin(), graph.pairs.live_count.end(), supports_.contacts()));
    counters.colours = static_cast<std::int64_t>(graph.pairs.count.size());
    counters.overflow = static_cast<std::int64_t>(graph.pairs.overflow());
}

template <class Real>
void SoftSolver<Real>::rebalance_loads(const Bodies<Real>& bodies) {
    is_unloaded_ = true;
    std::sort(graph.lost.begin(), graph.lost.end());
    unloading_.balance(graph.lost, graph.pairs, supports_, bodies, uniform_friction_, uniform_rolling_,
                       gravity_change_);
    graph.lost.clear();
}

template <class Real>
void SoftSolver<Real>::warm_start() {
    const Sweep once{contact_kernels().warm_start_pairs, contact_kernels().warm_start_supports};
    sweep({&once, 1}, arguments(graph.pairs), arguments(supports_));
}

/// One colour after the other. Within a batch no two contacts share a body that moves, so a whole run of
/// colours is one call, and may be cut anywhere: to leave out the blocks that the first sweep found calm.
template <class Real>
void SoftSolver<Real>::sweep_pairs(std::size_t group, const Sweep& sweep,
                                   const SolveContacts<Real>& on_pairs) {
    const std::size_t first = graph.pairs.first_place(group) / kContactBlock,
                      last = graph.pairs.first_place(group + 1) / kContactBlock;
    const typename ContactRows<Real>::Run* run = graph.pairs.run.data() + first;
    std::uint8_t* needs_second_sweep = graph.pairs.needs_second_sweep.data();
    if (sweep.blocks == Sweep::Blocks::all_and_mark)
        std::fill(needs_second_sweep + first, needs_second_sweep + last, std::uint8_t{0});
    if (sweep.blocks != Sweep::Blocks::restless) {
        for (std::size_t i = 0; i < graph.pairs.run_count[group]; ++i)
            sweep.pair_kernel(on_pairs, kContactBlock * run[i].first, kContactBlock * run[i].last);
        return;
    }
    for (std::size_t i = 0; i < graph.pairs.run_count[group]; ++i)
        for (std::size_t block = run[i].first; block < run[i].last; ++block) {
            const std::size_t begin = block;
            while (block < run[i].last && needs_second_sweep[block]) ++block;
            if (block > begin) sweep.pair_kernel(on_pairs, kContactBlock * begin, kContactBlock * block);
        }
}

template <class Real>
void SoftSolver<Real>::sweep_supports(std::size_t group, const Sweep& sweep,
                                      const SolveContacts<Real>& on_supports) const {
    for (std::size_t c = graph.supports.first_colour[group]; c < graph.supports.first_colour[group + 1]; ++c)
        sweep.support_kernel(on_supports, supports_.begin[c], supports_.begin[c] + supports_.length(c));
}

/// All contacts once a sweep, in the order that task_groups.hpp explains.
template <class Real>
void SoftSolver<Real>::sweep(std::span<const Sweep> sweeps, const SolveContacts<Real>& on_pairs,
                             const SolveContacts<Real>& on_supports) {
    using Kind = typename SweepPart::Kind;
    const TaskGroups& groups = graph.groups;
    const bool any_far = graph.pairs.run_count[groups.far()] > 0,
               any_crowded = graph.supports.first_colour[groups.chunks] <
                             graph.supports.first_colour[groups.chunks + 1];
    sweep_parts_.clear(), sweep_phases_.clear();
    const auto add_part = [&](Kind kind, const Sweep& sweep, PhaseKind phase) {
        sweep_parts_.push_back({kind, &sweep}), sweep_phases_.push_back(phase);
    };
    for (const Sweep& sweep : sweeps)
        for (int i = 0; i < sweep.times; ++i) {
            add_part(Kind::chunks, sweep, PhaseKind::side_by_side);
            if (any_far) add_part(Kind::far, sweep, PhaseKind::alone);
            add_part(Kind::borders, sweep, PhaseKind::side_by_side);
            if (any_crowded) add_part(Kind::crowded_supports, sweep, PhaseKind::alone);
        }
    const double work = kNanosecondsToSweep * static_cast<double>(counters.contacts);
    const auto run = [&](std::size_t phase, std::size_t task) {
        const Sweep& sweep = *sweep_parts_[phase].sweep;
        const Kind kind = sweep_parts_[phase].kind;
        const auto pair_group = [&](std::size_t group) { sweep_pairs(group, sweep, on_pairs); };
        const auto support_group = [&](std::size_t group) { sweep_supports(group, sweep, on_supports); };
        const std::size_t chunk = 2 * task;
        if (kind == Kind::far) return pair_group(groups.far());
        if (kind == Kind::crowded_supports) return support_group(groups.chunks);
        if (kind == Kind::chunks) {
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
    executor_->for_each_phase(sweep_phases_, groups.tasks(), work * static_cast<double>(sweeps.size()), run);
}

template <class Real>
auto SoftSolver<Real>::next_sweep(typename Sweep::Blocks blocks, int times) const -> Sweep {
    return {contact_kernels().next_pairs, contact_kernels().next_supports, blocks, times};
}

template <class Real>
void SoftSolver<Real>::solve_contacts(int number, bool is_last) {
    elapsed_ = number * substep_dt_;
    const ContactKernels<Real>& kernels = contact_kernels();
    SolveContacts<Real> on_supports = arguments(supports_), on_pairs = arguments(graph.pairs);
    if (number == 0)  // what contacts hold is of the step before
        on_supports.contacts.largest_impulse = on_pairs.contacts.largest_impulse = nullptr;
    const bool starts_anew = number == 0 && !are_impulses_known_;
    // A scene that asks for more sweeps wants contacts solved better: then none is left out.
    const bool only_restless = !starts_anew && !is_last && !is_unloaded_ && iterations == kDefaultIterations;
    const int next = iterations - 1;
    const std::array sweeps{Sweep{kernels.first_pairs, kernels.first_supports, Sweep::Blocks::all_and_mark},
                            next_sweep(only_restless ? Sweep::Blocks::restless : Sweep::Blocks::all,
                                       starts_anew ? std::max(kFirstSweeps, next) : next)};
    is_correction_due_ =
        next > 0 && is_last && length_squared(gravity_change_) > 0 && coarse_.is_due(count_, number + 1);
    const bool is_first_alone = is_correction_due_ || next == 0;
    sweep({sweeps.data(), is_first_alone ? std::size_t{1} : sweeps.size()}, on_pairs, on_supports);
}

template <class Real>
void SoftSolver<Real>::solve_uneven_contacts() {
    if (are_masses_uneven_)
        uneven_.solve(arguments(graph.pairs), arguments(supports_),
                      std::sqrt(length_squared(gravity_change_)));
}

template <class Real>
void SoftSolver<Real>::mark_impacts(const WorldState<Real>& world) {
    impacts.mark(world, graph.pairs, graph.version, supports_, graph.supports, dt_, substep_dt_,
                 gravity_change_);
}

template <class Real>
void SoftSolver<Real>::carry_out_impacts(const Column<Real>& motion, Books& books) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    const SubstepBodies<Real> bodies{count_,
                                     motion.data(),
                                     velocity_.data(),
                                     start_columns(),
                                     displacement_.data(),
                                     has_rotation_ ? turn_.data() : nullptr,
                                     substep_dt_,
                                     elapsed_,
                                     real(gravity_change_.x),
                                     real(gravity_change_.y),
                                     real(decay_),
                                     real(spin_decay_),
                                     uniform_friction_,
                                     uniform_rolling_};
    impacts.carry_out_all(bodies, books, gravity_work_);
    counters.bounces = impacts.counters.impacts;
}

template <class Real>
void SoftSolver<Real>::advance_bodies(bool is_last) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    AdvanceBodies<Real> k{};
    k.velocity = velocity_.data(), k.start = start_columns();
    k.displacement = displacement_.data(), k.turn = has_rotation_ ? turn_.data() : nullptr;
    k.h = real(substep_dt_), k.gain_x = real(gravity_change_.x), k.gain_y = real(gravity_change_.y);
    k.decay = real(decay_), k.spin_decay = real(spin_decay_), k.is_last = is_last;
    const auto kernel = kernels_->advance_bodies[has_rotation_ ? 1 : 0];
    executor_->for_each_chunk(
        count_, rows_per_task(), kNanosecondsToAdvance,
        [&](std::size_t, std::size_t first, std::size_t last) { kernel(k, first, padded(last)); });
}

template <class Real>
void SoftSolver<Real>::end_contacts() {
    retain_correction();
    supports_.for_each([&](std::size_t i) {
        const auto candidate = static_cast<std::size_t>(supports_.candidate[i]);
        graph.supports.normal_impulse[candidate] = supports_.normal_impulse[i];
        if (has_friction_) graph.supports.friction_impulse[candidate] = supports_.friction_impulse[i];
        if (rolls_) graph.supports.rolling_impulse[candidate] = supports_.rolling_impulse[i];
    });
}

template <class Real>
void SoftSolver<Real>::end_substeps(Bodies<Real>& bodies, std::vector<std::int32_t>& lost) {
    EndSubsteps<Real> k{};
    k.velocity = velocity_.data(), k.displacement = displacement_.data();
    k.turn = has_rotation_ ? turn_.data() : nullptr;
    k.radius = bodies.radius.data(), k.uniform_radius = bodies.radius.uniform_value();
    k.position_x = bodies.position_x.data(), k.position_y = bodies.position_y.data();
    k.velocity_x = bodies.velocity_x.data(), k.velocity_y = bodies.velocity_y.data();
    k.angle = has_rotation_ ? bodies.angle.data() : nullptr;
    k.angular_velocity = has_rotation_ ? bodies.angular_velocity.data() : nullptr;
    k.largest_position = static_cast<Real>(kLargestPosition);
    k.largest_speed = static_cast<Real>(kLargestSpeed);
    lost_rows_.prepare(count_, rows_per_task());
    const auto kernel = kernels_->end_substeps[has_rotation_ ? 1 : 0];
    executor_->for_each_chunk(count_, rows_per_task(), kNanosecondsToBegin,
                              [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                  EndSubsteps<Real> part = k;
                                  part.lost = lost_rows_.part(chunk);
                                  lost_rows_.set_count(chunk, kernel(part, first, padded(last)));
                              });
    lost.clear();
    lost_rows_.for_each_below(count_, [&](std::int32_t row) { lost.push_back(row); });
}

template <class Real>
std::size_t SoftSolver<Real>::bytes() const {
    return graph.bytes() + supports_.bytes() + inverse_mass_.bytes() + velocity_.bytes() + start_x_.bytes() +
           start_y_.bytes() + start_rim_.bytes() + displacement_.bytes() + turn_.bytes() +
           unloading_.bytes() + uneven_.bytes() + coarse_.bytes() + parting_.bytes() + near_rows_.bytes();
}

template class SoftSolver<float>;
template class SoftSolver<double>;

}  // namespace carom
