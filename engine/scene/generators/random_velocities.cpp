#include "scene/generators/random_velocities.hpp"

#include "shapes/mass.hpp"

#include <cmath>
#include <vector>

namespace carom {
namespace {

/// Takes the same velocity from all, so that the momentum vanishes.
void take_mean(std::span<const Body> bodies, std::vector<Vec2>& velocity) {
    double mass = 0, momentum_x = 0, momentum_y = 0;
    for (std::size_t i = 0; i < velocity.size(); ++i) {
        const double m = mass_of(bodies[i]);
        mass += m;
        momentum_x += m * velocity[i].x;
        momentum_y += m * velocity[i].y;
    }
    const Vec2 mean{momentum_x / mass, momentum_y / mass};
    for (Vec2& v : velocity) v = {v.x - mean.x, v.y - mean.y};
}

}  // namespace

void add_random_velocities(std::span<Body> bodies, double rms, Random& random) {
    std::vector<Vec2> velocity(bodies.size());
    for (Vec2& v : velocity) {
        v.x = random.normal();
        v.y = random.normal();
    }
    take_mean(bodies, velocity);
    take_mean(bodies, velocity);  // of what rounding left
    double squares = 0;
    for (const Vec2 v : velocity) squares += v.x * v.x + v.y * v.y;
    const double scale = rms / std::sqrt(squares / static_cast<double>(velocity.size()));
    for (std::size_t i = 0; i < velocity.size(); ++i) {
        bodies[i].velocity.x += scale * velocity[i].x;
        bodies[i].velocity.y += scale * velocity[i].y;
    }
}

}  // namespace carom
