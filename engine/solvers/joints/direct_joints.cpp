#include "solvers/joints/direct_joints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {
namespace {

/// Rounds of Newton's method a substep: a second one takes what the bend of the path leaves.
constexpr int kRounds = 2;
/// As many as it can take to round-off, at most.
constexpr int kMostRounds = 20;
/// What joints may give at the end of a step, above what drives do: a share of the energy that their bodies
/// have, and that of so many times the speed that gravity adds in a substep.
constexpr double kLeastShareOfEnd = 0.01;
constexpr double kFallsOfEnd = 8;

}  // namespace

template <class Real>
DirectJoints<Real>::DirectJoints(const WorldState<Real>& world, const std::vector<std::size_t>& slots)
    : slots_(slots) {
    system_.bodies.emplace_back();
    rows_.push_back(-1), rim_.push_back(1);
    std::vector<std::pair<std::uint32_t, std::int32_t>> known;  // slot of a handle, number of a body
    const auto number_of = [&](BodyId id) {
        if (id == BodyId{}) return std::int32_t{0};
        const auto place = std::lower_bound(known.begin(), known.end(), std::pair{id.index, std::int32_t{0}});
        if (place != known.end() && place->first == id.index) return place->second;
        const auto number = static_cast<std::int32_t>(system_.bodies.size());
        known.insert(place, {id.index, number});
        const std::size_t row = world.handles.row_of_slot(id.index);
        may_drive_ = may_drive_ || (world.bodies.flags_of(row) & kKinematic) != 0;
        SystemBody& body = system_.bodies.emplace_back();
        rows_.push_back(static_cast<std::int32_t>(row));
        rim_.push_back(rim_of(world.bodies, row));
        body.inverse_mass = world.bodies.inverse_mass(row);
        if (body.inverse_mass > 0) {
            moving_row_ = rows_.back();
            mass_ += 1 / body.inverse_mass, heaviest_ = std::fmax(heaviest_, 1 / body.inverse_mass);
        }
        body.inverse_inertia = inverse_inertia_of(world.bodies, row);
        body.seen_inverse_inertia = body.inverse_inertia;
        return number;
    };
    double longest = 0;
    for (const std::size_t slot : slots_) {
        const StoredJoint& joint = world.joints[slot];
        JointSystem::Member member;
        member.joint = &joint;
        member.a = number_of(joint.a), member.b = number_of(joint.b);
        longest = std::fmax(longest, joint.length);
        for (const auto& [number, arm] : {std::pair{member.a, joint.anchor_a}, {member.b, joint.anchor_b}})
            if (system_.bodies[static_cast<std::size_t>(number)].inverse_mass > 0)
                longest = std::fmax(longest, std::sqrt(length_squared(arm)));
        system_.joints.push_back(member);
        motor_count_ += joint.has_motor;
        may_drive_ = may_drive_ || joint.is_spring() || joint.has_motor || joint.type == JointType::target;
    }
    const auto number_in_system = [&](std::uint32_t slot) {
        const auto place = std::find(slots_.begin(), slots_.end(), slot);
        return place == slots_.end() ? std::int32_t{-1} : static_cast<std::int32_t>(place - slots_.begin());
    };
    for (std::size_t j = 0; j < slots_.size(); ++j)
        if (const StoredJoint& joint = world.joints[slots_[j]]; joint.type == JointType::gear)
            system_.add_gear(j, number_in_system(joint.first), number_in_system(joint.second));
    for (std::size_t i = 1; i < rim_.size(); ++i)
        if (system_.bodies[i].inverse_mass > 0) longest = std::fmax(longest, rim_[i]);
    length_ = longest;
    system_.plan();
    given_.resize(rows_.size()), last_impulse_.resize(slots_.size());
}

template <class Real>
void DirectJoints<Real>::begin_step(const JointStep<Real>& step, bool touches, bool is_beside,
                                    bool converges) {
    touches_ = touches, is_beside_ = is_beside, converges_ = converges;
    const Bodies<Real>& bodies = step.world.bodies;
    for (std::size_t j = 0; j < slots_.size(); ++j)
        system_.joints[j].least_gamma = is_beside ? step.springs.least_gamma_in_turns(slots_[j])
                                                  : step.springs.least_gamma_at_once(slots_[j]);
    system_.set_substep(step.terms.substep_dt);
    system_.begin_step(converges);
    double farthest = 0;
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        const auto row = static_cast<std::size_t>(rows_[i]);
        SystemBody& body = system_.bodies[i];
        const double angle = bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0;
        body.pose = {{bodies.position_x[row], bodies.position_y[row]}, rotation_by(angle), angle};
        farthest = std::max({farthest, std::fabs(body.pose.position.x), std::fabs(body.pose.position.y)});
        given_[i] = {};
    }
    // All but round-off: taut chains explode where errors of the world's own precision are let stand and then
    // taken away at once.
    least_error_ = 16 * std::numeric_limits<double>::epsilon() * farthest;
    double held = 0;
    limits_move_ = false;
    for (std::size_t j = 0; j < slots_.size(); ++j) {
        system_.joints[j].joint = &step.world.joints[slots_[j]];  // the store may have moved
        held += system_.joints[j].joint->held;
        limits_move_ = limits_move_ || system_.joints[j].joint->has_moving_limit();
        system_.joints[j].impulse = system_.joints[j].joint->impulse;
        system_.joints[j].force = {}, system_.joints[j].torque = 0;
    }
    system_.set_held(held);
    const auto is_free = [&](std::uint32_t slot) { return step.world.joints[slot].is_free; };
    was_free_ = std::all_of(slots_.begin(), slots_.end(), is_free);
    if (was_free_) half_kick(step, -1);
}

/// Velocities at whole times less half of what gravity adds in a substep are those between two substeps, and
/// that again at the end (end_step): so each substep advances from the middle of one to the middle of the
/// next. A group that touches something keeps velocities between substeps to the end, as contacts do, and
/// its next step begins with them: so neither the first touch nor the last changes its energy.
template <class Real>
void DirectJoints<Real>::half_kick(const JointStep<Real>& step, double sign) {
    const Vec2 kick = 0.5 * sign * step.terms.gravity_change,
               of_gravity = (0.5 * sign * step.terms.substep_dt) * step.world.gravity;
    if (kick == Vec2{}) return;
    double work_of_drag = 0;  // J: what it takes from the kick
    const StartColumns<Real> start = step.records.start_columns();
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        if (!(system_.bodies[i].inverse_mass > 0)) continue;
        const auto row = static_cast<std::size_t>(rows_[i]);
        Real* record = &step.records.velocity[4 * row];
        // At the start of a step the record has the whole kick of its first substep in it already.
        const Vec2 v = sign < 0 ? Vec2{start.x[row], start.y[row]} : Vec2{record[0], record[1]};
        const Vec2 momentum = static_cast<double>(step.world.bodies.mass[row]) * (v + 0.5 * kick);
        step.gravity_work += dot(of_gravity, momentum);
        work_of_drag += dot(kick - of_gravity, momentum);
        // Drag has acted on that record, too, and takes of the kick what it takes of all velocities.
        const double left = sign < 0 ? step.terms.decay : 1;
        record[0] += static_cast<Real>(left * kick.x), record[1] += static_cast<Real>(left * kick.y);
        if (sign < 0) start.x[row] += static_cast<Real>(kick.x), start.y[row] += static_cast<Real>(kick.y);
    }
    if (step.world.books.is_open) step.world.books.drag += work_of_drag;
}

template <class Real>
void DirectJoints<Real>::read_poses(const JointStep<Real>& step) {
    const Bodies<Real>& bodies = step.world.bodies;
    const Column<Real>& displacement = step.records.displacement;
    const Real* turn = bodies.has_rotation ? step.records.turn() : nullptr;
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        const auto row = static_cast<std::size_t>(rows_[i]);
        JointPose& pose = system_.bodies[i].pose;
        pose.position = {
            static_cast<double>(bodies.position_x[row]) + static_cast<double>(displacement[2 * row]),
            static_cast<double>(bodies.position_y[row]) + static_cast<double>(displacement[2 * row + 1])};
        if (!turn) continue;
        const double angle =
            static_cast<double>(bodies.angle[row]) + static_cast<double>(turn[row]) / rim_[i];
        if (angle != pose.angle) turn_pose(pose, angle - pose.angle);
    }
}

/// Displaces bodies so that what is held is where it should be.
template <class Real>
void DirectJoints<Real>::correct(const JointStep<Real>& step) {
    if (!system_.correct_positions(least_error_, length_)) return;
    write_poses(step);
}

template <class Real>
void DirectJoints<Real>::write_poses(const JointStep<Real>& step) {
    const Bodies<Real>& bodies = step.world.bodies;
    Column<Real>& displacement = step.records.displacement;
    Real* turn = bodies.has_rotation ? step.records.turn() : nullptr;
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        const SystemBody& body = system_.bodies[i];
        if (!(body.inverse_mass > 0)) continue;
        const auto row = static_cast<std::size_t>(rows_[i]);
        displacement[2 * row] =
            static_cast<Real>(body.pose.position.x - static_cast<double>(bodies.position_x[row]));
        displacement[2 * row + 1] =
            static_cast<Real>(body.pose.position.y - static_cast<double>(bodies.position_y[row]));
        if (turn && body.inverse_inertia > 0)
            turn[row] =
                static_cast<Real>(rim_[i] * (body.pose.angle - static_cast<double>(bodies.angle[row])));
    }
}

/// Records of what was solved; what joints gave is the difference to what was read, as it is rounded.
template <class Real>
void DirectJoints<Real>::write_velocities(const JointStep<Real>& step) {
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        const SystemBody& body = system_.bodies[i];
        if (!(body.inverse_mass > 0)) continue;
        Real* record = &step.records.velocity[4 * static_cast<std::size_t>(rows_[i])];
        record[0] = static_cast<Real>(body.velocity.x), record[1] = static_cast<Real>(body.velocity.y);
        const Vec2 change = Vec2{record[0], record[1]} - before_[i].velocity;
        given_[i].velocity += change;
        largest_change_ = std::fmax(largest_change_, std::fmax(std::fabs(change.x), std::fabs(change.y)));
        if (!(body.inverse_inertia > 0)) continue;
        record[2] = static_cast<Real>(rim_[i] * body.spin);
        const double turn = static_cast<double>(record[2]) / rim_[i] - before_[i].spin;
        given_[i].spin += turn;
        largest_change_ = std::fmax(largest_change_, rim_[i] * std::fabs(turn));
    }
}

/// The velocities that a substep begins with foresee the impulses of the one before (advance_bodies.hpp),
/// along what joints were then: those are taken out, as the system finds its own.
template <class Real>
void DirectJoints<Real>::solve_first(const JointStep<Real>& step, int substep) {
    read_poses(step);
    system_.set_until_end(step.terms.until_end());
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        const Real* record = &step.records.velocity[4 * static_cast<std::size_t>(rows_[i])];
        SystemBody& body = system_.bodies[i];
        body.velocity = Vec2{record[0], record[1]};
        body.spin = static_cast<double>(record[2]) / rim_[i];
        if (is_beside_ && substep > 0) continue;
        if (substep > 0 && body.inverse_mass > 0) {
            body.velocity -= given_[i].velocity;
            body.spin -= given_[i].spin;
        }
        given_[i] = {};
    }
    before_ = system_.bodies;
    if (is_beside_) {
        // Impulses go on from substep to substep, as those of swept joints do.
        system_.prepare(JointSystem::Part::whole, true);
        correct(step);
        if (substep == 0) system_.give_impulses();
        system_.solve_curved(1);
    } else {
        system_.prepare(was_free_ && substep == 0 ? JointSystem::Part::half : JointSystem::Part::whole);
        correct(step);
        system_.pull();
        if (converges_)
            system_.solve_curved(kMostRounds, least_error_ / step.terms.substep_dt);
        else
            system_.solve_curved(kRounds);
    }
    write_velocities(step);
}

template <class Real>
void DirectJoints<Real>::read_velocities(const JointStep<Real>& step) {
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        const Real* record = &step.records.velocity[4 * static_cast<std::size_t>(rows_[i])];
        system_.bodies[i].velocity = Vec2{record[0], record[1]};
        system_.bodies[i].spin = static_cast<double>(record[2]) / rim_[i];
    }
    before_ = system_.bodies;
}

/// Whether a velocity is another than the one that was written last.
template <class Real>
bool DirectJoints<Real>::has_changed(const JointStep<Real>& step) const {
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        const SystemBody& body = system_.bodies[i];
        if (!(body.inverse_mass > 0)) continue;
        const Real* record = &step.records.velocity[4 * static_cast<std::size_t>(rows_[i])];
        if (record[0] != static_cast<Real>(body.velocity.x) ||
            record[1] != static_cast<Real>(body.velocity.y))
            return true;
        if (body.inverse_inertia > 0 && record[2] != static_cast<Real>(rim_[i] * body.spin)) return true;
    }
    return false;
}

template <class Real>
void DirectJoints<Real>::solve_again(const JointStep<Real>& step) {
    largest_change_ = 0;
    // Loops that hit something hand on in further rounds what the first one leaves to their last joints.
    if (loops() == 0 && !has_changed(step)) return;
    read_velocities(step);
    system_.solve_curved(1);
    write_velocities(step);
}

template <class Real>
void DirectJoints<Real>::solve_anew(const JointStep<Real>& step) {
    read_velocities(step);
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        SystemBody& body = system_.bodies[i];
        if (body.inverse_mass > 0) body.velocity -= given_[i].velocity, body.spin -= given_[i].spin;
        given_[i] = {};
    }
    before_ = system_.bodies;
    system_.forget_impulses();
    system_.pull();
    system_.solve_curved(kRounds);
    write_velocities(step);
}

template <class Real>
void DirectJoints<Real>::find_answers(std::span<const std::int32_t> rows) {
    asked_.clear();
    for (const std::int32_t row : rows) asked_.push_back(number_of(row));
    system_.find_answers(asked_, JointSystem::Drives::no_motors);
}

template <class Real>
void DirectJoints<Real>::take_blows(const JointStep<Real>& step, std::span<const JointBlow> blows,
                                    std::span<const double> of_motors) {
    read_velocities(step);
    blows_.clear();
    for (const JointBlow& blow : blows) blows_.push_back(blow_of(blow));
    for (std::size_t m = 0; m < of_motors.size(); ++m) {
        system_.push_motor(motors_[m], of_motors[m], blows_);
        system_.add_to_motor(motors_[m], of_motors[m]);
    }
    system_.answer(blows_, JointSystem::Drives::no_motors);
    system_.take_answer();
    write_velocities(step);
    // What the blows of contacts alone gave is not the joints'.
    for (const JointSystem::Blow& blow : std::span(blows_).first(blows.size())) {
        const SystemBody& body = system_.bodies[blow.body];
        given_[blow.body].velocity -= body.inverse_mass * Vec2{blow.impulse[0], blow.impulse[1]};
        given_[blow.body].spin -= body.inverse_inertia * blow.impulse[2];
    }
}

template <class Real>
void DirectJoints<Real>::end_step(const JointStep<Real>& step) {
    if (touches_) return;
    half_kick(step, 1);
    read_poses(step);
    system_.set_until_end(step.terms.behind);
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        const Real* record = &step.records.velocity[4 * static_cast<std::size_t>(rows_[i])];
        system_.bodies[i].velocity = Vec2{record[0], record[1]};
        system_.bodies[i].spin = static_cast<double>(record[2]) / rim_[i];
        given_[i] = {};
    }
    before_ = system_.bodies;
    // What the next step starts from are those of the last substep: these bring curved paths to their
    // tangents, too, and say little of the pull of a joint.
    const double whole = system_.part() == JointSystem::Part::half ? 2 : 1;
    for (std::size_t j = 0; j < slots_.size(); ++j) last_impulse_[j] = system_.joints[j].impulse;
    system_.prepare(JointSystem::Part::half);
    correct(step);
    system_.pull();
    system_.solve_flat();
    bound_end(step);
    write_velocities(step);
    for (auto& impulse : last_impulse_)
        for (double& part : impulse) part *= whole;
}

/// Loops that can hardly be closed, of joints that are torn or stretched, may be solved to impulses that
/// throw their bodies apart. Those of substeps are bounded with contacts (bound_energy); of the half of one
/// at the end of a step only the share is given at which bodies have the least energy.
template <class Real>
void DirectJoints<Real>::bound_end(const JointStep<Real>& step) {
    double energy = 0, along = 0, square = 0;  // J; twice the energy of the changes alone
    for (std::size_t i = 1; i < before_.size(); ++i) {
        const SystemBody& body = system_.bodies[i];
        if (!(body.inverse_mass > 0)) continue;
        const double mass = 1 / body.inverse_mass,
                     inertia = body.inverse_inertia > 0 ? 1 / body.inverse_inertia : 0;
        const Vec2 v = before_[i].velocity, change = body.velocity - v;
        const double spin = before_[i].spin, turn = body.spin - spin;
        energy += 0.5 * (mass * dot(v, v) + inertia * spin * spin);
        along += mass * dot(v, change) + inertia * spin * turn;
        square += mass * dot(change, change) + inertia * turn * turn;
    }
    const double fall = kFallsOfEnd * step.terms.fall_speed(), gained = along + 0.5 * square,
                 free = kLeastShareOfEnd * energy + 0.5 * mass_ * fall * fall;
    if (gained <= free) return;
    at_end_ = system_.bodies;
    double work = 0;  // J
    if (may_drive()) {
        for (std::size_t i = 1; i < at_end_.size(); ++i) {
            system_.bodies[i].velocity = 0.5 * (before_[i].velocity + at_end_[i].velocity);
            system_.bodies[i].spin = 0.5 * (before_[i].spin + at_end_[i].spin);
        }
        work = system_.work_of_drives();
        system_.bodies = at_end_;
    }
    if (gained - work <= free + kLeastShareOfEnd * std::fabs(work)) return;
    const double best = (work - along) / square, share = best > 0 ? std::fmin(best, 1) : 0;
    for (std::size_t i = 1; i < at_end_.size(); ++i) {
        SystemBody& body = system_.bodies[i];
        body.velocity = before_[i].velocity, body.spin = before_[i].spin;
        if (share > 0) {
            body.velocity += share * (at_end_[i].velocity - before_[i].velocity);
            body.spin += share * (at_end_[i].spin - before_[i].spin);
        }
    }
    system_.scale(share);
}

template <class Real>
void DirectJoints<Real>::book(const JointStep<Real>& step, Books& books, bool is_end) const {
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        if (!(system_.bodies[i].inverse_mass > 0)) continue;
        const auto row = static_cast<std::size_t>(rows_[i]);
        const Real* record = &step.records.velocity[4 * row];
        auto [x, y, rim] = step.records.start_of_substep(rows_[i]);
        if (is_end) x = before_[i].velocity.x, y = before_[i].velocity.y, rim = rim_[i] * before_[i].spin;
        const double mass = step.world.bodies.mass[row];
        const Vec2 mean = 0.5 * (Vec2{x, y} + Vec2{record[0], record[1]});
        books.joints += mass * dot(given_[i].velocity, mean) +
                        0.25 * mass * rim_[i] * given_[i].spin * (rim + static_cast<double>(record[2]));
        books.immovable_momentum += mass * given_[i].velocity;
    }
}

template <class Real>
double DirectJoints<Real>::work_of_drives(const JointStep<Real>& step) {
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        SystemBody& body = system_.bodies[i];
        const Real* now = &step.records.velocity[4 * static_cast<std::size_t>(rows_[i])];
        std::array<double, 3> before{now[0], now[1], now[2]};
        if (body.inverse_mass > 0) before = step.records.free_flight(rows_[i], step.terms);
        body.velocity = 0.5 * (Vec2{before[0], before[1]} + Vec2{now[0], now[1]});
        body.spin = 0.5 * (before[2] + static_cast<double>(now[2])) / rim_[i];
    }
    return system_.work_of_drives();
}

template <class Real>
void DirectJoints<Real>::store(JointStore& joints, double dt) const {
    for (std::size_t j = 0; j < slots_.size(); ++j) {
        StoredJoint& joint = joints[slots_[j]];
        const JointSystem::Member& member = system_.joints[j];
        joint.is_free = !touches_;
        joint.impulse = touches_ ? member.impulse : last_impulse_[j];
        joint.force = (1 / dt) * member.force, joint.torque = member.torque / dt;
        joint.held = j == 0 ? system_.held() : 0;
    }
}

template <class Real>
std::size_t DirectJoints<Real>::bytes() const {
    return system_.bytes() + (slots_.capacity() + asked_.capacity()) * sizeof(std::size_t) +
           rows_.capacity() * (sizeof(std::int32_t) + sizeof(double) + sizeof(Change) + sizeof(SystemBody));
}

template class DirectJoints<float>;
template class DirectJoints<double>;

}  // namespace carom
