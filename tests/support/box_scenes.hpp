#pragma once

#include <carom/carom.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

// Scenes of boxes that tests of several suites build.

namespace carom::test {

inline constexpr double kBoxGravity = 9.81;  // m/s²

/// A world under gravity with a flat static box as its ground; its top is y = 0.
inline Scene box_ground(double friction, double half_width = 50) {
    Scene scene;
    scene.gravity = {0, -kBoxGravity};
    scene.add({.type = BodyType::static_body,
               .shape = Box{2 * half_width, 10},
               .position = {0, -5},
               .material = {.friction = friction}});
    return scene;
}

inline Body box_at(double x, double y, double width, double height, double friction, double angle = 0) {
    return {
        .shape = Box{width, height}, .position = {x, y}, .angle = angle, .material = {.friction = friction}};
}

/// Numbers of [-1, 1], the same on every machine.
inline double jitter_of(std::uint64_t number) {
    std::uint64_t z = number + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) % 2001) / 1000 - 1;
}

/// A tower of unit boxes, each up to `offset` [m] aside.
inline Scene tower(int boxes, double offset, std::uint64_t seed, double friction = 0.6) {
    Scene scene = box_ground(friction);
    for (int i = 0; i < boxes; ++i)
        scene.add(box_at(offset * jitter_of(seed + static_cast<std::uint64_t>(i)), i + 0.5, 1, 1, friction));
    return scene;
}

/// Rows of unit boxes, `base` at the bottom, gaps of `gap` [m] between them.
inline Scene box_pyramid(int base, double gap = 0.05, double friction = 0.6) {
    Scene scene = box_ground(friction, 3.0 * base);
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            scene.add(box_at((i - (base - row - 1) / 2.0) * (1 + gap), row + 0.5, 1, 1, friction));
    return scene;
}

/// Blocks 1 m long, each jutting out over the one below by `share` of the most that can stand:
/// 1 / (2 k) m for the k-th from the top. The table's edge is x = 0.
inline Scene overhang(int blocks, double share, double friction = 0.6) {
    Scene scene;
    scene.gravity = {0, -kBoxGravity};
    scene.add({.type = BodyType::static_body,
               .shape = Box{10, 10},
               .position = {-5, -5},
               .material = {.friction = friction}});
    double edge = 0;
    for (int k = blocks, row = 0; k >= 1; --k, ++row) {
        edge += share / (2.0 * k);
        scene.add(box_at(edge - 0.5, 0.25 * row + 0.125, 1, 0.25, friction));
    }
    return scene;
}

/// What a run of a scene did since a moment.
template <class Real>
class BoxRun {
  public:
    explicit BoxRun(const Scene& scene, const WorldOptions& options = {.threads = 1})
        : world(scene, options), count_(scene.bodies.size()) {
        mark();
    }
    void steps(int number, double dt = 1.0 / 60) {
        for (int i = 0; i < number; ++i) world.step(dt);
    }
    /// Shifts are told from here on.
    void mark() {
        start_.clear();
        for (std::size_t i = 0; i < count_; ++i) start_.push_back(place(i));
    }
    Vec2 place(std::size_t body) const {
        const std::size_t row = world.row(id(body));
        return {world.bodies().position_x[row], world.bodies().position_y[row]};
    }
    Vec2 start(std::size_t body) const { return start_[body]; }
    double angle(std::size_t body) const { return world.bodies().angle[world.row(id(body))]; }
    Vec2 velocity(std::size_t body) const {
        const std::size_t row = world.row(id(body));
        return {world.bodies().velocity_x[row], world.bodies().velocity_y[row]};
    }
    double spin(std::size_t body) const { return world.bodies().angular_velocity[world.row(id(body))]; }
    double farthest_shift() const {
        double farthest = 0;
        for (std::size_t i = 0; i < count_; ++i)
            farthest = std::fmax(farthest, std::hypot(place(i).x - start_[i].x, place(i).y - start_[i].y));
        return farthest;
    }
    /// Root of the mean square of the speeds of all bodies, the ground included [m/s].
    double rms_speed() const {
        double sum = 0;
        for (std::size_t i = 0; i < count_; ++i) sum += std::pow(std::hypot(velocity(i).x, velocity(i).y), 2);
        return std::sqrt(sum / static_cast<double>(count_));
    }
    std::size_t last() const { return count_ - 1; }

    BasicWorld<Real> world;

  private:
    static BodyId id(std::size_t body) { return {static_cast<std::uint32_t>(body), 0}; }

    std::size_t count_;
    std::vector<Vec2> start_;
};

}  // namespace carom::test
