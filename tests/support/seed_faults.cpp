#include "support/seed_faults.hpp"

#include "support/seed_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace carom::test {
namespace {

constexpr double kSeedGravity = 4;  // m/s^2, downwards

void step_for(SeedRun& run, double seconds, double dt) {
    const long steps = std::lround(seconds / dt);
    for (long step = 0; step < steps; ++step) run.step(dt);
}

double kinetic(const std::vector<PairwiseBody>& bodies) {
    double sum = 0;
    for (const PairwiseBody& body : bodies) sum += kinetic_energy(body);
    return sum;
}

/// Above the height where a disc lies on the floor y = 0.
double potential(const std::vector<PairwiseBody>& bodies) {
    double sum = 0;
    for (const PairwiseBody& body : bodies) sum += body.mass * kSeedGravity * (body.y - body.radius);
    return sum;
}

double total(const std::vector<PairwiseBody>& bodies) {
    return kinetic(bodies) + potential(bodies);
}

double common_centre_x(const std::vector<PairwiseBody>& bodies) {
    double moment = 0, mass = 0;
    for (const PairwiseBody& body : bodies) moment += body.mass * body.x, mass += body.mass;
    return moment / mass;
}

/// A number close to normal, from sums alone, so that every machine draws the same bits.
double draw_normal(std::mt19937_64& random) {
    double sum = -6;
    for (int draw = 0; draw < 12; ++draw) sum += static_cast<double>(random() >> 11) * 0x1p-53;
    return sum;
}

/// Discs of radius 0.5 and 1 kg on a square lattice in a closed box, velocities normal, no total momentum.
PairwiseScene gas_scene(int row_length, double packing_fraction, double rms_speed) {
    const double count = row_length * row_length;
    const double spacing = std::sqrt(std::numbers::pi * 0.25 / packing_fraction);  // m
    PairwiseScene scene;
    scene.restitution = 1;
    scene.walls =
        PairwiseWalls{.max_x = spacing * row_length, .max_y = spacing * row_length, .restitution = 1};
    std::mt19937_64 random(1);
    double mean_x = 0, mean_y = 0;
    for (int row = 0; row < row_length; ++row) {
        for (int column = 0; column < row_length; ++column) {
            PairwiseBody body{.x = spacing * (column + 0.5), .y = spacing * (row + 0.5)};
            body.vx = draw_normal(random);
            body.vy = draw_normal(random);
            scene.bodies.push_back(body);
            mean_x += scene.bodies.back().vx / count, mean_y += scene.bodies.back().vy / count;
        }
    }
    for (PairwiseBody& body : scene.bodies) body.vx -= mean_x, body.vy -= mean_y;
    const double scale = rms_speed / std::sqrt(2 * kinetic(scene.bodies) / count);
    for (PairwiseBody& body : scene.bodies) body.vx *= scale, body.vy *= scale;
    return scene;
}

/// The pressure that a bulk gas has is not quite that of 196 discs in a closed box: the excess is 0.2, 0.8
/// and 1.4 % at packing fractions 0.1, 0.2 and 0.3 (2000 s with the engine, steps of 1/60 s), and it halves
/// with every doubling of the box (0.1, 0.4, 0.7 % with 784 discs; 0.1, 0.2, 0.3 % with 3136), as an effect
/// of the walls must.
double box_excess(double packing_fraction) {
    return packing_fraction * (0.012 + 0.12 * packing_fraction);  // through these to 0.1 %
}

/// Pressure of a bulk gas of hard discs over that of an ideal one. Source: Henderson, Mol. Phys. 30 (1975)
/// 971.
double henderson(double packing_fraction) {
    const double free = 1 - packing_fraction;
    return (1 + packing_fraction * packing_fraction / 8) / (free * free);
}

}  // namespace

double elastic_energy_gain(StartRun start, double dt) {
    PairwiseScene scene = seed_scene_s1();
    scene.linear_drag = 0;
    scene.restitution = 1;
    scene.walls->restitution = 1;
    const auto run = start(scene);
    const double before = total(run->bodies());
    step_for(*run, kSeedSteps * kSeedDt, dt);
    return total(run->bodies()) / before - 1;
}

double drag_felt(StartRun start, double dt) {
    PairwiseScene scene;
    scene.bodies = {{.vx = 1}};
    scene.linear_drag = kSeedDrag;
    scene.keep_per_step = 0.98;  // the naive engine's; the engine itself only knows drag in 1/s
    const auto run = start(scene);
    const long steps = std::lround(1 / dt);
    for (long step = 0; step < steps; ++step) run->step(dt);
    return -std::log(run->bodies()[0].vx) / (static_cast<double>(steps) * dt);
}

double distance_after_two_seconds(StartRun start, double distance) {
    PairwiseScene scene;
    scene.bodies = {{}, {.x = distance}};
    const auto run = start(scene);
    step_for(*run, 2, kSeedDt);
    const auto bodies = run->bodies();
    return std::hypot(bodies[1].x - bodies[0].x, bodies[1].y - bodies[0].y);
}

double common_centre_shift(StartRun start) {
    PairwiseScene scene;
    scene.bodies = {{.mass = 1}, {.x = 0.8, .mass = 100}};
    const auto run = start(scene);
    run->step(kSeedDt);
    return std::abs(common_centre_x(run->bodies()) - common_centre_x(scene.bodies));
}

double spin_change(StartRun start) {
    PairwiseScene scene;
    const double aside = std::sqrt(0.5);  // the discs touch when the first one passes the origin
    scene.bodies = {{.x = -0.3, .vx = 3, .omega = 10}, {.x = aside, .y = aside}};
    scene.restitution = 1;
    const auto run = start(scene);
    step_for(*run, 0.5, kSeedDt);
    const auto bodies = run->bodies();
    return std::max(std::abs(bodies[0].omega - 10), std::abs(bodies[1].omega));
}

double speed_of_leaving_disc(StartRun start) {
    PairwiseScene scene;
    scene.bodies = {{.x = 0.499, .y = 4, .vx = 1}};
    scene.restitution = 0.8;
    scene.walls = PairwiseWalls{.max_x = 10, .max_y = 8, .restitution = 0.8};
    const auto run = start(scene);
    run->step(kSeedDt);
    return run->bodies()[0].vx;
}

double share_of_shots_through(StartRun start) {
    constexpr int kShots = 1000;
    constexpr double kSpeed = 100;  // m/s: 1.6 m a step, where both discs together measure 1 m
    int through = 0;
    for (int shot = 0; shot < kShots; ++shot) {
        const double distance = 5 + kSpeed * kSeedDt * shot / kShots;
        PairwiseScene scene;
        scene.bodies = {{.x = -distance, .vx = kSpeed, .radius = 0.25}, {.radius = 0.25}};
        scene.restitution = 1;
        const auto run = start(scene);
        for (int step = 0; step < 10; ++step) run->step(kSeedDt);
        const auto bodies = run->bodies();
        if (bodies[1].vx == 0 && bodies[0].x > bodies[1].x) ++through;
    }
    return static_cast<double>(through) / kShots;
}

EnergyLeft energy_left(StartRun start) {
    const auto run = start(seed_scene_s1());
    const auto first = run->bodies();
    step_for(*run, kSeedSteps * kSeedDt, kSeedDt);
    const auto last = run->bodies();
    return {kinetic(last) / kinetic(first), total(last) / total(first)};
}

FallEnergy fall_energy(StartRun start) {
    PairwiseScene scene;
    scene.bodies = {{.y = 6}};
    scene.gravity_y = -kSeedGravity;
    const auto run = start(scene);

    step_for(*run, 1.6, kSeedDt);
    const auto last = run->bodies();
    return {kinetic(last) - kinetic(scene.bodies), total(last) - total(scene.bodies)};
}

GasReport elastic_gas(StartRun start, double packing_fraction, double dt) {
    constexpr double kSettle = 20, kMeasure = 200;  // s
    const PairwiseScene scene = gas_scene(14, packing_fraction, 3);
    const auto run = start(scene);
    step_for(*run, kSettle, dt);
    const double impulse_before = run->wall_impulse();
    step_for(*run, kMeasure, dt);

    // Virial theorem: centres reach the walls to within a radius, so P * side * (side - 2 r) = N k T Z.
    const double side = scene.walls->max_x;
    const double measured_for = static_cast<double>(std::lround(kMeasure / dt)) * dt;
    const double pressure = (run->wall_impulse() - impulse_before) / (4 * side * measured_for);
    const double energy = kinetic(run->bodies());  // N k T
    const double compressibility = pressure * side * (side - 1) / energy;
    const double expected = henderson(packing_fraction) * (1 + box_excess(packing_fraction));
    return {compressibility / expected - 1, energy / kinetic(scene.bodies) - 1};
}

}  // namespace carom::test
