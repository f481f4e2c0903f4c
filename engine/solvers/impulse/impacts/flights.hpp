#pragma once

#include <carom/scene.hpp>

#include <cmath>
#include <cstdint>
#include <span>

#include "effects/flight.hpp"
#include "effects/friction.hpp"
#include "effects/restitution.hpp"
#include "effects/touching.hpp"
#include "narrowphase/coincident.hpp"
#include "parallel/interruption.hpp"
#include "shapes/walls.hpp"
#include "state/bodies.hpp"
#include "state/books.hpp"

// The flights of all bodies during one substep, and the meetings of two of them or of one with a wall. All
// arithmetic here is in double precision; only the store is Real.

namespace carom {

/// Two bodies, or a body and a wall, that may touch.
struct Meeting {
    std::int32_t a;  ///< body row
    std::int32_t b;  ///< body row, or a WallSide

    bool with_wall() const { return b < 0; }
    friend bool operator==(Meeting, Meeting) = default;
};

/// A meeting seen at one instant.
struct Encounter {
    Vec2 normal;             ///< from A to B, or from A into the wall
    double separation;       ///< m
    double normal_velocity;  ///< m/s, of B relative to A; negative = approaching

    /// The normal turned by 90° counter-clockwise, along which friction acts.
    Vec2 tangent() const { return {-normal.y, normal.x}; }
};

/// A body as the contact law wants it (effects/contact_law.hpp), in plain numbers.
struct ContactRecord {
    double velocity_x, velocity_y;  ///< m/s
    double rim_speed;               ///< m/s
    double inverse_mass;            ///< 1/kg, zero for what nothing moves, negative for a fixed angle
};

/// Impulses on B of a meeting [N s].
struct ImpactImpulses {
    double normal, tangent;
};

/// What flights are kept in.
template <class Real>
struct FlightColumns {
    Column<Real> motion;         // [padded(rows)][4], m and m/s
    Column<Vec2> accelerations;  // m/s², only if bodies' accelerations can differ

    std::size_t bytes() const { return motion.bytes() + accelerations.bytes(); }
};

/// A view: several may be of the same columns, each with books of its own.
template <class Real>
class Flights {
  public:
    /// One body's packed record (x0, y0, vx0, vy0): one load a body in the kernels.
    static constexpr std::size_t kMotionWidth = 4;

    std::span<Real> motion;         // of FlightColumns
    std::span<Vec2> accelerations;  // of FlightColumns
    Vec2 common_acceleration;       // m/s²
    FlightClock end;                // the clock at the end of the substep
    double rest_speed = 0;          // m/s, approaches slower than this do not bounce
    bool has_friction = false;      // impacts turn bodies: their angles and spins are read and written
    double angular_drag = 0;        // 1/s, only with friction
    const Walls* walls = nullptr;
    Bodies<Real>* bodies = nullptr;
    Books* books = nullptr;
    Interruption* interruption = nullptr;  // of the step; null: none can be

    /// To be called when the columns have got other rows, or have come or gone.
    void look_at(FlightColumns<Real>& columns) {
        motion = {columns.motion.data(), columns.motion.size()};
        accelerations = {columns.accelerations.data(), columns.accelerations.size()};
    }

    /// Whether the step is to end here, after so much more work. Loops that may be long ask.
    bool is_interrupted_after(std::size_t work) const {
        return interruption && interruption->is_due_after(work);
    }

    double drag() const { return end.drag; }

    Vec2 acceleration(std::int32_t row) const {
        return accelerations.empty() ? common_acceleration : accelerations[static_cast<std::size_t>(row)];
    }

    Flight flight(std::int32_t row) const {
        const Real* m = &motion[static_cast<std::size_t>(row) * kMotionWidth];
        return {{m[0], m[1]}, {m[2], m[3]}, acceleration(row)};
    }

    void store(std::int32_t row, const Flight& f) {
        Real* m = &motion[static_cast<std::size_t>(row) * kMotionWidth];
        m[0] = static_cast<Real>(f.position.x), m[1] = static_cast<Real>(f.position.y);
        m[2] = static_cast<Real>(f.velocity.x), m[3] = static_cast<Real>(f.velocity.y);
    }

    double radius(std::int32_t row) const { return bodies->radius[static_cast<std::size_t>(row)]; }
    double inverse_mass(std::int32_t row) const {
        return bodies->inverse_mass(static_cast<std::size_t>(row));
    }
    bool is_immovable(std::int32_t row) const { return bodies->is_immovable(static_cast<std::size_t>(row)); }

    /// Distance between the centres, or between centre and wall, at which a meeting touches [m].
    double reach(Meeting m) const { return m.with_wall() ? radius(m.a) : radius(m.a) + radius(m.b); }

    /// The smaller body's radius: what tolerances are fractions of [m].
    double smaller_radius(Meeting m) const {
        return m.with_wall() ? radius(m.a) : std::fmin(radius(m.a), radius(m.b));
    }

    double restitution(Meeting m) const {
        const double a = bodies->restitution[static_cast<std::size_t>(m.a)];
        return pair_restitution(a, m.with_wall() ? walls->material.restitution
                                                 : bodies->restitution[static_cast<std::size_t>(m.b)]);
    }

    double friction(Meeting m) const {
        const double a = bodies->friction[static_cast<std::size_t>(m.a)];
        return pair_friction(
            a, m.with_wall() ? walls->material.friction : bodies->friction[static_cast<std::size_t>(m.b)]);
    }

    double inverse_mass_sum(Meeting m) const {
        return inverse_mass(m.a) + (m.with_wall() ? 0 : inverse_mass(m.b));
    }

    /// Separation, normal and velocities of a meeting at clock s.
    Encounter encounter(Meeting m, double s) const {
        const double q = flight_q(s, drag());
        const Flight fa = flight(m.a);
        const Vec2 xa = position_at(fa, s, q), va = velocity_at(fa, s, drag());
        if (m.with_wall()) {
            const Vec2 n = wall_normal(m.b);
            return {n, wall_clearance(*walls, m.b, xa) - radius(m.a), -dot(va, n)};
        }
        const Flight fb = flight(m.b);
        const Vec2 d = position_at(fb, s, q) - xa;
        const double distance = std::sqrt(length_squared(d));
        const Vec2 n = distance > 1e-12 * reach(m) ? (1 / distance) * d : direction_of_coincident(m);
        return {n, distance - reach(m), dot(velocity_at(fb, s, drag()) - va, n)};
    }

    /// A body at clock s. Only with friction.
    ContactRecord record(std::int32_t row, double s) const {
        const Vec2 v = velocity_at(flight(row), s, drag());
        return {v.x, v.y, rim_speed(row, s), record_at_rest(row).inverse_mass};
    }
    /// The same without motion: for what impulses add up to.
    ContactRecord record_at_rest(std::int32_t row) const {
        const bool turns = (bodies->flags_of(static_cast<std::size_t>(row)) & kFixedAngle) == 0;
        const double w = inverse_mass(row);
        return {0, 0, 0, turns ? w : -w};
    }

    /// Whether surfaces touch so gently at clock s that this is rest, not an impact.
    bool rests(Meeting m, double s) const {
        if (!(rest_speed > 0)) return false;
        const Encounter e = encounter(m, s);
        return e.separation <= kTouchFraction * smaller_radius(m) && e.normal_velocity > -rest_speed;
    }

    /// Applies impulse j [N s] along the encounter's normal at clock s; both bodies fly on from there.
    void apply_impulse(Meeting m, const Encounter& e, double j, double s) {
        push(m.a, -j * inverse_mass(m.a) * e.normal, s);
        if (!m.with_wall()) push(m.b, j * inverse_mass(m.b) * e.normal, s);
        book_outside(m, e, {j, 0}, s);
    }

    /// Adds to a body's velocity and rim speed at clock s; it flies on from there.
    void deflect(std::int32_t row, const ContactRecord& change, double s) {
        push(row, {change.velocity_x, change.velocity_y}, s);
        if (change.rim_speed != 0) turn(row, change.rim_speed / radius(row), s);
    }

    /// Books what walls and immovable bodies give in a meeting.
    void book_outside(Meeting m, const Encounter& e, const ImpactImpulses& j, double s) {
        if (m.with_wall()) {
            books->add_wall_impulse(-j.normal * e.normal);
            if (j.tangent != 0) books->wall_momentum -= j.tangent * e.tangent();
        } else if (books->is_open) {
            book_immovable(m, e, j, s);
        }
    }

    /// Work that the contacts a body rests on do on it from the start of flight f to clock s [J]. Two bodies
    /// at rest on each other get opposite amounts; what is left over is the error of the contact forces.
    double support_work(std::int32_t row, const Flight& f, double s, double q) const {
        return dot(f.acceleration - common_acceleration, position_at(f, s, q) - f.position) /
               inverse_mass(row);
    }

    bool has_wall(std::int32_t side) const { return walls && carom::has_wall(*walls, side); }

  private:
    /// Changes a body's velocity at clock s by dv, and keeps what drag takes on the way in the books.
    void push(std::int32_t row, Vec2 dv, double s) {
        if (is_immovable(row)) return;
        const Flight before = flight(row);
        Flight after = before;
        const double q = flight_q(s, drag());
        const Vec2 support = before.acceleration - common_acceleration;
        const double lift = dot(dv, support);  // outward, times the support's magnitude
        if (lift > 0 && lift * lift > rest_speed * rest_speed * length_squared(support)) {
            // A held body that is hit off its support flies freely for the rest of the substep.
            accelerations[static_cast<std::size_t>(row)] = common_acceleration;
            const double unused = end.t - (s + drag() * q);  // t = s + k q
            books->wall_momentum -= (unused / inverse_mass(row)) * support;
            after = flight_through(position_at(before, s, q), velocity_at(before, s, drag()) + dv,
                                   common_acceleration, s, q, drag());
        } else {
            const Vec2 dv0 = (1 / (1 - drag() * s)) * dv;
            after.velocity += dv0;
            after.position -= s * dv0;
        }
        store(row, after);
        if (!books->is_open) return;
        if (support != Vec2{})
            books->restitution += support_work(row, before, s, q) - support_work(row, flight(row), s, q);
        if (drag() != 0) book_drag(row, before, s, q);
    }

    /// Time and angular drag's clock at clock s of the flight.
    FlightClock spin_clock(double s) const {
        return flight_clock_at(drag() == 0 ? s : s + drag() * flight_q(s, drag()), angular_drag);
    }

    /// Speed of a body's rim by its spin at clock s [m/s].
    double rim_speed(std::int32_t row, double s) const {
        const double spin = bodies->angular_velocity[static_cast<std::size_t>(row)];
        const bool slows = angular_drag != 0 && !is_immovable(row);
        return radius(row) * (slows ? spin_clock(s).u * spin : spin);
    }

    /// Changes a body's spin at clock s by `change` [rad/s]. The columns take the angle and the spin at the
    /// start of the substep with which the body would be as it is from now on, so that its end comes out
    /// right: as push does it for position and velocity.
    void turn(std::int32_t row, double change, double s) {
        Real& angle = bodies->angle[static_cast<std::size_t>(row)];
        Real& spin = bodies->angular_velocity[static_cast<std::size_t>(row)];
        const FlightClock clock = spin_clock(s);
        const double before = spin, change_at_start = change / clock.u;
        spin = static_cast<Real>(before + change_at_start);
        angle = static_cast<Real>(angle - clock.s * change_at_start);
        if (angular_drag == 0 || !books->is_open) return;
        // The end of the substep books angular drag for the spin as it ends, as with book_drag.
        const double after = spin;
        const double inertia = 0.5 * radius(row) * radius(row) / inverse_mass(row);
        books->drag -= (1 - clock.u * clock.u) * 0.5 * inertia * (before * before - after * after);
    }

    /// The end of the substep books drag for the flight as it ends; here the part flown before is set right.
    void book_drag(std::int32_t row, const Flight& before, double s, double q) {
        const Flight after = flight(row);
        const double mass = 1 / inverse_mass(row);
        books->drag -=
            mass * (drag_loss_per_mass(before, s, q, drag()) - drag_loss_per_mass(after, s, q, drag()));
        const Vec2 way =
            position_at(before, s, q) - before.position - (position_at(after, s, q) - after.position);
        books->drag_momentum -= mass * drag() * way;
    }

    /// Impulses act on B, their opposites on A; if one of them is immovable the other's momentum came from
    /// outside, and the work of its surface's motion on it too.
    void book_immovable(Meeting m, const Encounter& e, const ImpactImpulses& j, double s) {
        const bool a = is_immovable(m.a), b = is_immovable(m.b);
        if (a == b) return;
        const double sign = a ? 1 : -1;
        Vec2 on_movable = sign * j.normal * e.normal;
        if (j.tangent != 0) on_movable += sign * j.tangent * e.tangent();
        books->immovable_momentum += on_movable;
        const std::int32_t row = a ? m.a : m.b;
        books->drive += dot(on_movable, velocity_at(flight(row), s, drag()));
        // Its rim moves along the tangent if it is A, against it if it is B, and so acts j on the other.
        if (j.tangent != 0) books->drive += j.tangent * rim_speed(row, s);
    }

    Vec2 direction_of_coincident(Meeting m) const {
        return normal_of_coincident(bodies->id[static_cast<std::size_t>(m.a)].index,
                                    bodies->id[static_cast<std::size_t>(m.b)].index);
    }
};

}  // namespace carom
