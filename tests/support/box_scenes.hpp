#pragma once

#include <carom/carom.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "torture/hard/box_scenes.hpp"

// Scenes of boxes that tests of several suites build.

namespace carom::test {

using torture::arch;
using torture::box_at;
using torture::box_ground;
using torture::box_pyramid;
using torture::card_house;
using torture::jitter_of;
using torture::kBoxGravity;
using torture::overhang;
using torture::tower;

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
