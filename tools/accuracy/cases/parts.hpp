#pragma once

#include <carom/generators.hpp>
#include <carom/scene.hpp>

#include <array>
#include <cmath>
#include <cstddef>
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

inline Body box(double width, double height, Vec2 position, double angle, double friction) {
    Body body = disc(1, 1, position, {}, bouncy(0, friction));
    body.shape = Box{width, height};
    body.mass.reset();
    body.angle = angle;
    return body;
}

/// The same, as nothing moves it.
inline Body block(double width, double height, Vec2 position, double angle, double friction) {
    Body body = box(width, height, position, angle, friction);
    body.type = BodyType::static_body;
    return body;
}

/// A floor at y = 0 from `left` to `right`: a block, which other engines can lay boxes on.
inline Body ground(double left, double right, double friction) {
    return block(right - left, 10, {0.5 * (left + right), -5}, 0, friction);
}

/// A disc of a mechanism: it touches no other of them.
inline Body bob(Vec2 position, double mass, double radius = 0.1) {
    Body body = disc(radius, mass, position, {}, {});
    body.group = -1;
    return body;
}

/// A bob that nothing moves: joints hang on it. (The adapters of other engines know joints of two bodies.)
inline Body pivot(Vec2 position) {
    Body body = bob(position, 1);
    body.type = BodyType::static_body;
    return body;
}

inline double distance(Vec2 a, Vec2 b) {
    return std::hypot(a.x - b.x, a.y - b.y);
}

/// Integrates y' = rate(y) by the classical method of Runge and Kutta: the reference where there is no
/// formula.
template <std::size_t kCount, class Rate>
void integrate(std::array<double, kCount>& y, double time, double longest_step, const Rate& rate) {
    using State = std::array<double, kCount>;
    const int steps = static_cast<int>(std::ceil(time / longest_step - 1e-9));
    const double h = time / steps;
    const auto moved = [&](const State& by, double share) {
        State sum = y;
        for (std::size_t i = 0; i < kCount; ++i) sum[i] += share * by[i];
        return sum;
    };
    for (int step = 0; step < steps; ++step) {
        const State k1 = rate(y), k2 = rate(moved(k1, 0.5 * h)), k3 = rate(moved(k2, 0.5 * h)),
                    k4 = rate(moved(k3, h));
        for (std::size_t i = 0; i < kCount; ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
}

/// A floor at y = 0, without sides.
inline Walls floor_of(const Material& material) {
    Walls walls;
    walls.min = {-1e5, 0}, walls.max = {1e5, 1e5};
    walls.left = walls.right = walls.top = false;
    walls.material = material;
    return walls;
}

/// Steps that end at every multiple of 1/30 s, of scenes that take longer.
inline std::vector<double> steps_of_structures() {
    return {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480};
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
