#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

// Discs and their contacts as a textbook has them, in long double: centres, spins, moments of inertia, and
// impulses at the point of contact. What the kernels do with rim speeds and tables of masses is measured
// against this.

namespace carom::test {

struct Vector {
    long double x = 0, y = 0;
    friend Vector operator+(Vector p, Vector q) { return {p.x + q.x, p.y + q.y}; }
    friend Vector operator-(Vector p, Vector q) { return {p.x - q.x, p.y - q.y}; }
    friend Vector operator*(long double s, Vector p) { return {s * p.x, s * p.y}; }
};
inline long double dot(Vector p, Vector q) {
    return p.x * q.x + p.y * q.y;
}
inline long double cross(Vector p, Vector q) {
    return p.x * q.y - p.y * q.x;
}
inline Vector cross(long double spin, Vector arm) {
    return {-spin * arm.y, spin * arm.x};
}
/// A quarter turn counter-clockwise.
inline Vector turned(Vector p) {
    return {-p.y, p.x};
}

struct RigidDisc {
    long double inverse_mass = 0;     // 1/kg
    long double inverse_inertia = 0;  // 1/(kg m²)
    long double radius = 1;           // m
    Vector velocity;                  // m/s
    long double spin = 0;             // rad/s
    Vector moved;                     // m, since the start of the step

    static RigidDisc of_mass(long double mass, long double radius, bool turns = true) {
        return {1 / mass, turns ? 2 / (mass * radius * radius) : 0, radius, {}, 0, {}};
    }
    Vector velocity_at(Vector arm) const { return velocity + cross(spin, arm); }
    void apply(Vector impulse, Vector arm) {
        velocity = velocity + inverse_mass * impulse;
        spin += inverse_inertia * cross(arm, impulse);
    }
};

/// One contact of two discs; the impulses are those on b.
struct DiscContact {
    RigidDisc *a, *b;
    Vector normal;             // from a to b
    long double friction = 0;  // Coulomb coefficient
    long double rolling = 0;   // coefficient: moment over normal force and reduced radius
    long double floor = 0;     // m/s, least relative normal velocity
    long double along = 0;     // N s
    long double tangent = 0;   // N s
    long double roll = 0;      // N s, rolling moment over the reduced radius

    Vector arm_a() const { return a->radius * normal; }
    Vector arm_b() const { return -b->radius * normal; }
    /// Velocity of b's surface relative to a's [m/s].
    Vector surface_velocity() const { return b->velocity_at(arm_b()) - a->velocity_at(arm_a()); }
    long double normal_velocity() const { return dot(surface_velocity(), normal); }
    long double tangent_velocity() const { return dot(surface_velocity(), turned(normal)); }
    long double reduced_radius() const { return a->radius * b->radius / (a->radius + b->radius); }
    long double rolling_velocity() const { return reduced_radius() * (b->spin - a->spin); }

    /// What an impulse along the unit vector `e` changes the surface velocity along e by.
    long double inverse_mass_along(Vector e) const {
        const long double turn_a = cross(arm_a(), e), turn_b = cross(arm_b(), e);
        return a->inverse_mass + b->inverse_mass + a->inverse_inertia * turn_a * turn_a +
               b->inverse_inertia * turn_b * turn_b;
    }
    void apply(Vector impulse) {
        a->apply(-1 * impulse, arm_a());
        b->apply(impulse, arm_b());
    }
    void apply_rolling(long double impulse) {
        const long double moment = impulse * reduced_radius();
        a->spin -= a->inverse_inertia * moment;
        b->spin += b->inverse_inertia * moment;
    }
    /// Gives the discs what the contact carries.
    void apply_all() {
        apply(along * normal + tangent * turned(normal));
        apply_rolling(roll);
    }

    /// Signorini: goes `relaxation` of the way to where the contact alone would be satisfied.
    /// @return N s, what was added
    long double solve_normal(long double relaxation = 1) {
        const long double wanted = (floor - normal_velocity()) / inverse_mass_along(normal);
        const long double after = std::max(along + relaxation * wanted, 0.0L), added = after - along;
        apply(added * normal);
        along = after;
        return added;
    }
    long double solve_friction() {
        const Vector t = turned(normal);
        const long double limit = friction * along;
        const long double after =
            std::clamp(tangent - tangent_velocity() / inverse_mass_along(t), -limit, limit);
        const long double added = after - tangent;
        apply(added * t);
        tangent = after;
        return added;
    }
    long double solve_rolling() {
        const long double r = reduced_radius(), limit = rolling * along;
        const long double inverse = r * r * (a->inverse_inertia + b->inverse_inertia);
        const long double stopping = inverse > 0 ? rolling_velocity() / inverse : 0;
        const long double after = std::clamp(roll - stopping, -limit, limit), added = after - roll;
        apply_rolling(added);
        roll = after;
        return added;
    }

    /// How far the contact is from its laws [m/s]: 0 ≤ along ⟂ v_n - floor ≥ 0; the tangent sticks, or is at
    /// its limit against the motion; so does rolling.
    long double violation() const {
        const long double approach = floor - normal_velocity();
        long double worst = std::max(approach, -along * inverse_mass_along(normal));
        if (along > 0) worst = std::max(worst, std::fabs(approach));
        const auto of_limited = [&](long double impulse, long double limit, long double inverse,
                                    long double velocity) {
            if (inverse == 0) return;
            worst = std::max(worst, (std::fabs(impulse) - limit) * inverse);
            const bool may_push_more = impulse<limit, may_push_less = impulse> - limit;
            const long double room_up = (limit - impulse) * inverse, room_down = (limit + impulse) * inverse;
            if (velocity < 0 && may_push_more) worst = std::max(worst, std::min(-velocity, room_up));
            if (velocity > 0 && may_push_less) worst = std::max(worst, std::min(velocity, room_down));
        };
        const long double r = reduced_radius();
        of_limited(tangent, friction * along, inverse_mass_along(turned(normal)), tangent_velocity());
        of_limited(roll, rolling * along, r * r * (a->inverse_inertia + b->inverse_inertia),
                   rolling_velocity());
        return worst;
    }
};

}  // namespace carom::test
