#include "solvers/soft/corrections/uneven_contacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "effects/contact_law.hpp"
#include "state/columns/index.hpp"

namespace carom {
namespace {

// Shares of what gravity adds to a velocity in a substep.

/// All contacts are relaxed if the local solve does not come to its end: it leaves a velocity off by this.
constexpr double kMuch = 0.002;
/// Sweeps leave little if none is off by this.
constexpr double kLittle = 0.02;
/// Two rounds are enough in a pile: docs/decisions/0032-piles-of-uneven-masses.md.
constexpr RelaxationEffort kEffort{.rounds = 2, .accuracy = 0.1, .slack = 10};
/// All contacts are relaxed only where the local solve has more contacts to sweep than one in so many bodies.
constexpr std::size_t kBodiesAContact = 8;
/// Steps in which sweeps must leave little before contacts are solved locally again.
constexpr int kPatience = 60;

// Sweeps of many contacts of uneven masses, after those that all contacts get: over-relaxed ones until these
// change little, and the last ones that are not. docs/decisions/0064-uneven-masses-in-sweeps.md has what else
// was tried.
/// Over-relaxed sweeps at most: this share of what the ratio of masses exceeds kFewUpTo by, within the
/// bounds.
constexpr double kSweepsOfRatio = 0.2;
constexpr double kFewUpTo = 50;
constexpr double kFewestRelaxed = 9;
constexpr double kMostRelaxed = 60;
/// Sweeps behind which velocities are compared with those before them.
constexpr int kTogether = 3;
/// Over-relaxed sweeps end when none changes a velocity by more than this share of what gravity adds in a
/// substep; where masses differ by more than a hundred times by less, for loads are so much larger then.
constexpr double kEnough = 0.03;
constexpr double kEnoughOfRatio = 3;
constexpr int kLastSweeps = 1;
/// Heaps without friction, which small errors move for ever, are swept to the end.
constexpr int kLastSmoothSweeps = 2;
/// Overlaps beyond this share of the smaller radius are parted by equal shares as well.
constexpr double kPartedFrom = 0.02;

template <class Real>
void store_impulses(ContactRows<Real>& rows, std::size_t i, const ContactImpulses<double>& impulses) {
    rows.normal_impulse[i] = static_cast<Real>(impulses.normal);
    if (!rows.friction_impulse.empty()) rows.friction_impulse[i] = static_cast<Real>(impulses.tangent);
    if (!rows.rolling_impulse.empty()) rows.rolling_impulse[i] = static_cast<Real>(impulses.rolling);
}

}  // namespace

template <class Real>
void UnevenContacts<Real>::find(const ContactRows<Real>& pairs, const BodyMasses<Real>& masses,
                                std::size_t rows) {
    clear();
    if (!masses.are_uneven()) return;
    local_.find(pairs, masses.inverse_column(), rows);
    if (masses.are_very_uneven() || !local_.has_many()) return;
    blocks_.assign(pairs.is_live.size(), 0);
    for (const std::uint32_t i : local_.found()) blocks_[i / kContactBlock] = 1;
    most_relaxed_ = static_cast<int>(
        std::clamp(kSweepsOfRatio * (masses.ratio() - kFewUpTo), kFewestRelaxed, kMostRelaxed));
    enough_ = std::min(kEnough, kEnoughOfRatio / masses.ratio());
}

template <class Real>
void UnevenContacts<Real>::list_runs(const ContactRows<Real>& pairs) {
    constexpr std::uint32_t kHalves = kContactBlock / kHalfBlock;
    runs_.runs.clear(), runs_.first.assign(1, 0);
    for (std::size_t group = 0; group < pairs.groups(); ++group) {
        const auto* const run = pairs.run.data() + pairs.first_place(group) / kContactBlock;
        for (std::size_t r = 0; r < pairs.run_count[group]; ++r)
            for (std::uint32_t half = run[r].first; half < run[r].last; half += kHalves) {
                if (!blocks_[half / kHalves]) continue;
                const bool goes_on = runs_.runs.size() > runs_.first.back() && runs_.runs.back().last == half;
                if (!goes_on) runs_.runs.push_back({half, half});
                runs_.runs.back().last = std::min(half + kHalves, run[r].last);
            }
        runs_.first.push_back(runs_.runs.size());
    }
}

/// Velocities without contacts are those of free flight: not where joints or shapes push bodies, too.
template <class Real>
void UnevenContacts<Real>::begin_step(const StepView<Real>& step, const WorldState<Real>& world,
                                      bool are_mixed) {
    if (are_swept())
        local_.leave_step(), list_runs(step.graph.pairs), list_swept(step);
    else
        local_.begin_step(step.graph.pairs, step.supports);
    is_listed_ = false, is_first_ = true;
    may_relax_ = are_mixed && world.joints.empty() && !world.bodies.has_shapes && step.terms.fall_speed() > 0;
    if (!may_relax_) steps_left_ = 0;
    if (steps_left_ == 0) return;
    --steps_left_;
    list(step);
}

/// Lists all contacts that can touch in this step.
template <class Real>
void UnevenContacts<Real>::list(const StepView<Real>& step) {
    const ContactRows<Real>& pairs = step.graph.pairs;
    is_listed_ = true;
    contacts_.clear(), rows_.clear();
    number_of_.assign(step.records.count(), -1);
    const auto body_of = [&](std::int32_t row) {
        std::int32_t& number = number_of_[index(row)];
        if (number < 0) number = static_cast<std::int32_t>(rows_.size()), rows_.push_back(row);
        return number;
    };
    const auto add = [&](std::size_t i, std::int32_t a, std::int32_t b) {
        LocalContact contact{};
        contact.a = a, contact.b = b, contact.contact = static_cast<std::uint32_t>(i);
        contacts_.push_back(contact);
    };
    pairs.for_each([&](std::size_t i) {
        if (!pairs.is_live[i / kContactBlock]) return;
        const std::int32_t a = body_of(pairs.a[i]);
        add(i, a, body_of(pairs.b[i]));
    });
    pair_count_ = contacts_.size();
    step.supports.for_each([&](std::size_t i) { add(i, body_of(step.supports.a[i]), -1); });
    if (step.settings.has_rotation)
        rough_.begin(contacts_, rows_.size());
    else
        smooth_.begin(contacts_, rows_.size());
}

template <class Real>
void UnevenContacts<Real>::load(const StepView<Real>& step, const SolveContacts<Real>& k,
                                LocalContact& c) const {
    c.read(k);
    const DoubleBody a = body_at(step.records.velocity, rows_[index(c.a)]);
    const auto find_masses = [&](const auto& b) {
        c.terms.mass = 1 / inverse_mass(a, b);
        c.terms.tangent_mass = tangent_mass<kEveryEffect>(a, b, c.terms.mass);
    };
    if (c.b < 0)
        find_masses(DoubleSurface{c.surface_normal, c.surface_tangent, c.surface_rolling});
    else
        find_masses(body_at(step.records.velocity, rows_[index(c.b)]));
}

/// How far the contacts are from their laws, each on its own [m/s].
template <class Real>
double UnevenContacts<Real>::residual(const StepView<Real>& step) const {
    return largest_residual(
        contacts_, [&](std::int32_t body) { return body_at(step.records.velocity, rows_[index(body)]); });
}

template <class Real>
template <int kSize>
void UnevenContacts<Real>::relax(const StepView<Real>& step, ContactRelaxation<kSize>& relaxation) {
    using Velocity = typename ContactRelaxation<kSize>::Velocity;
    const SubstepTerms& terms = step.terms;
    for (std::size_t body = 0; body < rows_.size(); ++body) {
        const DoubleBody record = body_at(step.records.velocity, rows_[body]);
        const std::array<double, 3> before = step.records.start_of_substep(rows_[body]);
        Velocity start, free, swept;
        for (std::size_t k = 0; k < kSize; ++k) start[k] = before[k], swept[k] = record.record[k];
        free[0] = terms.decay * start[0] + terms.gravity_change.x;
        free[1] = terms.decay * start[1] + terms.gravity_change.y;
        if constexpr (kSize > 2) free[2] = terms.spin_decay * start[2];
        relaxation.set_body(body, record.record[3], start, free, swept);
    }
    relaxation.solve(contacts_, terms.fall_speed(), kEffort);
    for (std::size_t body = 0; body < rows_.size(); ++body)
        for (std::size_t k = 0; k < kSize; ++k)
            step.records.velocity[4 * index(rows_[body]) + k] =
                static_cast<Real>(relaxation.velocity(body)[k]);
    for (std::size_t i = 0; i < contacts_.size(); ++i)
        store_impulses(i < pair_count_ ? step.graph.pairs : step.supports, contacts_[i].contact,
                       contacts_[i].impulses);
}

/// Takes away a share of an overlap beyond the slop, by moving both bodies equally: geometry alone.
/// @param b  row; below zero: nothing moves it
template <class Real>
void UnevenContacts<Real>::part(const StepView<Real>& step, const SolveContacts<Real>& k, std::size_t contact,
                                std::int32_t a, std::int32_t b, double slop) const {
    Column<Real>& displacement = step.records.displacement;
    const double nx = static_cast<double>(k.contacts.normal_x[contact]),
                 ny = static_cast<double>(k.contacts.normal_y[contact]);
    const auto moved = [&](std::int32_t row) { return &displacement[2 * index(row)]; };
    const auto along = [&](const Real* at) {
        return static_cast<double>(at[0]) * nx + static_cast<double>(at[1]) * ny;
    };
    double separation = static_cast<double>(k.contacts.separation[contact]) - along(moved(a));
    separation +=
        b < 0 ? static_cast<double>(k.contacts.surface_normal[contact]) * static_cast<double>(k.elapsed)
              : along(moved(b));
    const double unit = k.contacts.smaller ? static_cast<double>(k.contacts.smaller[contact]) : 1;
    const double depth = -separation - slop * unit;
    if (!(depth > 0)) return;
    const double push =
        std::fmin(static_cast<double>(k.recovery) * depth, static_cast<double>(k.push) * unit);
    const auto move = [&](std::int32_t row, double by) {
        moved(row)[0] += static_cast<Real>(by * nx), moved(row)[1] += static_cast<Real>(by * ny);
    };
    move(a, b < 0 ? -push : -0.5 * push);
    if (b >= 0) move(b, 0.5 * push);
}

/// Lists the bodies of the contacts that are swept, and of these contacts those that overlap by more than is
/// left to the sweeps.
template <class Real>
void UnevenContacts<Real>::list_swept(const StepView<Real>& step) {
    const ContactRows<Real>& pairs = step.graph.pairs;
    const std::size_t bodies = step.records.count();
    const Real* smaller = pairs.smaller.empty() ? nullptr : pairs.smaller.data();
    const auto from = static_cast<Real>(kPartedFrom * step.settings.radius);
    deep_.clear(), swept_.clear(), number_of_.assign(bodies, -1);
    const auto add = [&](std::int32_t row) {
        if (index(row) >= bodies || number_of_[index(row)] >= 0) return;  // padding, or known
        number_of_[index(row)] = 0, swept_.push_back(row);
    };
    for (const auto& run : runs_.runs)
        for (std::size_t i = kHalfBlock * run.first; i < kHalfBlock * run.last; ++i) {
            add(pairs.a[i]), add(pairs.b[i]);
            if (pairs.separation[i] < -from * (smaller ? smaller[i] : Real(1)))
                deep_.push_back(static_cast<std::uint32_t>(i));
        }
    before_.resize(4 * swept_.size());
}

/// Whether a body's velocity has changed by more than `limit` [m/s] since it was looked at the last time.
template <class Real>
bool UnevenContacts<Real>::has_changed(const StepView<Real>& step, double limit) {
    const auto most = static_cast<Real>(limit);
    unsigned changed = 0;
    Real* before = before_.data();
    for (const std::int32_t row : swept_) {
        const Real* velocity = &step.records.velocity[4 * index(row)];
        for (std::size_t k = 0; k < 4; ++k) changed |= std::fabs(velocity[k] - before[k]) > most;
        std::copy_n(velocity, 4, before);
        before += 4;
    }
    return changed != 0;
}

template <class Real>
int UnevenContacts<Real>::sweep(const StepView<Real>& step, ContactSweeps<Real>& sweeps, bool is_last) {
    using Sweep = typename ContactSweeps<Real>::Sweep;
    using Blocks = typename ContactSweeps<Real>::Blocks;
    const ContactKernels<Real>& kernels = *step.loops.contacts;
    Sweep relaxed{kernels.next_pairs, kernels.next_supports, is_last ? Blocks::all : Blocks::restless};
    relaxed.of_runs = &runs_;
    Sweep last = relaxed;
    relaxed.over_relaxation = ContactSweeps<Real>::kUnevenOverRelaxation;
    const bool is_smooth = step.settings.is_smooth_heap;
    last.times = is_smooth ? kLastSmoothSweeps : kLastSweeps;
    relaxed.times = is_smooth ? most_relaxed_ : kTogether;
    if (!is_smooth) has_changed(step, 0);
    int done = 0;
    while (done < most_relaxed_) {
        relaxed.times = std::min(relaxed.times, most_relaxed_ - done);
        sweeps.run(step, {&relaxed, 1});
        done += relaxed.times;
        const double enough = enough_ * relaxed.times * step.terms.fall_speed();
        if (done < most_relaxed_ && !has_changed(step, enough)) break;
    }
    sweeps.run(step, {&last, 1});
    const SolveContacts<Real> k = ContactSweeps<Real>::arguments(step, step.graph.pairs);
    const double slop = kPartedFrom * step.settings.radius;
    for (const std::uint32_t i : deep_) part(step, k, i, step.graph.pairs.a[i], step.graph.pairs.b[i], slop);
    return done + last.times;
}

template <class Real>
int UnevenContacts<Real>::solve(const StepView<Real>& step, ContactSweeps<Real>& sweeps, bool is_last) {
    if (are_swept()) return sweep(step, sweeps, is_last);
    const SolveContacts<Real> on_pairs = ContactSweeps<Real>::arguments(step, step.graph.pairs),
                              on_supports = ContactSweeps<Real>::with_rows(on_pairs, step.supports);
    const double fall = step.terms.fall_speed();
    if (!is_listed_ || is_first_) {
        const std::size_t few = step.records.count() / kBodiesAContact;
        has_many_left_ = local_.begin(on_pairs, on_supports, fall) > few;
    }
    is_first_ = false;
    if (!is_listed_) {
        const double left = local_.solve(on_pairs, on_supports, fall);
        if (!may_relax_ || !has_many_left_ || !(left > kMuch * fall)) return 0;
        list(step);
    }
    const auto arguments = [&](std::size_t i) -> const SolveContacts<Real>& {
        return i < pair_count_ ? on_pairs : on_supports;
    };
    for (std::size_t i = 0; i < contacts_.size(); ++i) load(step, arguments(i), contacts_[i]);
    if (residual(step) > kLittle * fall) {
        if (has_many_left_) steps_left_ = kPatience;
        if (step.settings.has_rotation)
            relax(step, rough_);
        else
            relax(step, smooth_);
    }
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const LocalContact& c = contacts_[i];
        const std::int32_t b = c.b < 0 ? -1 : rows_[index(c.b)];
        part(step, arguments(i), c.contact, rows_[index(c.a)], b, static_cast<double>(on_pairs.slop));
    }
    return 0;
}

template class UnevenContacts<float>;
template class UnevenContacts<double>;

}  // namespace carom
