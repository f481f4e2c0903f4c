#pragma once

#include <carom/generators.hpp>
#include <carom/scene.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "accuracy/cases.hpp"

// What several cases share.

namespace carom::accuracy {

inline constexpr double kGravity = 9.81;  // m/s²

inline Material bouncy(double restitution, double friction = 0) {
    Material material;
    material.restitution = restitution, material.friction = friction;
    return material;
}

inline Body disc(double radius, double mass, Vec2 position, Vec2 velocity, const Material& material) {
    Body body;
    body.shape = Disc{radius};
    body.mass = mass, body.position = position, body.velocity = velocity, body.material = material;
    return body;
}

/// A floor at y = 0, without sides.
inline Walls floor_of(const Material& material) {
    Walls walls;
    walls.min = {-1e5, 0}, walls.max = {1e5, 1e5};
    walls.left = walls.right = walls.top = false;
    walls.material = material;
    return walls;
}

/// Steps that end at every multiple of 1/30 s.
inline std::vector<double> steps_of_frames() {
    return {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480, 1.0 / 960, 1.0 / 1920};
}

/// A number in [-1, 1) made of two others: every start its own.
inline double jitter(std::uint64_t member, std::uint64_t index) {
    std::uint64_t bits = (member * 0x9E3779B97F4A7C15u) ^ ((index + 1) * 0xD1B54A32D192ED03u);  // Steele 2014
    bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
    bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
    bits ^= bits >> 31;
    return static_cast<double>(bits >> 11) * 0x1.0p-52 - 1;
}

/// Discs of radius .5 m and 1 kg/m² in a closed square box, rms speed 3 m/s.
inline Scene gas_of(std::int64_t count, double packing_fraction, double restitution, int member) {
    const double half =
        0.5 * std::sqrt(static_cast<double>(count) * std::numbers::pi * 0.25 / packing_fraction);
    Scene scene;
    scene.walls = Walls{.min = {-half, -half}, .max = {half, half}, .material = bouncy(restitution)};
    Gas gas;
    gas.count = count;
    gas.velocity_rms = 3;
    gas.seed = static_cast<std::uint64_t>(member) + 1;
    gas.body.material = bouncy(restitution);
    add_gas(scene, gas);
    return scene;
}

/// Impacts between discs, walls included or not; not a number if the solver counts none.
inline double count_impacts(const Stepper& stepper, bool with_walls) {
    const Profile profile = stepper.simulation().profile();
    if (profile.impacts == 0) return std::nan("");
    return static_cast<double>(profile.impacts - (with_walls ? 0 : profile.wall_impacts));
}

/// Root mean square of what is added.
class RootMeanSquare {
  public:
    void add(double value) { sum_ += value * value, count_ += 1; }
    double value() const { return count_ > 0 ? std::sqrt(sum_ / count_) : 0; }

  private:
    double sum_ = 0, count_ = 0;
};

}  // namespace carom::accuracy
