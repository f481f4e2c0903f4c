// What nothing moves, as the contacts of solver `soft` see it: walls, static and kinematic bodies.
#include "solver/soft.hpp"

#include <cmath>

#include "effects/friction.hpp"
#include "effects/rolling_resistance.hpp"
#include "math/vec2_math.hpp"
#include "solver/flights.hpp"

namespace carom {
namespace {

/// Where a body and its support touch.
struct Surface {
    Vec2 normal;        // from the body into the support
    double separation;  // m
    Vec2 velocity;      // m/s, of the surface
    double friction, rolling;
    double rolling_share;     // of the body's rim speed in the rolling velocity
    double rolling_velocity;  // m/s, the support's share of it
};

template <class Real>
Surface surface_of(const WorldState<Real>& world, std::size_t row, std::int32_t support) {
    const Bodies<Real>& bodies = world.bodies;
    const Vec2 x{bodies.position_x[row], bodies.position_y[row]};
    const double radius = bodies.radius[row];
    if (support < 0) {
        const Walls& walls = *world.walls;
        const Vec2 n = Flights<Real>::wall_normal(support);
        const Vec2 corner = support == kLeft || support == kBottom ? walls.min : walls.max;
        return {
            n, dot(corner - x, n) - radius, {}, walls.material.friction, walls.material.rolling_resistance, 1,
            0};
    }
    const auto other = static_cast<std::size_t>(support);
    const Vec2 d = Vec2{bodies.position_x[other], bodies.position_y[other]} - x;
    const double distance = std::sqrt(length_squared(d));
    const Vec2 n = distance > 0 ? (1 / distance) * d : Vec2{0, -1};
    const double support_radius = bodies.radius[other];
    Vec2 velocity{bodies.velocity_x[other], bodies.velocity_y[other]};
    const double rim = bodies.has_rotation ? bodies.angular_velocity[other] * support_radius : 0;
    if (bodies.has_rotation) velocity += rim * Vec2{n.y, -n.x};  // spin times the arm -r n
    const double share = rolling_share(radius, support_radius);
    return {n,
            distance - radius - support_radius,
            velocity,
            bodies.friction[other],
            bodies.rolling_resistance[other],
            share,
            (1 - share) * rim};
}

}  // namespace

template <class Real>
void SoftSolver<Real>::find_supports(const WorldState<Real>& world) {
    ContactCandidates<Real>& candidates = graph.supports;
    const Bodies<Real>& bodies = world.bodies;
    supports_.resize(candidates, is_rough_, bounces_);
    supports_.resize_rolling(supports_.a.size(), true, rolls_, true, true);
    const auto real = [](double value) { return static_cast<Real>(value); };
    for (std::size_t group = 0, place = 0, c = 0; c < candidates.colours(); ++c) {
        while (c >= candidates.first_colour[group + 1]) ++group;
        std::size_t at = place;
        for (std::size_t i = candidates.begin[c]; i < candidates.begin[c] + candidates.count[c]; ++i) {
            const auto row = static_cast<std::size_t>(candidates.a[i]);
            const Surface s = surface_of(world, row, candidates.b[i]);
            const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]};
            const Vec2 dv = s.velocity - v;
            const double fall = length_squared(gain_) > 0 ? std::sqrt(length_squared(gain_)) * dt_ / h_ : 0;
            // A wall is a wall everywhere, so it is kept however slowly a body nears it: in a crowd another
            // one may yet throw it there within this step. What is round only holds where it is met.
            const bool is_wall = candidates.b[i] < 0;
            if (!is_wall && s.separation > near_ + dt_ * (std::fabs(dv.x) + std::fabs(dv.y) + fall)) {
                candidates.normal_impulse[i] = 0;
                continue;
            }
            supports_.a[at] = candidates.a[i];
            supports_.normal_x[at] = real(s.normal.x), supports_.normal_y[at] = real(s.normal.y);
            supports_.separation[at] = real(s.separation);
            supports_.mass[at] = real(1 / bodies.inverse_mass(row));
            supports_.normal_impulse[at] = candidates.normal_impulse[i];
            supports_.surface_normal[at] = real(dot(s.velocity, s.normal));
            supports_.surface_tangent[at] = real(cross(s.normal, s.velocity));
            if (is_rough_) {
                supports_.friction_impulse[at] = candidates.friction_impulse[i];
                supports_.friction[at] = real(pair_friction(bodies.friction[row], s.friction));
            }
            if (rolls_) {
                supports_.rolling_impulse[at] = candidates.rolling_impulse[i];
                supports_.rolling[at] =
                    real(pair_rolling_resistance(bodies.rolling_resistance[row], s.rolling));
                supports_.rolling_share[at] = real(s.rolling_share);
                supports_.surface_rolling[at] = real(s.rolling_velocity);
            }
            if (bounces_) supports_.approach[at] = real(dot(dv, s.normal));
            supports_.candidate[at] = static_cast<std::int32_t>(i);
            ++at;
        }
        place = supports_.close_colour(c, place, at - place, padding_row_of_supports(group));
    }
}

template void SoftSolver<float>::find_supports(const WorldState<float>&);
template void SoftSolver<double>::find_supports(const WorldState<double>&);

}  // namespace carom
