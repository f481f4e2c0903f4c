#include "solver/soft.hpp"

#include <algorithm>
#include <cmath>

#include "effects/flight.hpp"
#include "effects/friction.hpp"
#include "effects/restitution.hpp"
#include "solver/separate_overlaps.hpp"

namespace carom {
namespace {

/// Share of an overlap that one substep takes away. Below 0.15 piles sink deeper, above 0.5 they jitter.
constexpr double kRecovery = 0.4;
/// Bodies as near as this, in radii of the smallest, are solved together even if they hardly move: what
/// pushes one of them in the middle of a step is felt by the other.
constexpr double kNearFraction = 0.04;
/// Second sweeps of the first substep if there are no impulses to start from.
constexpr int kFirstSweeps = 32;
/// Impulses of substeps that were longer or shorter by this factor are of no use.
constexpr double kOtherLength = 2;

// ns a contact on one thread, for the executor: docs/decisions/0012-threads-of-soft.md.
constexpr double kNanosecondsToFind = 3, kNanosecondsToSweep = 2, kNanosecondsToKeep = 0.5;

}  // namespace

template <class Real>
void SoftSolver<Real>::derive_masses(const Bodies<Real>& bodies) {
    if (masses_are_known_) return;
    masses_vary_ = !bodies.mass.is_uniform() || bodies.has_flags;
    some_are_fixed_ = false;
    if (masses_vary_) inverse_mass_.resize(bodies.count);
    for (std::size_t row = 0; row < bodies.count && masses_vary_; ++row) {
        const bool is_fixed = (bodies.flags_of(row) & kFixedAngle) != 0;
        const double inverse = bodies.inverse_mass(row);
        inverse_mass_[row] = static_cast<Real>(is_fixed ? -inverse : inverse);
        some_are_fixed_ = some_are_fixed_ || is_fixed;
    }
    masses_are_known_ = true;
}

template <class Real>
const ContactKernels<Real>& SoftSolver<Real>::contact_kernels() const {
    if (!is_rough_) return kernels_->contacts[0];
    return kernels_->contacts[(rolls_ ? 3u : 1u) + (some_are_fixed_ ? 1u : 0u)];
}

template <class Real>
void SoftSolver<Real>::begin_substeps(const WorldState<Real>& world, const Column<Real>& motion, double h,
                                      const Vec2 gravity, const KernelTable<Real>& kernels,
                                      const Executor& executor) {
    const Bodies<Real>& bodies = world.bodies;
    kernels_ = &kernels, executor_ = &executor;
    count_ = bodies.count, h_ = h;
    is_rough_ = world.effects.friction, turns_ = world.effects.rotation;
    bounces_ = world.effects.restitution;
    friction_varies_ = is_rough_ && !bodies.friction.is_uniform();
    uniform_friction_ =
        bodies.friction.is_uniform() ? static_cast<double>(bodies.friction.uniform_value()) : 0;
    rolls_ = world.effects.rolling_resistance;
    rolling_varies_ = rolls_ && !bodies.rolling_resistance.is_uniform();
    uniform_rolling_ = static_cast<double>(bodies.rolling_resistance.uniform_value());
    derive_masses(bodies);
    const FlightClock clock = flight_clock_at(h, world.drag.linear);
    gain_ = clock.s * gravity, decay_ = clock.u;
    spin_decay_ = flight_clock_at(h, world.drag.angular).u;

    // Beyond the bodies a record for the padding of each group, so that no two tasks write to the same.
    const std::size_t rows = padded(count_ + graph.groups.count() + graph.groups.support_count());
    velocity_.resize(4 * rows), start_velocity_.resize(4 * rows), displacement_.resize(2 * rows);
    turn_.resize(turns_ ? rows : 0);
    const auto real = [](double value) { return static_cast<Real>(value); };
    BeginSubsteps<Real> k{};
    k.motion = motion.data();
    k.angular_velocity = turns_ ? bodies.angular_velocity.data() : nullptr;
    k.radius = bodies.radius.data(), k.uniform_radius = bodies.radius.uniform_value();
    k.inverse_mass = masses_vary_ ? inverse_mass_.data() : nullptr;
    k.uniform_inverse_mass = count_ > 0 ? real(bodies.inverse_mass(0)) : Real(0);
    k.gain_x = real(gain_.x), k.gain_y = real(gain_.y), k.decay = real(decay_),
    k.spin_decay = real(spin_decay_);
    k.velocity = velocity_.data(), k.start_velocity = start_velocity_.data();
    k.displacement = displacement_.data(), k.turn = turns_ ? turn_.data() : nullptr;
    const auto kernel = kernels.begin_substeps[turns_ ? 1 : 0];
    executor.for_each_chunk(count_, kRowsPerChunk, [&](std::size_t, std::size_t first, std::size_t last) {
        kernel(k, first, padded(last));
    });
    for (Column<Real>* records : {&velocity_, &start_velocity_})  // padding must not fall
        std::fill(records->data() + 4 * count_, records->data() + 4 * rows, Real(0));
    elapsed_ = 0;
}

template <class Real>
SolveContacts<Real> SoftSolver<Real>::arguments(LiveContacts<Real>& live) {
    SolveContacts<Real> k{};
    k.contacts = live.columns();
    k.velocity = velocity_.data(), k.displacement = displacement_.data();
    k.uniform_friction = static_cast<Real>(uniform_friction_);
    k.uniform_rolling = static_cast<Real>(uniform_rolling_);
    k.inverse_h = static_cast<Real>(1 / h_), k.h = static_cast<Real>(h_);
    k.elapsed = static_cast<Real>(elapsed_);
    k.recovery = static_cast<Real>(kRecovery), k.push = static_cast<Real>(push_);
    return k;
}

/// Contacts of one group of pairs that can touch in this step.
template <class Real>
void SoftSolver<Real>::find_group(const FindContacts<Real>& all, std::size_t group) {
    ContactCandidates<Real>& candidates = graph.pairs;
    const ContactColumns<Real> out = pairs_.columns();
    const auto find = contact_kernels().find;
    std::size_t place = pairs_.first_place(candidates, group);
    for (std::size_t c = candidates.first_colour[group]; c < candidates.first_colour[group + 1]; ++c) {
        const std::size_t begin = candidates.begin[c];
        FindContacts<Real> k = all;
        k.a = candidates.a.data() + begin, k.b = candidates.b.data() + begin;
        k.normal_impulse = candidates.normal_impulse.data() + begin;
        k.friction_impulse = candidates.friction_impulse.data() + begin;
        ContactColumns<Real>& to = k.out = out;
        for (std::int32_t** column : {&to.a, &to.b}) *column += place;
        for (Real** column : {&to.normal_x, &to.normal_y, &to.separation, &to.mass, &to.normal_impulse})
            *column += place;
        if (to.friction_impulse) to.friction_impulse += place;
        if (to.friction) to.friction += place;
        if (rolls_) k.rolling_impulse = candidates.rolling_impulse.data() + begin;
        for (Real** column : {&to.rolling_impulse, &to.rolling, &to.rolling_share})
            if (*column) *column += place;
        k.candidate = pairs_.candidate.data() + place;
        k.approach = bounces_ ? pairs_.approach.data() + place : nullptr;
        std::size_t count = find(k, 0, padded(candidates.count[c]));
        while (count > 0 && to.a[count - 1] == static_cast<std::int32_t>(count_))
            --count;  // padding touches itself
        for (std::size_t i = 0; i < count; ++i) k.candidate[i] += static_cast<std::int32_t>(begin);
        place = pairs_.close_colour(c, place, count, padding_row(group));
    }
}

template <class Real>
void SoftSolver<Real>::find_pairs(const Bodies<Real>& bodies, const Column<Real>& motion) {
    pairs_.resize(graph.pairs, false, is_rough_, friction_varies_, bounces_);
    pairs_.resize_rolling(rolls_, rolling_varies_, !bodies.radius.is_uniform());
    FindContacts<Real> all{};
    all.motion = motion.data();
    all.radius = bodies.radius.data(), all.uniform_radius = bodies.radius.uniform_value();
    all.inverse_mass = masses_vary_ ? inverse_mass_.data() : nullptr;
    all.uniform_inverse_mass = bodies.count > 0 ? static_cast<Real>(bodies.inverse_mass(0)) : Real(0);
    all.friction = friction_varies_ ? bodies.friction.data() : nullptr;
    all.rolling = rolling_varies_ ? bodies.rolling_resistance.data() : nullptr;
    all.dt = static_cast<Real>(dt_), all.near = static_cast<Real>(near_);
    const double work = kNanosecondsToFind * static_cast<double>(graph.pairs.a.size());
    executor_->for_each_task(graph.groups.count(), work, [&](std::size_t group) { find_group(all, group); });
}

/// What lasts from step to step is force: after substeps of another length the impulses are of another size.
/// If that differs much, what was noise would become a kick: better to start from nothing, with more sweeps.
template <class Real>
void SoftSolver<Real>::keep_forces(ContactCandidates<Real>& candidates) const {
    if (h_ == impulses_of_h_) return;
    const double ratio = impulses_of_h_ > 0 ? h_ / impulses_of_h_ : 0;
    const auto kept = static_cast<Real>(are_impulses_known_ ? ratio : 0);
    for (Column<Real>* impulses :
         {&candidates.normal_impulse, &candidates.friction_impulse, &candidates.rolling_impulse})
        for (Real& impulse : *impulses) impulse *= kept;
}

template <class Real>
void SoftSolver<Real>::find_contacts(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                     const Column<Real>& motion, double dt) {
    dt_ = dt;
    const double smallest = candidates.smallest_radius();
    near_ = kNearFraction * smallest + std::sqrt(length_squared(gain_)) * dt;
    push_ = kPushRadiiPerSecond * smallest * h_;
    are_impulses_known_ = h_ < kOtherLength * impulses_of_h_ && impulses_of_h_ < kOtherLength * h_;
    keep_forces(graph.pairs), keep_forces(graph.supports);
    impulses_of_h_ = h_;
    find_pairs(world.bodies, motion);
    find_supports(world);
    for (LiveContacts<Real>* live : {&pairs_, &supports_})
        if (bounces_)
            for (Column<Real>* column : {&live->largest_impulse, &live->bounce_impulse})
                std::fill(column->begin(), column->end(), Real(0));
    counters.contacts = static_cast<std::int64_t>(pairs_.contacts() + supports_.contacts());
    counters.colours = static_cast<std::int64_t>(pairs_.count.size());
    counters.overflow = static_cast<std::int64_t>(pairs_.overflow());
    sweep({contact_kernels().warm_start_pairs, arguments(pairs_)},
          {contact_kernels().warm_start_supports, arguments(supports_)});
}

/// One colour after the other; within a colour no two contacts share a body that moves.
template <class Real>
void SoftSolver<Real>::sweep_group(const LiveContacts<Real>& live, const ContactCandidates<Real>& candidates,
                                   std::size_t group, const Sweep& sweep) {
    for (std::size_t c = candidates.first_colour[group]; c < candidates.first_colour[group + 1]; ++c)
        sweep.kernel(sweep.arguments, live.begin[c], live.begin[c] + live.length(c));
}

/// All contacts once, in the order that contact_groups.hpp explains.
template <class Real>
void SoftSolver<Real>::sweep(const Sweep& over_pairs, const Sweep& over_supports) {
    const ContactGroups& groups = graph.groups;
    const double work = kNanosecondsToSweep * static_cast<double>(counters.contacts);
    const auto pair_group = [&](std::size_t group) { sweep_group(pairs_, graph.pairs, group, over_pairs); };
    const auto support_group = [&](std::size_t group) {
        sweep_group(supports_, graph.supports, group, over_supports);
    };
    executor_->for_each_task(groups.tasks_of_part_1(), work, [&](std::size_t task) {
        const std::size_t chunk = 2 * task;
        pair_group(ContactGroups::inside(chunk));
        if (!groups.has_border(chunk)) return;
        pair_group(ContactGroups::across(chunk));
        pair_group(ContactGroups::inside(chunk + 1));
    });
    pair_group(groups.far());
    executor_->for_each_task(groups.tasks_of_part_2(), work / 4, [&](std::size_t task) {
        const std::size_t chunk = 2 * task;
        if (chunk > 0) {
            if (groups.has_border(chunk - 1)) pair_group(ContactGroups::across(chunk - 1));
            support_group(chunk - 1);
        }
        if (chunk < groups.chunks) support_group(chunk);
    });
    support_group(groups.chunks);
}

template <class Real>
void SoftSolver<Real>::solve_contacts(int number) {
    elapsed_ = number * h_;
    const ContactKernels<Real>& kernels = contact_kernels();
    const SolveContacts<Real> on_supports = arguments(supports_), on_pairs = arguments(pairs_);
    sweep({kernels.first_pairs, on_pairs}, {kernels.first_supports, on_supports});
    const int sweeps = number == 0 && !are_impulses_known_ ? kFirstSweeps : 1;
    for (int i = 0; i < sweeps; ++i)
        sweep({kernels.next_pairs, on_pairs}, {kernels.next_supports, on_supports});
}

template <class Real>
void SoftSolver<Real>::advance_bodies(bool is_last) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    AdvanceBodies<Real> k{};
    k.velocity = velocity_.data(), k.start_velocity = start_velocity_.data();
    k.displacement = displacement_.data(), k.turn = turns_ ? turn_.data() : nullptr;
    k.h = real(h_), k.gain_x = real(gain_.x), k.gain_y = real(gain_.y);
    k.decay = real(decay_), k.spin_decay = real(spin_decay_), k.is_last = is_last;
    const auto kernel = kernels_->advance_bodies[turns_ ? 1 : 0];
    executor_->for_each_chunk(count_, kRowsPerChunk, [&](std::size_t, std::size_t first, std::size_t last) {
        kernel(k, first, padded(last));
    });
}

/// Impulses back to the candidates.
template <class Real>
void SoftSolver<Real>::keep_impulses(const LiveContacts<Real>& live,
                                     ContactCandidates<Real>& candidates) const {
    const double work = kNanosecondsToKeep * static_cast<double>(live.a.size());
    executor_->for_each_task(candidates.groups(), work, [&](std::size_t group) {
        live.for_each(candidates.first_colour[group], candidates.first_colour[group + 1], [&](std::size_t i) {
            const auto candidate = static_cast<std::size_t>(live.candidate[i]);
            candidates.normal_impulse[candidate] = live.normal_impulse[i];
            if (!live.friction_impulse.empty())
                candidates.friction_impulse[candidate] = live.friction_impulse[i];
            if (rolls_) candidates.rolling_impulse[candidate] = live.rolling_impulse[i];
        });
    });
}

template <class Real>
void SoftSolver<Real>::end_contacts(const WorldState<Real>& world, Books& books) {
    if (bounces_) {
        fastest_bounce_ = 0;
        const bool any_pair = find_bounces(pairs_, world), any_support = find_bounces(supports_, world);
        if (any_pair || any_support) {
            if (books.is_open) before_bounce_ = velocity_;
            bounce();
            book_bounces(books);
        }
    }
    keep_impulses(pairs_, graph.pairs), keep_impulses(supports_, graph.supports);
}

template <class Real>
void SoftSolver<Real>::end_substeps(Bodies<Real>& bodies, std::vector<std::int32_t>& lost) {
    EndSubsteps<Real> k{};
    k.velocity = velocity_.data(), k.displacement = displacement_.data();
    k.turn = turns_ ? turn_.data() : nullptr;
    k.radius = bodies.radius.data(), k.uniform_radius = bodies.radius.uniform_value();
    k.position_x = bodies.position_x.data(), k.position_y = bodies.position_y.data();
    k.velocity_x = bodies.velocity_x.data(), k.velocity_y = bodies.velocity_y.data();
    k.angle = turns_ ? bodies.angle.data() : nullptr;
    k.angular_velocity = turns_ ? bodies.angular_velocity.data() : nullptr;
    k.largest_position = static_cast<Real>(kLargestPosition);
    k.largest_speed = static_cast<Real>(kLargestSpeed);
    lost_rows_.prepare(count_, kRowsPerChunk);
    const auto kernel = kernels_->end_substeps[turns_ ? 1 : 0];
    executor_->for_each_chunk(count_, kRowsPerChunk,
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
    return graph.bytes() + pairs_.bytes() + supports_.bytes() + inverse_mass_.bytes() + velocity_.bytes() +
           start_velocity_.bytes() + displacement_.bytes() + turn_.bytes();
}

template class SoftSolver<float>;
template class SoftSolver<double>;

}  // namespace carom
