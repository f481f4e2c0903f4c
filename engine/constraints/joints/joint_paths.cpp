#include <algorithm>
#include <cmath>

#include "constraints/joints/gear_value.hpp"
#include "constraints/joints/joint_laws.hpp"
#include "constraints/joints/joint_system.hpp"

// The velocities of a system of joints: along paths that end where they should, or along the rows' tangents.

namespace carom {
namespace {

/// Turn of a body in a substep up to which paths are bent as they are [rad].
constexpr double kLargestTurn = 0.3;
/// Share of what the rows lack that a round of Newton's method must not leave.
constexpr double kLeastProgress = 0.5;
/// Rounds of it where not all rows hold: their own lack says nothing in the unit of a velocity.
constexpr int kFewestRounds = 2;
/// Energy after a substep's solve over that before which bent paths may have: what is held gives none.
constexpr double kMostGain = 1.01;
/// Share by which the work of springs and motors may be off.
constexpr double kOffWork = 0.01;

}  // namespace

/// Poses after h at the present velocities. A body that is stiffened, or turns too fast for the substep, goes
/// on a path that is less bent, which takes energy.
void JointSystem::move_poses() {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const SystemBody& body = bodies[i];
        JointPose& pose = moved_[i];
        pose.position = body.pose.position + h_ * body.velocity;
        const double angle = h_ * body.spin;
        Rotation turned = turn_by(angle);
        double share = 1;
        if (body.seen_inverse_inertia < body.inverse_inertia)
            share = body.seen_inverse_inertia / body.inverse_inertia;
        if (angle * angle > kLargestTurn * kLargestTurn)
            share *= kLargestTurn * kLargestTurn / (angle * angle);
        if (share < 1) {
            turned = {1 + share * (turned.cos - 1), angle + share * (turned.sin - angle)};
        }
        pose.turn = after(body.pose.turn, turned), pose.angle = body.pose.angle + angle;
    }
}

/// What the rows lack: of a path that ends where it should, or of a velocity along them.
void JointSystem::find_right_sides(bool is_curved) {
    if (is_curved) move_poses();
    const double per_h = 1 / h_;
    const auto pose_of = [&](std::int32_t body) -> const JointPose& {
        return moved_[static_cast<std::size_t>(body)];
    };
    std::array<double, 3> values;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const Member& member = joints[j];
        const JointRows& rows = rows_[j];
        if (is_curved && member.gear < 0)
            values_of(*member.joint, pose_of(member.a), pose_of(member.b), rows, values);
        if (is_curved && member.gear >= 0)
            values[0] = value_of_gear(gears_[static_cast<std::size_t>(member.gear)], pose_of);
        for (std::size_t i = 0; i < static_cast<std::size_t>(rows.firm); ++i) {
            const double speed =
                is_curved ? per_h * (values[i] - rows.row[i].value) : row_velocity(j, static_cast<int>(i));
            rhs_[j][i] = -speed - softness_[j][i] * (pull_[j][i] + member.impulse[i]);
        }
    }
    for (std::size_t e = 0; e < extras_.size(); ++e) {
        const Extra& extra = extras_[e];
        const auto j = static_cast<std::size_t>(extra.joint), i = static_cast<std::size_t>(extra.row);
        const Member& member = joints[j];
        const JointRow& row = rows_[j].row[i];
        low_[e] = extra.low - extra.impulse, high_[e] = extra.high - extra.impulse;
        if (row.law == RowLaw::motor) {
            extra_rhs_[e] = member.joint->motor_speed - row_velocity(j, extra.row);
        } else if (row.law != RowLaw::stop) {
            extra_rhs_[e] = rhs_[j][i];
        } else {
            const auto value = [&] {
                return value_of_stop(*member.joint, pose_of(member.a), pose_of(member.b), until_end_ - h_,
                                     rows_[j], extra.row);
            };
            const double speed =
                is_curved ? per_h * (value() - row.value) : row_velocity(j, extra.row) + row.rate;
            extra_rhs_[e] = -speed - per_h * std::fmax(row.value, 0);
        }
    }
    // What a taut loop pulls more than in the substep before is by how much longer it has become: implicit,
    // so that no substep is too long.
    const double part = part_ == Part::half ? 0.5 : 1;
    for (const TautLoop& loop : taut_) {
        const double more =
            along(loop, [&](std::size_t e) { return extras_[e].impulse - part * pulled_of(extras_[e]); });
        for (std::size_t k = 0; k < loop.rows; ++k)
            extra_rhs_[loop.first + k] -= loop.softness * more * loop.direction[k];
    }
}

void JointSystem::take_velocities() {
    for (const Link& link : links_) {
        SystemBody& body = bodies[static_cast<std::size_t>(link.body)];
        const Vector& change = change_[static_cast<std::size_t>(link.body)];
        body.velocity += Vec2{change[0], change[1]};
        body.spin += change[2];
        if (link.joint < 0) continue;
        std::array<double, 3>& impulse = joints[static_cast<std::size_t>(link.joint)].impulse;
        for (std::size_t i = 0; i < static_cast<std::size_t>(link.rows); ++i)
            impulse[i] += answer_[static_cast<std::size_t>(link.joint)][i];
    }
    for (std::size_t e = 0; e < extras_.size(); ++e) {
        Extra& extra = extras_[e];
        extra.impulse += solution_[e];
        const JointRow& row = row_of(extra);
        if (row.slot != kNoSlot)
            joints[static_cast<std::size_t>(extra.joint)].impulse[row.slot] += solution_[e];
    }
}

double JointSystem::largest_right_side() const {
    double largest = 0;
    for (std::size_t j = 0; j < joints.size(); ++j)
        for (int k = 0; k < rows_[j].firm; ++k) {
            const auto i = static_cast<std::size_t>(k);
            if (rows_[j].row[i].law == RowLaw::hold) largest = std::fmax(largest, std::fabs(rhs_[j][i]));
        }
    return largest;
}

void JointSystem::keep_velocities() {
    kept_velocities_.resize(bodies.size()), kept_impulses_.resize(joints.size());
    for (std::size_t i = 0; i < bodies.size(); ++i)
        kept_velocities_[i] = {bodies[i].velocity.x, bodies[i].velocity.y, bodies[i].spin};
    for (std::size_t j = 0; j < joints.size(); ++j) kept_impulses_[j] = joints[j].impulse;
    kept_extras_ = extras_;
}

void JointSystem::restore_velocities() {
    for (std::size_t i = 0; i < bodies.size(); ++i)
        bodies[i].velocity = {kept_velocities_[i][0], kept_velocities_[i][1]},
        bodies[i].spin = kept_velocities_[i][2];
    for (std::size_t j = 0; j < joints.size(); ++j) joints[j].impulse = kept_impulses_[j];
    extras_ = kept_extras_;
}

/// Where paths bend so much that the method does not come nearer, rows along the tangents do: they take
/// energy.
void JointSystem::solve_curved(int rounds, double least) {
    keep_velocities();
    const double energy = kinetic_energy();
    list_driven(driven_before_);
    if (!follow_curves(rounds, least)) {
        restore_velocities();
        follow_tangents();
    }
    take_back_gain(energy);
    hold_what_was_taken(energy);
}

void JointSystem::solve_flat() {
    keep_velocities();
    const double energy = kinetic_energy();
    list_driven(driven_before_);
    follow_tangents();
    take_back_gain(energy);
    hold_what_was_taken(energy);
}

/// What is held gives no energy. Bends of paths may, and so may bodies that are stiffened: to the system
/// their spins have an energy that they have not. Where there is more than `before` [J] and what springs,
/// motors and taut loops may give, velocities become those along the tangents, of bodies that are not
/// stiffened: a projection, which only takes. Taut loops keep their stiffness where tangents alone take
/// enough: without it they let go of what they pull.
void JointSystem::take_back_gain(double before) {
    const auto gains = [&] {
        const double work = driven_work();
        return kinetic_energy() - work > kMostGain * before + held_ + kOffWork * std::fabs(work);
    };
    if (!gains()) return;
    restore_velocities();
    if (!taut_.empty()) {
        follow_tangents();
        if (!gains()) return;
        restore_velocities();
    }
    for (SystemBody& body : bodies) body.seen_inverse_inertia = body.inverse_inertia;
    factor_tree();
    list_extras();
    couple_extras();
    recall_extras();
    follow_tangents();
}

/// @return whether each round came nearer
bool JointSystem::follow_curves(int rounds, double least) {
    double before = 0;
    // What is held may lack nothing while springs, motors and limits have still to act.
    const int fewest = has_springs_ || !extras_.empty() ? kFewestRounds : 0;
    for (int round = 0; round < rounds; ++round) {
        find_right_sides(true);
        const double now = largest_right_side();
        if (round >= fewest && now < least) return true;
        if (round > 0 && now > kLeastProgress * before) return false;
        before = now;
        solve_all();
        take_velocities();
    }
    return true;
}

/// Impulse and velocity of each row that may give energy: of springs, motors and limits that move.
void JointSystem::list_driven(std::vector<std::array<double, 2>>& driven) const {
    driven.clear();
    for (std::size_t j = 0; has_springs_ && j < joints.size(); ++j)
        for (int k = 0; k < rows_[j].firm; ++k)
            if (rows_[j].row[static_cast<std::size_t>(k)].law == RowLaw::spring)
                driven.push_back({joints[j].impulse[static_cast<std::size_t>(k)], row_velocity(j, k)});
    for (const Extra& extra : extras_)
        if ((extra.low < 0 && extra.low > -kUnbounded) || row_of(extra).rate != 0)
            driven.push_back({extra.impulse, row_velocity(static_cast<std::size_t>(extra.joint), extra.row)});
}

/// What springs, motors and limits that move have given since driven_before_ [J]: an impulse does its work at
/// the mean of the velocities before and after it.
double JointSystem::driven_work() {
    list_driven(driven_);
    double work = 0;
    for (std::size_t i = 0; i < driven_.size(); ++i)
        work += 0.5 * (driven_[i][0] - driven_before_[i][0]) * (driven_[i][1] + driven_before_[i][1]);
    return work;
}

double JointSystem::work_of_drives() {
    list_driven(driven_);
    double work = 0;
    for (const auto& [impulse, rate] : driven_) work += impulse * rate;
    // What joints hold takes as much from a body that nothing moves as it gives to others.
    const auto take = [&](std::size_t joint, int row, double impulse) {
        for_each_part(joint, row, [&](std::size_t number, const Vector& part) {
            const SystemBody& body = bodies[number];
            if (!(body.inverse_mass > 0))
                work -= impulse * dot3(part, {body.velocity.x, body.velocity.y, body.spin});
        });
    };
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const Member& member = joints[j];
        for (int k = 0; k < rows_[j].firm; ++k) take(j, k, member.impulse[static_cast<std::size_t>(k)]);
        if (member.joint->type != JointType::target) continue;
        const SystemBody& body = bodies[static_cast<std::size_t>(member.b)];
        const Vec2 arm = rotate(body.pose.turn, member.joint->anchor_b),
                   impulse{member.impulse[0], member.impulse[1]};
        work += dot(impulse, body.velocity) + cross(arm, impulse) * body.spin;
    }
    for (const Extra& extra : extras_) take(static_cast<std::size_t>(extra.joint), extra.row, extra.impulse);
    return work;
}

double JointSystem::kinetic_energy() const {
    double sum = 0;
    for (const SystemBody& body : bodies) {
        if (!(body.inverse_mass > 0)) continue;
        sum += 0.5 * length_squared(body.velocity) / body.inverse_mass;
        if (body.inverse_inertia > 0) sum += 0.5 * body.spin * body.spin / body.inverse_inertia;
    }
    return sum;
}

/// What the springs of taut loops hold [J] that pull so [N s a substep]: S l² / 2, with the softness S.
template <class Fn>
double JointSystem::energy_of_taut_loops(const Fn& pull_of) const {
    double sum = 0;
    for (const TautLoop& loop : taut_) {
        const double pull = along(loop, pull_of);
        sum += 0.5 * loop.softness * pull * pull;
    }
    return sum;
}

/// Taut loops pull no harder than by what they have taken from motion. In a net that turns, loops that are
/// taut by chance, each from another side, would pull against each other without bound.
void JointSystem::limit_pulls() {
    if (taut_.empty()) {
        held_ = 0;
        return;
    }
    const double energy = energy_of_taut_loops([&](std::size_t e) { return pulled_of(extras_[e]); });
    if (!(energy > held_)) return;
    const double share = std::sqrt(held_ / energy);
    for (const TautLoop& loop : taut_)
        for (std::size_t k = 0; k < loop.rows; ++k) pulled_of(extras_[loop.first + k]) *= share;
}

/// What joints have taken from motion in a solve, of `before` [J], is held by taut loops, as far as their
/// stretch can hold it.
void JointSystem::hold_what_was_taken(double before) {
    if (taut_.empty()) return;
    const double part = part_ == Part::half ? 0.5 : 1, taken = before + driven_work() - kinetic_energy(),
                 most = energy_of_taut_loops([&](std::size_t e) { return extras_[e].impulse / part; });
    held_ = std::fmax(0, std::fmin(held_ + taken, most));
}

void JointSystem::follow_tangents() {
    find_right_sides(false);
    solve_all();
    take_velocities();
}

}  // namespace carom
