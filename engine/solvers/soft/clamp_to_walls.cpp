#include "math/rotation.hpp"
#include "shapes/convex_geometry.hpp"
#include "shapes/walls.hpp"
#include "solvers/soft/stages.hpp"

namespace carom {
namespace {

/// How far a body reaches in a direction [m].
template <class Real>
Real reach_along(const WorldState<Real>& world, std::size_t row, Vec2 direction) {
    const Bodies<Real>& bodies = world.bodies;
    if (bodies.is_disc(row)) return bodies.radius[row];
    const Rotation turn = bodies.has_rotation ? rotation_by(bodies.angle[row]) : Rotation{};
    return static_cast<Real>(world.shapes.reach_along(bodies.shape[row], turn, direction));
}

/// Puts one coordinate back to where the body touches the wall, and stops what drives it out.
/// @param reach  reach(side), how far the body reaches to the side of -1 or 1 along this coordinate [m]
/// @return the velocity that was taken [m/s]
template <class Real, class Reach>
Real put_back(Real& position, Real& velocity, Real min, Real max, const Reach& reach) {
    const bool is_below = position < min;
    if (!is_below && !(position > max)) return 0;
    position = is_below ? min + reach(-1) : max - reach(1);
    if (is_below ? velocity >= 0 : velocity <= 0) return 0;
    const Real taken = velocity;
    velocity = 0;
    return taken;
}

}  // namespace

/// Contacts with walls are those of the bodies that can come there by themselves. One that another body
/// throws at a wall within a step may have none: then this is its contact. It looks at centres, so it acts
/// on no body whose contact held.
template <class Real>
void clamp_to_walls(SoftSimulation<Real>& sim) {
    WorldState<Real>& world = sim.world;
    Bodies<Real>& bodies = world.bodies;
    const Enclosure<Real> box(&*world.walls);
    constexpr std::size_t kBlock = 256;  // rows that are asked together
    const std::size_t rows = bodies.moving();
    for (std::size_t first = 0; first < rows; first += kBlock) {
        const std::size_t last = first + kBlock < rows ? first + kBlock : rows;
        const Real *x = bodies.position_x.data(), *y = bodies.position_y.data();
        int outside = 0;
        for (std::size_t row = first; row < last; ++row) outside |= box.is_outside(x[row], y[row]) ? 1 : 0;
        if (outside == 0) continue;
        for (std::size_t row = first; row < last; ++row) {
            if (!box.is_outside(x[row], y[row]) || bodies.is_immovable(row)) continue;
            if (bodies.flags_of(row) & kSensor) continue;
            const Real* start = &sim.motion[4 * row];
            if (box.is_outside(start[0], start[1])) continue;  // it was put there
            const auto along_x = [&](double side) { return reach_along(world, row, {side, 0}); };
            const auto along_y = [&](double side) { return reach_along(world, row, {0, side}); };
            const Vec2 taken{
                put_back(bodies.position_x[row], bodies.velocity_x[row], box.min_x, box.max_x, along_x),
                put_back(bodies.position_y[row], bodies.velocity_y[row], box.min_y, box.max_y, along_y)};
            const double mass = bodies.mass[row];
            world.books.add_wall_impulse({-mass * taken.x, 0});
            world.books.add_wall_impulse({0, -mass * taken.y});
            if (world.books.is_open) world.books.restitution -= 0.5 * mass * length_squared(taken);
        }
    }
}

template void clamp_to_walls(SoftSimulation<float>&);
template void clamp_to_walls(SoftSimulation<double>&);

}  // namespace carom
