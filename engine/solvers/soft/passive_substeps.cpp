#include "solvers/soft/passive_substeps.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/joints/joint_arguments.hpp"
#include "solvers/soft/contacts/stored_contact.hpp"
#include "solvers/soft/substep_drives.hpp"

namespace carom {
namespace {

/// What impulses may add to the energy of bodies, above round-off and what is no blow: a share of what they
/// have and of what drives do, and the energy of so many times the speed that gravity adds in a substep.
constexpr double kLeastShare = 3e-3;
constexpr double kFalls = 8;
/// Where impulses of what has risen cannot be blamed for more than this share, the others are let stand.
constexpr double kLastShare = 0.01;
/// What joints on bent paths may give, as a share of the energy that bodies have: a joint that turns by f = w
/// h in a substep is asked for the velocity f v / 2 and gives m f v, so f² of what turns with v, f at most
/// kMostBend. Joints that are torn far open turn light bodies about anchors far from them, as fast as they
/// will: what such bends give is no bound for themselves.
constexpr double kShareOfBends = kMostBend * kMostBend;
/// Share of the energy of all bodies that is the round-off of its sums.
constexpr double kRoundOffOfEnergy = 1e-5;

/// By row, of bodies that joints connect the smallest row; -1: none.
template <class Real>
std::int32_t first_of_group(const SolvedSubstep<Real>& solved, std::size_t row) {
    return has_joints(solved) ? solved.joints.first_of_group(row) : -1;
}

/// What is too much to be round-off, for bodies that have gained [J].
double least_of(double mass, double energy, const SubstepTerms& terms) {
    const double fall = kFalls * terms.fall_speed();
    return kLeastShare * energy + 0.5 * mass * fall * fall;
}

}  // namespace

/// Room for what a gain needs, 170 bytes a row: most worlds never gain, and have none. It is never given
/// back, so that a world as large as it was at its last gain allocates nothing.
template <class Real>
void PassiveSubsteps<Real>::make_room(std::size_t rows) {
    if (rows <= share_.capacity()) return;
    const std::size_t room = rows + rows / 4;  // rows of what nothing moves come and go with contacts
    groups_.reserve(room), islands_.reserve(room), has_risen_.reserve(room), share_.reserve(room);
    without_.reserve(4 * room), rows_.reset(room);
}

/// Whether the world has more energy than free flight left it and than it was given.
template <class Real>
bool PassiveSubsteps<Real>::world_gains(const SolvedSubstep<Real>& solved) const {
    const auto [gain, before] = solved.contacts.records.gain(solved.contacts.terms, solved.contacts.loops);
    if (gain <= kRoundOffOfEnergy * before) return false;
    double work = 0, effort = 0, bend = 0, effort_of_bend = 0;
    for_each_drive(solved, [&](std::int32_t, std::int32_t, double done, double of_bend) {
        work += done, effort += std::fabs(done), bend += of_bend, effort_of_bend += std::fabs(of_bend);
    });
    const double most = kShareOfBends * (before + effort);
    work += std::clamp(bend, -most, most), effort += std::fmin(effort_of_bend, most);
    return !(gain - work <= kRoundOffOfEnergy * (before + effort));  // also where it is not a number
}

/// Marks the groups of bodies that have more energy than free flight left them.
template <class Real>
bool PassiveSubsteps<Real>::find_risen(const SolvedSubstep<Real>& solved) {
    const BodyRecords<Real>& records = solved.contacts.records;
    const SubstepTerms& terms = solved.contacts.terms;
    const std::size_t rows = records.moving();
    const auto group_of = [&](std::size_t row) -> Gain& {
        const std::int32_t first = first_of_group(solved, row);
        return groups_[first < 0 ? row : static_cast<std::size_t>(first)];
    };
    groups_.assign(rows, {});
    for (std::size_t row = 0; row < rows; ++row) {
        if (!moves(records, static_cast<std::int32_t>(row))) continue;
        const Velocity now = velocity_at(records.velocity, row),
                       free = records.free_flight(static_cast<std::int32_t>(row), terms);
        const double mass = solved.step.world.bodies.mass[row];
        Gain& group = group_of(row);
        group.mass += mass, group.before += 0.5 * mass * product(free, free);
        const Velocity change = now - free;
        group.gain += mass * (product(change, free) + 0.5 * product(change, change));
    }
    bool any = false;
    has_risen_.assign(records.rows(), 0);
    for (std::size_t row = 0; row < rows; ++row) {
        const Gain& group = group_of(row);
        has_risen_[row] = group.gain > least_of(group.mass, group.before, terms);
        any = any || has_risen_[row];
    }
    return any;
}

template <class Real>
void PassiveSubsteps<Real>::find_islands(const SolvedSubstep<Real>& solved) {
    const BodyRecords<Real>& records = solved.contacts.records;
    rows_.reset(records.moving());
    const auto join = [&](std::int32_t a, std::int32_t b) {
        if (moves(records, a) && moves(records, b)) rows_.join(a, b);
    };
    for (std::size_t row = 0; row < records.moving(); ++row)
        if (const std::int32_t first = first_of_group(solved, row); first >= 0)
            join(first, static_cast<std::int32_t>(row));
    const ContactRows<Real>& pairs = solved.contacts.graph.pairs;
    pairs.for_each([&](std::size_t i) {
        if (pairs.is_live[i / kContactBlock] && pairs.normal_impulse[i] != 0) join(pairs.a[i], pairs.b[i]);
    });
    if (solved.step.world.bodies.has_shapes)
        solved.paths.for_each([&](const PathContact<Real>& contact) {
            if (contact.link.normal1[contact.lane] + contact.link.normal2[contact.lane] != 0)
                join(contact.near, contact.far);
        });
}

/// Finds the islands that have gained, and forgets what has risen in others. @return  J, what they have
/// gained
template <class Real>
double PassiveSubsteps<Real>::find_gains(const SolvedSubstep<Real>& solved) {
    const BodyRecords<Real>& records = solved.contacts.records;
    const std::size_t rows = records.moving();
    islands_.assign(rows, {});
    for (std::size_t row = 0; row < rows; ++row) {
        Island& island = island_of(row);
        island.mass += groups_[row].mass, island.before += groups_[row].before;
        island.gain += groups_[row].gain;
    }
    for_each_drive(solved, [&](std::int32_t a, std::int32_t b, double work, double bend) {
        const std::int32_t row = moves(records, a) ? a : b;
        if (!moves(records, row)) return;
        Island& island = island_of(static_cast<std::size_t>(row));
        island.work += work, island.effort += std::fabs(work);
        island.bend += bend, island.effort_of_bend += std::fabs(bend);
        if (has_risen_[static_cast<std::size_t>(row)])
            island.work_of_risen += work, island.bend_of_risen += bend;
    });
    double sum = 0;
    for (Island& island : islands_) {
        const double most = kShareOfBends * (island.before + island.effort);
        island.work += std::clamp(island.bend, -most, most);
        island.work_of_risen += std::clamp(island.bend_of_risen, -most, most);
        island.effort += std::fmin(island.effort_of_bend, most);
        const double gained = island.gain - island.work;
        island.has_gained =
            gained > least_of(island.mass, island.before + island.effort, solved.contacts.terms);
        if (island.has_gained) sum += gained;
    }
    for (std::size_t row = 0; row < rows; ++row)
        if (!island_of(row).has_gained) has_risen_[row] = 0;
    return sum;
}

/// Velocities without the impulses of bodies that have risen: these fly freely.
template <class Real>
void PassiveSubsteps<Real>::find_velocities_without(const SolvedSubstep<Real>& solved) {
    const BodyRecords<Real>& records = solved.contacts.records;
    without_ = records.velocity;
    const auto store = [&](std::int32_t row, const Velocity& velocity) {
        for (std::size_t k = 0; k < 3; ++k)
            without_[4 * static_cast<std::size_t>(row) + k] = static_cast<Real>(velocity[k]);
    };
    const auto has_risen = [&](std::int32_t row) { return has_risen_[static_cast<std::size_t>(row)] != 0; };
    const ContactRows<Real>& pairs = solved.contacts.graph.pairs;
    pairs.for_each([&](std::size_t i) {
        const std::int32_t a = pairs.a[i], b = pairs.b[i];
        if (!pairs.is_live[i / kContactBlock] || !(has_risen(a) || has_risen(b))) return;
        DoubleBody of_a = body_at(without_, a), of_b = body_at(without_, b);
        StoredContact<Real>(pairs, i).take_from(of_a, of_b);
        store(a, {of_a.record[0], of_a.record[1], of_a.record[2]});
        store(b, {of_b.record[0], of_b.record[1], of_b.record[2]});
    });
    solved.paths.take_from(has_risen_, without_);
    for (std::size_t row = 0; row < records.moving(); ++row)
        if (has_risen_[row] && moves(records, static_cast<std::int32_t>(row)))
            store(static_cast<std::int32_t>(row),
                  records.free_flight(static_cast<std::int32_t>(row), solved.contacts.terms));
}

/// With a share s of those impulses an island has the energy E(s) = E(1) + (s - 1) along + (s - 1)² square /
/// 2, of which drives give s - 1 times their work: the share at which E less that is least.
template <class Real>
bool PassiveSubsteps<Real>::find_shares(const SolvedSubstep<Real>& solved) {
    const BodyRecords<Real>& records = solved.contacts.records;
    for (std::size_t row = 0; row < records.moving(); ++row) {
        Island& island = island_of(row);
        if (!island.has_gained || !moves(records, static_cast<std::int32_t>(row))) continue;
        const Velocity now = velocity_at(records.velocity, row), given = now - velocity_at(without_, row);
        const double mass = solved.step.world.bodies.mass[row];
        island.along += mass * product(now, given), island.square += mass * product(given, given);
    }
    bool any = false;
    for (Island& island : islands_) {
        if (!island.has_gained || !(island.square > 0)) continue;
        island.share = std::clamp(1 - (island.along - island.work_of_risen) / island.square, 0.0, 1.0);
        any = any || island.share < 1;
    }
    return any;
}

template <class Real>
void PassiveSubsteps<Real>::scale(const SolvedSubstep<Real>& solved) {
    BodyRecords<Real>& records = solved.contacts.records;
    share_.assign(records.rows(), 1);
    for (std::size_t row = 0; row < records.moving(); ++row) {
        const double share = island_of(row).share;
        if (share == 1 || !moves(records, static_cast<std::int32_t>(row))) continue;
        if (has_risen_[row]) share_[row] = share;
        for (std::size_t k = 0; k < 3; ++k) {
            Real& now = records.velocity[4 * row + k];
            const double rest = without_[4 * row + k];
            now = static_cast<Real>(rest + share * (static_cast<double>(now) - rest));
        }
    }
    const auto share_of = [&](std::int32_t a, std::int32_t b) {
        return std::min(share_[static_cast<std::size_t>(a)], share_[static_cast<std::size_t>(b)]);
    };
    ContactRows<Real>& pairs = solved.contacts.graph.pairs;
    pairs.for_each([&](std::size_t i) {
        if (pairs.is_live[i / kContactBlock]) scale_impulses(pairs, i, share_of(pairs.a[i], pairs.b[i]));
    });
    ContactRows<Real>& supports = solved.contacts.supports;
    supports.for_each(
        [&](std::size_t i) { scale_impulses(supports, i, share_of(supports.a[i], supports.a[i])); });
    solved.paths.scale(share_of);
    if (has_joints(solved)) solved.joints.scale(share_of);
}

template <class Real>
double PassiveSubsteps<Real>::bound(const SolvedSubstep<Real>& solved, bool is_last) {
    has_scaled_ = false;
    if (!world_gains(solved)) return 0;
    make_room(solved.contacts.records.rows());
    if (!find_risen(solved)) return 0;
    find_islands(solved);
    const double gained = find_gains(solved);
    if (!(gained > 0)) return 0;
    for (std::size_t row = 0; is_last && row < islands_.size(); ++row) {
        Island& island = island_of(row);
        if (!island.has_gained || island.gain - island.work <= kLastShare * (island.before + island.effort))
            continue;
        has_risen_[row] = true, island.work_of_risen = island.work;
    }
    find_velocities_without(solved);
    has_scaled_ = find_shares(solved);
    if (has_scaled_) scale(solved);
    return gained;
}

template <class Real>
std::size_t PassiveSubsteps<Real>::bytes() const {
    return groups_.capacity() * sizeof(Gain) + islands_.capacity() * sizeof(Island) + has_risen_.capacity() +
           rows_.bytes() + without_.bytes() + share_.capacity() * sizeof(double);
}

template class PassiveSubsteps<float>;
template class PassiveSubsteps<double>;

}  // namespace carom
