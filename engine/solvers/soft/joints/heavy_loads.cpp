#include "solvers/soft/joints/heavy_loads.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "state/columns/index.hpp"

namespace carom {
namespace {

// docs/decisions/0069-loads-on-light-mechanisms.md has the measurements behind these.

/// What presses on a body is heavy if it weighs more than so many times as much: turns hand on what is less.
constexpr double kHeavy = 4;
/// Contacts times joints of their groups, at most, in a step: what is beyond is solved in turns alone.
constexpr std::size_t kMostWork = 1024;
/// Likewise motors times the square of all rows, which is what it takes to eliminate them: 0.1 ms a turn.
constexpr std::size_t kMostElimination = 1 << 18;
/// How heavy bodies may be to an impulse, in masses of all that joints connect with them: they are heavier
/// where joints hold them against the world, and a contact says what these say, or the contrary.
constexpr double kMostOfAll = 2;
/// Impulses that change velocities by less are none, in shares of what gravity adds in a substep.
constexpr double kTolerance = 1e-3;
/// Contacts are for the next substep where their bodies are farther apart than they would come if they
/// approached so many times as fast as they do, and so many times what gravity adds in a substep faster:
/// 4 mm at 1/60 s and four substeps. Bridges under loads open as with all contacts (decision 0082).
constexpr double kFaster = 2;
constexpr double kFallsOfContact = 25;
/// Motors that have less than this share of the inverse mass that they would have alone drive what others
/// hold.
constexpr double kLeastOfAlone = 1e-6;

JointBlow unit_blow(const HeldContact& contact, std::size_t side, std::size_t direction) {
    return {contact.row[side], contact.impulse_on(side, direction), contact.at_rim[side][direction]};
}

}  // namespace

/// The weight that a body may hand on [kg]: its own, or what joints connect with it.
template <class Real>
double HeavyLoads<Real>::weight_of(std::int32_t row, const Bodies<Real>& bodies,
                                   const SoftJoints<Real>& joints) const {
    const std::int32_t group = joints.exact_group_of(row);
    return group < 0 ? static_cast<double>(bodies.mass[index(row)]) : weight_[index(group)];
}

/// A load weighs on the body that it touches and, by way of joints, on all of its group; and that on another
/// group that it touches.
template <class Real>
void HeavyLoads<Real>::weigh_groups(const HeldContacts<Real>& contacts, const Bodies<Real>& bodies,
                                    SoftJoints<Real>& joints) {
    weight_.resize(joints.exact_groups());
    for (std::size_t group = 0; group < weight_.size(); ++group)
        weight_[group] = joints.exact_group(static_cast<std::int32_t>(group)).heaviest();
    constexpr int kRounds = 2;  // a load on a group, and that group as a load on another one
    for (int round = 0; round < kRounds; ++round)
        contacts.for_each(joints.contacts(), bodies, [&](const HeldContact& contact) {
            for (std::size_t side = 0; side < 2; ++side) {
                const std::int32_t row = contact.row[side], other = contact.row[1 - side];
                if (row == HeldContact::kNothing || other == HeldContact::kNothing) continue;
                const std::int32_t group = joints.exact_group_of(row);
                if (group < 0) continue;
                double& weight = weight_[index(group)];
                weight = std::fmax(weight, weight_of(other, bodies, joints));
            }
        });
}

/// Whether by way of a contact more may press on a body that joints hold than it is taken for.
template <class Real>
bool HeavyLoads<Real>::is_heavy(const HeldContact& contact, const Bodies<Real>& bodies,
                                const SoftJoints<Real>& joints) const {
    double weight = HUGE_VAL, lightest = HUGE_VAL;
    std::int32_t group_before = -1;
    for (const std::int32_t row : contact.row) {
        if (row == HeldContact::kNothing) continue;
        weight = std::fmin(weight, weight_of(row, bodies, joints));
        const std::int32_t group = joints.exact_group_of(row);
        if (group < 0) continue;
        if (group == group_before) return false;
        group_before = group;
        lightest = std::fmin(lightest, static_cast<double>(bodies.mass[index(row)]));
    }
    return weight > kHeavy * lightest;
}

template <class Real>
void HeavyLoads<Real>::find(const HeldContacts<Real>& contacts, const JointStep<Real>& step,
                            SoftJoints<Real>& joints) {
    found_.clear(), contacts_.clear(), groups_.clear();
    if (!joints.touches_exactly()) return;
    const Bodies<Real>& bodies = step.world.bodies;
    weigh_groups(contacts, bodies, joints);
    std::size_t work = 0, motors = 0;
    contacts.for_each(joints.contacts(), bodies, [&](const HeldContact& contact) {
        if (!is_heavy(contact, bodies, joints)) return;
        std::size_t more = 0;
        const auto for_each_group = [&](const auto& fn) {
            for (const std::int32_t row : contact.row)
                if (row != HeldContact::kNothing && joints.exact_group_of(row) >= 0)
                    fn(joints.exact_group_of(row));
        };
        for_each_group([&](std::int32_t group) { more += joints.exact_group(group).joints(); });
        std::size_t motors_with = motors;
        for_each_group([&](std::int32_t group) {
            if (std::find(groups_.begin(), groups_.end(), group) == groups_.end())
                motors_with += joints.exact_group(group).motor_count();
        });
        const std::size_t rows = kDirections * (found_.size() + 1) + motors_with;
        if (work + more > kMostWork || motors_with * rows * rows > kMostElimination) return;
        work += more, motors = motors_with;
        found_.push_back(contact);
        for_each_group([&](std::int32_t group) {
            if (std::find(groups_.begin(), groups_.end(), group) == groups_.end()) groups_.push_back(group);
        });
    });
}

/// Whether a contact may press in this substep: it did in the one before, or its bodies are near enough.
template <class Real>
bool HeavyLoads<Real>::may_press(const HeldContact& contact, const HeldContacts<Real>& contacts,
                                 const JointStep<Real>& step) {
    const HeldContact::Values impulses = contacts.impulses(contact);
    if (impulses != HeldContact::Values{}) return true;
    const HeldContact::Values parting = contacts.parting(contact);
    for (std::size_t point = 0; point < HeldContact::kPoints; ++point) {
        if (!contact.acts[point]) continue;
        const double nearer =
            std::fmax(0, -kFaster * parting[point]) + kFallsOfContact * step.terms.fall_speed();
        if (contacts.separation(contact, point) < step.terms.substep_dt * nearer) return true;
    }
    return false;
}

template <class Real>
void HeavyLoads<Real>::tell(const HeldContacts<Real>& contacts, const JointStep<Real>& step,
                            SoftJoints<Real>& joints) {
    told_.clear(), contacts_.clear(), groups_.clear();
    for (const HeldContact& contact : found_) {
        if (!may_press(contact, contacts, step)) continue;
        contacts_.push_back(contact);
        for (const std::int32_t row : contact.row)
            if (row != HeldContact::kNothing && joints.exact_group_of(row) >= 0)
                groups_.push_back(joints.exact_group_of(row));
    }
    std::sort(groups_.begin(), groups_.end());
    groups_.erase(std::unique(groups_.begin(), groups_.end()), groups_.end());
    for (const HeldContact& contact : contacts_)
        for (std::size_t point = 0; point < HeldContact::kPoints; ++point) {
            if (!contact.acts[point]) continue;
            const double separation = contacts.separation(contact, point);
            for (std::size_t side = 0; side < 2; ++side) {
                const std::int32_t row = contact.row[side], other = contact.row[1 - side];
                const std::int32_t group = row == HeldContact::kNothing ? -1 : joints.exact_group_of(row);
                if (group < 0) continue;
                DirectJoints<Real>& own = joints.exact_group(group);
                JointSystem::Load load = own.load_on(unit_blow(contact, side, point));
                load.separation = separation, load.other = other;
                if (other != HeldContact::kNothing) {
                    const JointBlow push = unit_blow(contact, 1 - side, point);
                    const auto inverse = static_cast<double>(step.records.velocity[4 * index(other) + 3]);
                    load.other_along = {push.impulse.x, push.impulse.y, push.at_rim};
                    load.inverse_mass = std::fabs(inverse);
                    load.inverse_inertia = 2 * std::fmax(inverse, 0);  // at the rim
                }
                told_.push_back({group, own.loads().size()});
                own.loads().push_back(load);
            }
        }
}

template <class Real>
void HeavyLoads<Real>::displace_loads(const JointStep<Real>& step, SoftJoints<Real>& joints) const {
    Column<Real>& displacement = step.records.displacement;
    Real* turn = step.records.turn();
    for (const Told& told : told_) {
        const JointSystem::Load& load = joints.exact_group(told.group).loads()[told.load];
        if (load.other == HeldContact::kNothing) continue;
        const double way = load.push * load.inverse_mass, turned = load.push * load.inverse_inertia;
        displacement[2 * index(load.other)] += static_cast<Real>(way * load.other_along[0]);
        displacement[2 * index(load.other) + 1] += static_cast<Real>(way * load.other_along[1]);
        if (turn) turn[load.other] += static_cast<Real>(turned * load.other_along[2]);
    }
    for (const std::int32_t group : groups_) joints.exact_group(group).loads().clear();
}

/// What impulse `by` changes the velocity of a row by, along the directions of all contacts of that row.
template <class Real>
void HeavyLoads<Real>::add_answer(std::size_t by, std::int32_t row, const std::array<double, 3>& change) {
    for (std::size_t c = 0; c < contacts_.size(); ++c)
        for (std::size_t side = 0; side < 2; ++side) {
            if (contacts_[c].row[side] != row) continue;
            for (std::size_t d = 0; d < kDirections; ++d)
                impulses_.inverse_mass(kDirections * c + d, by) +=
                    contacts_[c].part_of(side, d, {change[0], change[1]}, change[2]);
        }
}

/// The ends of contacts that joints hold: by group, which bodies they are on, and what unit impulses give
/// them.
template <class Real>
void HeavyLoads<Real>::list_held_ends(SoftJoints<Real>& joints) {
    for (HeldGroup& group : held_) group.rows.clear(), group.ends.clear();
    if (held_.size() < groups_.size()) held_.resize(groups_.size());
    for (std::size_t i = 0; i < kDirections * contacts_.size(); ++i) {
        const HeldContact& contact = contacts_[i / kDirections];
        for (std::size_t side = 0; side < 2 && contact.acts[i % kDirections]; ++side) {
            const JointBlow blow = unit_blow(contact, side, i % kDirections);
            const std::int32_t number =
                blow.row == HeldContact::kNothing ? -1 : joints.exact_group_of(blow.row);
            if (number < 0) continue;
            HeldGroup& group = held_[number_of(number)];
            const auto place = std::find(group.rows.begin(), group.rows.end(), blow.row);
            const auto body = static_cast<std::size_t>(place - group.rows.begin());
            if (place == group.rows.end()) group.rows.push_back(blow.row);
            group.ends.push_back({i, body, group.rows.size() - 1, joints.exact_group(number).push_of(blow)});
        }
    }
}

template <class Real>
void HeavyLoads<Real>::find_masses(const JointStep<Real>& step, SoftJoints<Real>& joints) {
    first_motor_.assign(1, 0);
    for (const std::int32_t group : groups_)
        first_motor_.push_back(first_motor_.back() + joints.exact_group(group).motors(step).size());
    impulses_.reset(kDirections * contacts_.size() + first_motor_.back());
    list_held_ends(joints);
    for (std::size_t g = 0; g < groups_.size(); ++g) add_answers(g, joints);
    // What no joint holds answers alone.
    for (std::size_t i = 0; i < kDirections * contacts_.size(); ++i) {
        const HeldContact& contact = contacts_[i / kDirections];
        for (std::size_t side = 0; side < 2 && contact.acts[i % kDirections]; ++side) {
            const JointBlow blow = unit_blow(contact, side, i % kDirections);
            if (blow.row == HeldContact::kNothing || joints.exact_group_of(blow.row) >= 0) continue;
            add_answer(i, blow.row, change_of_free(step.records.velocity, blow));
        }
    }
}

/// What a group answers to the impulses of contacts on it, and of its motors.
template <class Real>
void HeavyLoads<Real>::add_answers(std::size_t g, SoftJoints<Real>& joints) {
    const HeldGroup& held = held_[g];
    DirectJoints<Real>& group = joints.exact_group(groups_[g]);
    group.find_answers(held.rows);
    changes_.resize(held.rows.size());
    const auto add = [&](std::size_t by, const HeldEnd& end) {
        double& inverse = impulses_.inverse_mass(end.direction, by);
        for (std::size_t c = 0; c < 3; ++c) inverse += end.push[c] * changes_[end.body][c];
    };
    // What one impulse does to another is what that does to it, so half of them are found.
    for (std::size_t e = 0; e < held.ends.size(); ++e) {
        const HeldEnd& end = held.ends[e];
        for (std::size_t body = 0; body <= held.ends[e].last_body; ++body) {
            const JointSystem::Vector x = group.answer_to(3 * end.body, body),
                                      y = group.answer_to(3 * end.body + 1, body),
                                      spin = group.answer_to(3 * end.body + 2, body);
            for (std::size_t k = 0; k < 3; ++k)
                changes_[body][k] = end.push[0] * x[k] + end.push[1] * y[k] + end.push[2] * spin[k];
        }
        for (std::size_t other = 0; other < e; ++other) {
            const HeldEnd& before = held.ends[other];
            double inverse = 0;
            for (std::size_t c = 0; c < 3; ++c) inverse += before.push[c] * changes_[before.body][c];
            impulses_.inverse_mass(before.direction, end.direction) += inverse;
            impulses_.inverse_mass(end.direction, before.direction) += inverse;
        }
        add(end.direction, end);
        for_each_motor(g, joints, [&](std::size_t row, const JointSystem::Motor& motor) {
            for (std::size_t c = 0; c < 3; ++c)
                impulses_.inverse_mass(row, end.direction) +=
                    end.push[c] * group.answer_to(3 * end.body + c, motor);
        });
    }
    std::size_t side = 3 * held.rows.size();
    for_each_motor(g, joints, [&](std::size_t by, const JointSystem::Motor& motor) {
        for (std::size_t body = 0; body < held.rows.size(); ++body)
            changes_[body] = group.answer_to(side, body);
        for (const HeldEnd& end : held.ends) add(by, end);
        for_each_motor(g, joints, [&](std::size_t row, const JointSystem::Motor& other) {
            impulses_.inverse_mass(row, by) += group.answer_to(side, other);
        });
        impulses_.least_inverse_mass[by] = kLeastOfAlone * motor.alone;
        ++side;
    });
}

template <class Real>
void HeavyLoads<Real>::leave_held_directions(const Bodies<Real>& bodies, SoftJoints<Real>& joints) {
    for (std::size_t i = 0; i < kDirections * contacts_.size(); ++i) {
        double mass = 0;  // kg, of all that could move
        for (const std::int32_t row : contacts_[i / kDirections].row) {
            if (row == HeldContact::kNothing) continue;
            const std::int32_t group = joints.exact_group_of(row);
            mass +=
                group < 0 ? static_cast<double>(bodies.mass[index(row)]) : joints.exact_group(group).mass();
        }
        impulses_.least_inverse_mass[i] = 1 / (kMostOfAll * mass);
    }
}

template <class Real>
void HeavyLoads<Real>::begin_substep(const JointStep<Real>& step, SoftJoints<Real>& joints) {
    if (empty()) return;
    displace_loads(step, joints);
    find_answers(step, joints);
}

template <class Real>
void HeavyLoads<Real>::find_answers(const JointStep<Real>& step, SoftJoints<Real>& joints) {
    find_masses(step, joints);
    leave_held_directions(step.world.bodies, joints);
}

/// What motors give and lack now, behind the rows of contacts.
template <class Real>
void HeavyLoads<Real>::read_motors(const JointStep<Real>& step, SoftJoints<Real>& joints) {
    motors_.clear();
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        joints.exact_group(groups_[g]).motors(step);
        for_each_motor(g, joints, [&](std::size_t row, const JointSystem::Motor& motor) {
            impulses_.given[row] = motor.impulse, impulses_.lack[row] = motor.lack;
            motors_.push_back({motor.low, motor.high});
        });
    }
}

template <class Real>
double HeavyLoads<Real>::solve(const HeldContacts<Real>& contacts, const JointStep<Real>& step,
                               SoftJoints<Real>& joints) {
    // Joints were solved again: a body that a limit no longer holds is as light as it is.
    const bool answers_hold = std::all_of(groups_.begin(), groups_.end(), [&](std::int32_t group) {
        return joints.exact_group(group).answers_hold();
    });
    if (!answers_hold) find_answers(step, joints);
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        const HeldContact::Values lack = contacts.lack(contacts_[c]),
                                  impulses = contacts.impulses(contacts_[c]);
        std::copy(lack.begin(), lack.end(), &impulses_.lack[kDirections * c]);
        std::copy(impulses.begin(), impulses.end(), &impulses_.given[kDirections * c]);
    }
    read_motors(step, joints);
    more_ = impulses_.given;
    const auto bound = [&](std::size_t i, double wanted) {
        if (i % kDirections < HeldContact::kTangent) return std::fmax(wanted, 0);
        const double limit =
            contacts_[i / kDirections].friction * (impulses_.given[i - 2] + impulses_.given[i - 1]);
        return std::clamp(wanted, -limit, limit);
    };
    impulses_.solve(motors_, bound, kTolerance * step.terms.fall_speed());
    double largest = 0;
    for (std::size_t i = 0; i < more_.size(); ++i) {
        more_[i] = impulses_.given[i] - more_[i];
        largest = std::fmax(largest, impulses_.inverse_mass(i, i) * std::fabs(more_[i]));
    }
    if (largest == 0) return 0;

    if (blows_.size() < groups_.size()) blows_.resize(groups_.size());
    for (std::vector<JointBlow>& blows : blows_) blows.clear();
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        const HeldContact& contact = contacts_[c];
        HeldContact::Values more;
        std::copy_n(&more_[kDirections * c], kDirections, more.begin());
        contacts.add(contact, more);
        for (std::size_t side = 0; side < 2; ++side) {
            JointBlow blow{contact.row[side], {}, 0};
            if (blow.row == HeldContact::kNothing) continue;
            for (std::size_t d = 0; d < kDirections; ++d)
                blow.impulse += more[d] * contact.impulse_on(side, d),
                    blow.at_rim += more[d] * contact.at_rim[side][d];
            if (const std::int32_t group = joints.exact_group_of(blow.row); group >= 0) {
                blows_[number_of(group)].push_back(blow);
                continue;
            }
            const std::array<double, 3> change = change_of_free(step.records.velocity, blow);
            for (std::size_t k = 0; k < change.size(); ++k)
                step.records.velocity[4 * index(blow.row) + k] += static_cast<Real>(change[k]);
        }
    }
    const std::span<const double> of_motors(more_.data() + kDirections * contacts_.size(), motors_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g)
        joints.exact_group(groups_[g])
            .take_blows(step, blows_[g],
                        of_motors.subspan(first_motor_[g], first_motor_[g + 1] - first_motor_[g]));
    return largest;
}

template <class Real>
std::size_t HeavyLoads<Real>::bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    std::size_t bytes = of(found_) + of(contacts_) + of(groups_) + of(weight_) + of(told_) +
                        of(first_motor_) + of(motors_) + impulses_.bytes() + of(more_) + of(blows_) +
                        of(held_) + of(changes_);
    for (const std::vector<JointBlow>& blows : blows_) bytes += of(blows);
    for (const HeldGroup& group : held_) bytes += of(group.rows) + of(group.ends);
    return bytes;
}

template class HeavyLoads<float>;
template class HeavyLoads<double>;

}  // namespace carom
