#include <array>
#include <cmath>
#include <numbers>

#include "accuracy/galperin.hpp"
#include "measure/text.hpp"
#include "torture/cases/impacts/parts.hpp"
#include "torture/random.hpp"

namespace carom::torture {
namespace {

constexpr double kLargestError = 1e-3;  // of the speed that came in

// Newton's cradle: one ball comes, one leaves; the gaps are crossed within one step.

constexpr int kBalls = 5;

Scene cradle(double friction, double gap) {
    Scene scene;
    for (int i = 0; i < kBalls; ++i)
        scene.add(disc_of(0.5, {(1 + gap) * i - (i == 0 ? 0.2 : 0), 0}, {i == 0 ? 1.0 : 0, 0},
                          material_of(1, friction)));
    return scene;
}

Outcome run_cradle(const Scene& scene, Solver solver, Precision precision, double limit) {
    constexpr double kTime = 2;  // s
    Watch watch(scene, solver, precision, limit);
    watch.advance_to(kTime);
    double error = 0;
    for (std::size_t i = 0; i < kBalls; ++i)
        error = std::fmax(error, std::abs(watch.state(i).velocity.x - (i + 1 == kBalls ? 1 : 0)));
    return {.measures = {{"velocity", error, kLargestError},
                         {"first", watch.state(0).velocity.x},
                         {"last", watch.state(kBalls - 1).velocity.x}},
            .failure = watch.failure()};
}

// Galperin's billiard.

Outcome run_galperin(const Scene& scene, Solver solver, Precision precision, double limit) {
    constexpr double kTime = 30;  // s
    const double ratio = *scene.bodies[1].mass;
    const auto exact = static_cast<std::int64_t>(std::numbers::pi * std::sqrt(ratio));
    Watch watch(scene, solver, precision, limit);
    watch.advance_to(kTime);
    const Profile profile = watch.simulation().profile();
    const std::int64_t impacts = profile.impacts > 0 ? profile.impacts : profile.bounces;
    const double velocity = watch.state(1).velocity.x;
    return {.measures = {{"velocity", std::abs(velocity - accuracy::galperin_velocity(ratio, exact)),
                          kLargestError},
                         {"speed", velocity},
                         {"impacts", static_cast<double>(impacts)},
                         {"of", static_cast<double>(exact)}},
            .failure = watch.failure()};
}

// Pool break: the energy that is left, against `event`, as the mean over some starts.

constexpr int kStarts = 16;

Scene pool(double friction, std::uint64_t start) {
    constexpr double kRadius = 0.028575, kMass = 0.17, kGap = 1e-4, kSpeed = 7;  // m, kg, m, m/s
    Random random(1, start);
    Scene scene;
    const auto add = [&](Vec2 position, Vec2 velocity) {
        scene.add(disc_of(kRadius, position, velocity, material_of(0.95, friction)));
        scene.bodies.back().mass = kMass;
    };
    add({-0.3, random.uniform(-0.005, 0.005)}, {kSpeed, 0});
    const double spacing = 2 * kRadius + kGap, play = 0.2 * kGap;
    for (int row = 0; row < 5; ++row)
        for (int i = 0; i <= row; ++i)
            add({row * spacing * 0.5 * std::numbers::sqrt3 + random.uniform(-play, play),
                 (i - 0.5 * row) * spacing + random.uniform(-play, play)},
                {});
    return scene;
}

double pool_energy(double friction, Solver solver, Precision precision, double limit, std::string& failure) {
    constexpr double kTime = 0.3;  // s: the break is over, none has come back
    double sum = 0;
    for (std::uint64_t start = 0; start < kStarts; ++start) {
        const Scene scene = pool(friction, start);
        Watch watch(scene, solver, precision, limit);
        const double first = watch.kinetic_energy();
        watch.advance_to(kTime);
        sum += watch.kinetic_energy() / first / kStarts;
        if (watch.gave_up()) failure = watch.failure();
    }
    return sum;
}

Outcome run_pool(double friction, Solver solver, Precision precision, double limit) {
    constexpr double kLargestDifference = 0.03;
    Outcome outcome;
    const double exact = pool_energy(friction, Solver::event, Precision::double_, limit, outcome.failure);
    const double found = pool_energy(friction, solver, precision, limit, outcome.failure);
    outcome.measures = {{"difference", std::abs(found / exact - 1), kLargestDifference},
                        {"energy left", found},
                        {"exact", exact}};
    return outcome;
}

}  // namespace

void add_impacts_in_line(std::vector<Task>& all, const Options& asked) {
    const double limit = asked.limit;
    for (const double friction : {0., 0.2})
        for (const double gap : {0.002, 0.05})
            add_impacts(
                all, asked, measure::format("cradle of 5, friction %g, gaps %g m", friction, gap),
                precisions_of(asked), [=] { return cradle(friction, gap); },
                [=](const Scene& scene, Solver solver, Precision precision) {
                    return run_cradle(scene, solver, precision, limit);
                });
    for (const int k : {1, 2, 3})
        add_impacts(
            all, asked, measure::format("Galperin, k = %d", k), precisions_of(asked),
            [=] { return accuracy::galperin_scene(std::pow(100.0, k)); },
            [=](const Scene& scene, Solver solver, Precision precision) {
                return run_galperin(scene, solver, precision, limit);
            });
    for (const double friction : {0., 0.06})
        add_impacts(
            all, asked, measure::format("pool break, friction %g", friction), precisions_of(asked),
            [=] { return pool(friction, 0); },
            [=](const Scene&, Solver solver, Precision precision) {
                return run_pool(friction, solver, precision, limit);
            });
}

}  // namespace carom::torture
