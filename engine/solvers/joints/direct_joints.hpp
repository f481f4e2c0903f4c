#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "constraints/joints/joint_system.hpp"
#include "solvers/joints/joint_step.hpp"

namespace carom {

/// An impulse of a contact on a body that joints hold.
struct JointBlow {
    std::int32_t row;
    Vec2 impulse;   // N s
    double at_rim;  // N s, what its rim is given: effects/contact_law.hpp
};

/// A group of bodies and joints that is solved exactly: a system in double precision between the records of
/// the bodies before and after.
template <class Real>
class DirectJoints {
  public:
    /// @param slots  of its joints  @param rows  of bodies, by the slot of their handle
    DirectJoints(const WorldState<Real>& world, const std::vector<std::size_t>& slots);

    std::size_t joints() const { return slots_.size(); }
    std::size_t loops() const { return system_.loop_count(); }
    bool is_small_enough() const { return system_.is_small_enough(); }
    /// About what a solve takes: joints, as often as there are motors and limits, and once more.
    std::size_t work() const { return joints() * (1 + system_.drive_rows()); }
    const std::vector<std::int32_t>& rows() const { return rows_; }
    const std::vector<std::size_t>& slots() const { return slots_; }

    /// @param touches  whether one of its bodies can touch something in this step
    /// @param is_beside  whether it is solved in turns with joints that are swept
    /// @param converges  whether Newton's method goes on to round-off
    void begin_step(const JointStep<Real>& step, bool touches, bool is_beside, bool converges);
    /// Velocities of a substep, before contacts are solved.
    void solve_first(const JointStep<Real>& step, int substep);
    /// What contacts have changed since; nothing where they have changed nothing in a tree.
    void solve_again(const JointStep<Real>& step);
    /// Velocities of the substep once more, from those without what its joints have given so far.
    void solve_anew(const JointStep<Real>& step);
    /// By which solve_again changed the velocity of a centre or a rim, at most [m/s].
    double largest_change() const { return largest_change_; }
    bool touches() const { return touches_; }
    /// At the end of a step: nothing that it could touch presses on it.
    void leave() { touches_ = false; }
    /// The end of a step: velocities at whole times. Nothing where bodies touch others.
    void end_step(const JointStep<Real>& step);
    /// Adds what its joints gave since the last solve_first or end_step to their forces.
    void note_forces() { system_.note_forces(); }
    /// What a blow on one of its bodies changes the velocity records of all by, at once, while joints hold.
    /// @param fn  called for each body that can move: its row, what is added to vx, vy and rim speed [m/s]
    template <class Fn>
    void answer(const JointBlow& blow, JointSystem::Drives drives, const Fn& fn) {
        blows_.assign(1, blow_of(blow));
        system_.answer(blows_, drives);
        for (std::size_t i = 1; i < rows_.size(); ++i) {
            const SystemBody& body = system_.bodies[i];
            if (!(body.inverse_mass > 0)) continue;
            const JointSystem::Vector& by = system_.answer_of(i);
            fn(rows_[i], std::array<double, 3>{by[0], by[1], body.inverse_inertia > 0 ? rim_[i] * by[2] : 0});
        }
    }
    /// What unit impulses on bodies, by their rows, and of all motors change these by while joints hold and
    /// motors give what they are told to: JointSystem::find_answers.
    void find_answers(std::span<const std::int32_t> rows);
    /// Whether these are still the answers: no limit has begun to hold or let go since.
    bool answers_hold() const { return system_.answers_hold(); }
    /// m/s, m/s, rad/s: of one of these bodies, by its place among them.
    JointSystem::Vector answer_to(std::size_t side, std::size_t place) const {
        return system_.answer_to(side, asked_[place]);
    }
    double answer_to(std::size_t side, const JointSystem::Motor& motor) const {
        return system_.answer_to(side, motor);
    }
    /// What an impulse gives its body [N s, N s, N m s].
    JointSystem::Vector push_of(const JointBlow& blow) const { return blow_of(blow).impulse; }
    /// Its motors, with what they lack as velocities are now.
    const std::vector<JointSystem::Motor>& motors(const JointStep<Real>& step) {
        read_velocities(step);
        system_.list_motors(motors_);
        return motors_;
    }
    /// As they were when that was last asked for.
    const std::vector<JointSystem::Motor>& motors() const { return motors_; }
    /// Adds what its joints gave in answer to the last blow to their forces.
    void note_answer() { system_.note_answer(); }
    /// Gives bodies impulses of contacts, and of its motors, and all of them what joints give in answer.
    /// @param of_motors  N s, as motors()
    void take_blows(const JointStep<Real>& step, std::span<const JointBlow> blows,
                    std::span<const double> of_motors);
    std::size_t motor_count() const { return motor_count_; }
    double mass() const { return mass_; }          ///< kg, of its bodies together
    double heaviest() const { return heaviest_; }  ///< kg, of one of them
    /// What presses on its bodies in the next solve_first, which moves none of them into it.
    std::vector<JointSystem::Load>& loads() { return system_.loads; }
    /// A load whose pushes are along an impulse on a body of the group.
    JointSystem::Load load_on(const JointBlow& unit) const {
        const JointSystem::Blow push = blow_of(unit);
        JointSystem::Load load;
        load.body = static_cast<std::int32_t>(push.body), load.along = push.impulse;
        return load;
    }
    /// Whether a motor, a spring, a limit or a body that moves by itself may give its bodies energy.
    bool may_drive() const { return may_drive_ || limits_move_; }
    /// The work of these in this substep [J].
    double work_of_drives(const JointStep<Real>& step);
    /// A row of it that can move.
    std::int32_t moving_row() const { return moving_row_; }
    /// Multiplies the impulses that its joints gave in this substep; velocities stay as they are.
    void scale(double share) {
        if (share == 1) return;
        system_.scale(share);
        for (Change& given : given_) given.velocity = share * given.velocity, given.spin *= share;
    }
    /// The work of its joints in this substep, or at the end of the step, and what they gave to what nothing
    /// moves.
    void book(const JointStep<Real>& step, Books& books, bool is_end) const;
    /// What the store keeps of a step.
    void store(JointStore& joints, double dt) const;

    std::size_t bytes() const;

  private:
    void read_poses(const JointStep<Real>& step);
    void write_poses(const JointStep<Real>& step);
    void write_velocities(const JointStep<Real>& step);
    void correct(const JointStep<Real>& step);
    void half_kick(const JointStep<Real>& step, double sign);
    void read_velocities(const JointStep<Real>& step);
    void bound_end(const JointStep<Real>& step);
    bool has_changed(const JointStep<Real>& step) const;
    std::size_t number_of(std::int32_t row) const {
        return static_cast<std::size_t>(std::find(rows_.begin(), rows_.end(), row) - rows_.begin());
    }
    JointSystem::Blow blow_of(const JointBlow& blow) const {
        const std::size_t body = number_of(blow.row);
        return {body, {blow.impulse.x, blow.impulse.y, rim_[body] * blow.at_rim}};
    }

    struct Change {
        Vec2 velocity;    // m/s
        double spin = 0;  // rad/s
    };

    JointSystem system_;
    std::vector<std::size_t> slots_;
    std::vector<std::int32_t> rows_;  // by body of the system; -1: the world
    std::vector<double> rim_;         // m, likewise
    std::int32_t moving_row_ = 0;
    std::vector<Change> given_;  // by body: what its joints gave it in this substep
    double largest_change_ = 0;
    std::vector<SystemBody> before_;                   // that were read
    std::vector<SystemBody> at_end_;                   // of a step, where its joints gave too much
    std::vector<std::array<double, 3>> last_impulse_;  // N s, by joint: of the last substep of a step
    std::vector<JointSystem::Blow> blows_;
    std::vector<std::size_t> asked_;
    std::vector<JointSystem::Motor> motors_;
    std::size_t motor_count_ = 0;
    double mass_ = 0, heaviest_ = 0;          // kg
    double least_error_ = 0, length_ = 0;     // m
    bool touches_ = false, was_free_ = true;  // in this step; in the last one
    bool is_beside_ = false, converges_ = false, may_drive_ = false, limits_move_ = false;
};

/// What an impulse changes the velocity of a body by that no joint holds: vx, vy, rim speed [m/s].
/// @param velocity  records
template <class Real>
std::array<double, 3> change_of_free(const Column<Real>& velocity, const JointBlow& blow) {
    const auto inverse = static_cast<double>(velocity[4 * static_cast<std::size_t>(blow.row) + 3]);
    const double w = std::fabs(inverse);
    return {w * blow.impulse.x, w * blow.impulse.y, 2 * std::fmax(inverse, 0) * blow.at_rim};
}

extern template class DirectJoints<float>;
extern template class DirectJoints<double>;

}  // namespace carom
