#pragma once

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include "support/other_order.hpp"
#include "torture/energy_rule.hpp"
#include "torture/hard/passive_rule.hpp"

namespace carom::test {

/// A scene stepped as every hard case has to stand it: nothing drives it, so energy does not grow, no body is
/// faster than falling makes it, nothing leaves the walls, nothing is quarantined; and a second world,
/// whose parallel tasks run in another order, ends with the same bits.
template <class Real>
class PassiveRun {
  public:
    explicit PassiveRun(const Scene& scene, WorldOptions options = {})
        : world(scene, on_one_thread(options)), again_(scene, in_other_order(options)), rule_(scene) {
        start_ = world.ledger().energy;
    }

    void step(double dt) {
        world.step(dt), again_.step(dt);
        const auto bodies = world.bodies();
        for (std::size_t i = 0; i < bodies.count; ++i) {
            const double x = bodies.position_x[i], y = bodies.position_y[i], vx = bodies.velocity_x[i],
                         vy = bodies.velocity_y[i];
            const bool is_fine = rule_.look({x, y}, {vx, vy});
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

    BasicWorld<Real> again_;
    torture::PassiveRule rule_;
    Energy start_;
    int failures_ = 0;
};

}  // namespace carom::test
