// What joints that are solved exactly give at the end of a step, where their loops can hardly be closed.
#include "scene/call_effects.hpp"
#include "solvers/soft/soft_simulation.hpp"
#include "step/make_simulation.hpp"
#include "support/report.hpp"
#include "world/set_up.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string_view>
#include <vector>

namespace test_end_of_joints {

using namespace carom;
using namespace carom::test;

namespace {

class Draw {
  public:
    explicit Draw(unsigned seed) : random_(seed) {}
    std::size_t below(std::size_t count) { return random_() % count; }
    double uniform(double low, double high) {
        return low + (high - low) * static_cast<double>(random_() % 100'000) / 100'000;
    }
    bool chance(double share) { return uniform(0, 1) < share; }
    double frequency() { return std::exp(uniform(-1.6, 5.3)); }  // Hz

  private:
    std::mt19937 random_;
};

JointKind random_joint(Vec2 between, double distance, Draw& draw) {
    const double which = draw.uniform(0, 1);
    if (which < 0.5) {
        RevoluteJoint hinge{.anchor = between};
        if (draw.chance(0.4)) hinge.lower = -draw.uniform(0, 2), hinge.upper = draw.uniform(0, 2);
        if (draw.chance(0.3)) {
            hinge.frequency = draw.frequency();
            hinge.damping_ratio = draw.chance(0.3) ? 0 : std::exp(draw.uniform(-4.6, 1.1));
        } else if (draw.chance(0.3)) {
            hinge.motor_speed = draw.uniform(-30, 30);
            hinge.max_motor_torque = std::exp(draw.uniform(0, 7));
        }
        return hinge;
    }
    if (which < 0.85) {
        DistanceJoint rod{.length = distance};
        if (draw.chance(0.5)) rod.length = distance * std::exp(draw.uniform(-1.2, 1.2));
        if (draw.chance(0.4)) {
            rod.frequency = draw.frequency();
            rod.damping_ratio = draw.chance(0.3) ? 0 : 0.3;
        }
        return rod;
    }
    WeldJoint weld{.anchor = between};
    if (draw.chance(0.5)) weld.frequency = draw.frequency(), weld.damping_ratio = 0.3;
    return weld;
}

/// Discs of 1 kg that touch nothing, in a net of joints that start stretched, with springs and motors; its
/// lower corners may stand.
Scene stretched_net(unsigned seed) {
    constexpr double kSpacing = 2.05;  // m
    Draw draw(seed);
    const std::size_t columns = 2 + draw.below(3), rows = 2 + draw.below(3);
    const bool is_hung = draw.below(2) == 1;
    Scene scene;
    for (std::size_t y = 0; y < rows; ++y)
        for (std::size_t x = 0; x < columns; ++x) {
            Body body{.shape = Disc{1},
                      .position = {kSpacing * static_cast<double>(x), kSpacing * static_cast<double>(y)},
                      .mass = 1,
                      .group = -7};
            if (is_hung && y == 0 && (x == 0 || x + 1 == columns))
                body.type = BodyType::static_body, body.mass.reset();
            scene.add(body);
        }
    const auto join = [&](std::size_t a, std::size_t b) {
        const Body &first = scene.bodies[a], &second = scene.bodies[b];
        if (first.type == BodyType::static_body && second.type == BodyType::static_body) return;
        const Vec2 between{0.5 * (first.position.x + second.position.x),
                           0.5 * (first.position.y + second.position.y)};
        scene.add(Joint{.a = BodyId{static_cast<std::uint32_t>(a), 0},
                        .b = BodyId{static_cast<std::uint32_t>(b), 0},
                        .kind = random_joint(between, kSpacing, draw)});
    };
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        if (i % columns > 0) join(i - 1, i);
        if (i >= columns) join(i - columns, i);
    }
    return scene;
}

/// The kinetic energy that end_joints gives, over the most that there was before it.
class WatchEnd final : public StageObserver {
  public:
    explicit WatchEnd(SoftSimulation<double>& of) : simulation_(of) {
        of.report_stages([&](const StageState& stage) { names_.push_back(stage.name); });
    }
    void before(std::size_t stage) override {
        if (names_[stage] == "end_joints") before_ = energy(), most_ = std::fmax(most_, before_);
    }
    void after(std::size_t stage) override {
        if (names_[stage] == "end_joints") gain_ = std::fmax(gain_, (energy() - before_) / (most_ + kLeast));
    }
    double gain() const { return gain_; }

  private:
    static constexpr double kLeast = 1000;  // J: of discs of 1 kg that motors turn by 30 rad/s

    double energy() {
        const Column<double>& velocity = simulation_.soft.records().velocity;
        const Bodies<double>& bodies = simulation_.world.bodies;
        double sum = 0;
        for (std::size_t row = 0; row < bodies.moving(); ++row) {
            if (bodies.is_immovable(row)) continue;
            const double vx = velocity[4 * row], vy = velocity[4 * row + 1], rim = velocity[4 * row + 2];
            sum += 0.5 * bodies.mass[row] * (vx * vx + vy * vy + 0.5 * rim * rim);
        }
        return sum;
    }

    SoftSimulation<double>& simulation_;
    std::vector<std::string_view> names_;
    double before_ = 0, most_ = 0, gain_ = 0;
};

double gain_at_end_of(unsigned seed) {
    Scene scene = stretched_net(seed);
    scene.accuracy.solver = Solver::soft;
    const auto simulation = make_simulation<double>(Solver::soft);
    set_up(*simulation, scene, {.threads = 1}, call_effects(scene, {}).effects);
    WatchEnd watch(dynamic_cast<SoftSimulation<double>&>(*simulation));
    for (int i = 0; i < 200; ++i) simulation->step_observed(0.03, watch);
    return watch.gain();
}

}  // namespace

// bound_energy looks at substeps; of the half of one that joints end a step with nothing was bounded.
TEST_CASE("unit: joints that can hardly be closed do not throw their bodies apart at the end of a step") {
    double largest = 0;
    for (const unsigned seed : {704u, 1082u, 1189u, 1329u}) {
        const double gain = gain_at_end_of(seed);
        report("net ", seed, ": joints give ", gain, " of the energy at the end of a step");
        largest = std::fmax(largest, gain);
    }
    CHECK(largest < 2);
}

}  // namespace test_end_of_joints
