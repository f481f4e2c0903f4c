#pragma once

#include <carom/scene.hpp>

#include <cstdint>
#include <vector>

namespace carom::test {

/// An oracle: discs, walls and common gravity, advanced from impact to impact, from first principles and in
/// long double. Looks at every pair before every impact, so for some dozens of discs. Shares no code with the
/// engine. Impacts happen one after the other, ties in the order of the bodies; nothing comes to rest.
class EventSimulation {
  public:
    using Number = long double;
    struct Disc {
        Number x, y, vx, vy;  // m, m/s
        Number mass, radius, restitution;
    };

    /// @param rounded  what a number of the scene is in the precision it is compared with
    explicit EventSimulation(
        const Scene& scene, Number (*rounded)(double) = [](double v) { return Number(v); });

    /// Takes every impact up to `time` [s] and flies on to it.
    void run_until(Number time);

    std::vector<Disc> discs;
    std::int64_t pair_impacts = 0;
    std::int64_t wall_impacts = 0;
    Number wall_impulse = 0;  // N s, sum of magnitudes
    Number energy() const;    // J, kinetic and potential

  private:
    struct Event {
        Number after;  // s, from now
        int a, b;      // discs, or b < 0: side -1 - b of the walls
    };
    struct Side {
        bool is_closed;
        Number normal_x, normal_y, offset;  // clearance = normal · x - offset
    };

    Event next_event() const;
    Number time_to_meet(const Disc& a, const Disc& b) const;
    Number time_to_wall(const Disc& disc, const Side& side) const;
    void fly(Number duration);
    void collide(Disc& a, Disc& b);
    void bounce(Disc& disc, const Side& side);

    Number time_ = 0, gravity_x_, gravity_y_, wall_restitution_ = 0;
    std::vector<Side> sides_;
};

template <class Real>
EventSimulation::Number rounded_to(double value) {
    return static_cast<EventSimulation::Number>(static_cast<Real>(value));
}

}  // namespace carom::test
