#pragma once

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "torture/energy_rule.hpp"

namespace carom::test {

/// A scene stepped as every hard case has to stand it: nothing drives it, so energy does not grow, nobody is
/// faster than falling makes him, nothing leaves the walls, nothing is quarantined; and a second world,
/// whose parallel tasks run in another order, ends with the same bits.
template <class Real>
class PassiveRun {
  public:
    explicit PassiveRun(const Scene& scene, WorldOptions options = {})
        : world(scene, on_one_thread(options)), again_(scene, in_other_order(options)), walls_(scene.walls) {
        start_ = world.ledger().energy;
        const double gravity =
            std::sqrt(scene.gravity.x * scene.gravity.x + scene.gravity.y * scene.gravity.y);
        double low = 1e300, high = -1e300, fastest = 0;
        for (const Body& body : scene.bodies) {
            low = std::fmin(low, body.position.y), high = std::fmax(high, body.position.y);
            fastest =
                std::fmax(fastest, body.velocity.x * body.velocity.x + body.velocity.y * body.velocity.y);
        }
        if (walls_) low = walls_->min.y;
        largest_speed_ = 1.05 * std::sqrt(fastest + 2 * gravity * (high - low)) + 1e-6;
    }

    void step(double dt) {
        world.step(dt), again_.step(dt);
        const auto bodies = world.bodies();
        for (std::size_t i = 0; i < bodies.count; ++i) {
            const double x = bodies.position_x[i], y = bodies.position_y[i], vx = bodies.velocity_x[i],
                         vy = bodies.velocity_y[i];
            const bool is_fine = std::isfinite(x) && std::isfinite(y) &&
                                 std::hypot(vx, vy) <= largest_speed_ && is_inside(x, y);
            if (!is_fine && failures_++ == 0) {
                const double time = world.time();
                CAPTURE(x);
                CAPTURE(y);
                CAPTURE(vx);
                CAPTURE(vy);
                CAPTURE(time);
                CHECK_MESSAGE(is_fine, "a body is not a number, too fast, or outside");
            }
        }
    }
    void run(double seconds, double dt = 1.0 / 60) {
        for (double end = world.time() + seconds - 0.5 * dt; world.time() < end;) step(dt);
    }
    void check() {
        CHECK(failures_ == 0);
        CHECK(world.quarantined().empty());
        CHECK(world.state_hash() == again_.state_hash());
        CHECK(torture::keeps_energy_rule(world.ledger().energy.total(), start_.total()));
    }
    BodyState state(std::uint32_t body) const { return world.state({body, 0}); }

    BasicWorld<Real> world;

  private:
    static WorldOptions on_one_thread(WorldOptions options) {
        options.threads = 1;
        return options;
    }
    static WorldOptions in_other_order(WorldOptions options) {
        options.threads = 2;
        // Tasks one by one, the last first: what depends on an order or on threads shows, and a busy machine
        // does not make the test slow.
        options.parallel_for = [](std::size_t count, const std::function<void(std::size_t)>& task) {
            while (count-- > 0) task(count);
        };
        return options;
    }
    bool is_inside(double x, double y) const {
        if (!walls_) return true;
        return (!walls_->left || x > walls_->min.x) && (!walls_->right || x < walls_->max.x) &&
               (!walls_->bottom || y > walls_->min.y) && (!walls_->top || y < walls_->max.y);
    }

    BasicWorld<Real> again_;
    std::optional<Walls> walls_;
    Energy start_;
    double largest_speed_ = 0;
    int failures_ = 0;
};

}  // namespace carom::test
