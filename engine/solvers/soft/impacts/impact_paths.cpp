#include "solvers/soft/impacts/impact_paths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {

template <class Real>
void ImpactPaths<Real>::begin_substep(const WorldState<Real>& world, const SubstepBodies<Real>& bodies,
                                      const Real* joined, Vec2 gravity) {
    world_ = &world, bodies_ = &bodies, joined_ = joined, gravity_ = gravity;
    ++substep_;
    movers_.resize(std::max(movers_.size(), bodies.count));
}

/// How contacts and free flight change the velocity of a body in this substep, and free flight alone [m/s].
template <class Real>
VelocityChange<Real> ImpactPaths<Real>::change_of(std::size_t row) const {
    const Real* record = bodies_->velocity + 4 * row;
    const Real start_x = bodies_->start.x[row], start_y = bodies_->start.y[row];
    return {record[0] - start_x, record[1] - start_y, bodies_->decay * start_x + bodies_->gain_x - start_x,
            bodies_->decay * start_y + bodies_->gain_y - start_y};
}

/// By which kernels/contacts/advance_bodies.hpp will move a body that is awake.
template <class Real>
Mover ImpactPaths<Real>::path_of(std::size_t row) const {
    const Real* record = bodies_->velocity + 4 * row;
    const Vec2 x = Vec2{bodies_->origin[4 * row], bodies_->origin[4 * row + 1]} +
                   Vec2{bodies_->displacement[2 * row], bodies_->displacement[2 * row + 1]};
    const Mover straight{x, {record[0], record[1]}, {}, world_->bodies.radius[row], 0, substep_};
    if (record[3] == 0 || is_joined(row)) return straight;
    const VelocityChange<Real> change = change_of(row);
    if (!change.is_smooth()) return straight;
    Mover curved = straight;
    const Real start_x = bodies_->start.x[row], start_y = bodies_->start.y[row];
    curved.v = {start_x, start_y};
    // Bodies that fall alike meet on straight lines: they have the same bits of acceleration.
    const Real off = std::fabs(change.x - change.fall_x) + std::fabs(change.y - change.fall_y),
               speed = std::fabs(start_x) + std::fabs(start_y);
    const bool falls = bodies_->decay == 1 && off <= Real(8) * std::numeric_limits<Real>::epsilon() * speed;
    curved.acceleration = falls ? gravity_ : (1 / bodies_->h) * Vec2{change.x, change.y};
    return curved;
}

template <class Real>
const Mover& ImpactPaths<Real>::of(std::int32_t number) {
    const auto row = static_cast<std::size_t>(number);
    Mover& mover = movers_[row];
    if (mover.substep != substep_) {
        const std::uint32_t impacts = mover.impacts;
        mover = path_of(row), mover.impacts = impacts;
    }
    return mover;
}

template <class Real>
Mover ImpactPaths<Real>::of_any(std::int32_t number) {
    const auto row = static_cast<std::size_t>(number);
    if (row < bodies_->count) return of(number);
    const Bodies<Real>& bodies = world_->bodies;
    return {{bodies.position_x[row], bodies.position_y[row]}, {}, {}, bodies.radius[row], 0, substep_};
}

template <class Real>
Vec2 ImpactPaths<Real>::displacement_of(std::int32_t number, double time) {
    const auto row = static_cast<std::size_t>(number);
    return of(number).position_at(time) - Vec2{bodies_->origin[4 * row], bodies_->origin[4 * row + 1]};
}

template <class Real>
std::array<double, 4> ImpactPaths<Real>::record_of(std::int32_t number, const Mover& mover,
                                                   double time) const {
    const auto row = static_cast<std::size_t>(number);
    if (row >= bodies_->count) return {};
    const Real* record = bodies_->velocity + 4 * row;
    Vec2 v = mover.velocity_at(time);
    if (is_joined(row))
        v += (time - 0.5 * bodies_->h) * gravity_;
    else if (goes_straight(row))
        v += (time - bodies_->h) * gravity_;
    return {v.x, v.y, static_cast<double>(record[2]), static_cast<double>(record[3])};
}

template <class Real>
double ImpactPaths<Real>::change(std::int32_t number, const std::array<double, 3>& by, double time) {
    const auto row = static_cast<std::size_t>(number);
    if (row >= bodies_->count || bodies_->velocity[4 * row + 3] == 0) return 0;
    Vec2 acceleration = of(number).acceleration;
    double until = bodies_->h;
    if (is_joined(row))
        acceleration = gravity_, until *= 0.5;
    else if (goes_straight(row))
        acceleration = gravity_;
    const auto add = [](Real& velocity, Real* start, Real& moved, double added, Real decay, double at) {
        const Real old = velocity;
        velocity = static_cast<Real>(static_cast<double>(old) + added);
        const Real really = velocity - old;
        // What contacts did in this substep they will do again in the next one; this not.
        *start = decay == Real(1) ? velocity - (old - *start) : *start + really / decay;
        moved -= static_cast<Real>(at * static_cast<double>(really));
        return static_cast<double>(really);
    };
    Real* record = bodies_->velocity + 4 * row;
    const Vec2 added{
        add(record[0], bodies_->start.x + row, bodies_->displacement[2 * row], by[0], bodies_->decay, time),
        add(record[1], bodies_->start.y + row, bodies_->displacement[2 * row + 1], by[1], bodies_->decay,
            time)};
    if (bodies_->turn && by[2] != 0)
        add(record[2], bodies_->start.rim + row, bodies_->turn[row], by[2], bodies_->spin_decay, time);
    movers_[row].substep = 0;  // it moves otherwise from now on
    ++movers_[row].impacts;
    return static_cast<double>(world_->bodies.mass[row]) * dot(acceleration, added) * (until - time);
}

template class ImpactPaths<float>;
template class ImpactPaths<double>;

}  // namespace carom
