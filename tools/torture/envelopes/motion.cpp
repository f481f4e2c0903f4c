// Steps, speeds, and distance from the origin.
#include <algorithm>
#include <cmath>

#include "torture/envelopes/envelope.hpp"
#include "torture/hard/box_scenes.hpp"
#include "torture/hard/far.hpp"
#include "torture/hard/passive_rule.hpp"
#include "torture/hard/steps.hpp"
#include "torture/random.hpp"

namespace carom::torture {
namespace {

constexpr int kTenSeconds = 600;
constexpr Range kSteps{.first = 1.0 / 240, .last = 1, .stride = 2, .narrow = 1.1};  // s

int steps_of(double seconds, double dt) {
    return std::max(60, static_cast<int>(std::lround(seconds / dt)));
}

/// 200 discs dropped into a box.
Scene dropped_discs(std::uint64_t seed) {
    constexpr int kColumns = 14, kDiscs = 200;
    Random random(seed, 2);
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {1.2 * kColumns, 1000}, .top = false};
    for (int i = 0; i < kDiscs; ++i) {
        const double x = 1.2 * (i % kColumns) + 0.6 + random.uniform(-0.08, 0.08);
        scene.add({.shape = Disc{0.5}, .position = {x, 2 + 1.2 * (i / kColumns)}});
    }
    return scene;
}

Measures dropped(HardRun& run, double dt) {
    constexpr double kTwentySeconds = 20, kLargestOverlap = 0.05;  // of the radius
    Passive passive(run);
    for (int i = steps_of(kTwentySeconds, dt); i > 0 && run.step(dt); --i) passive.look(run);
    Measures measures{{"overlap at the end", run.overlap(), kLargestOverlap}};
    passive.add_to(measures, run);
    return measures;
}

constexpr double kRadius = 0.05;  // m, of what is shot
constexpr double kApart = 1000;   // m, from one shot to the next
constexpr int kShots = 20;

/// @param body  that is shot, with its speed along x still to be set
/// @param target  of static bodies
Scene shots(double radii_a_step, std::uint64_t seed, const Body& body, const Body& target) {
    Random random(seed, 3);
    Scene scene;
    for (int i = 0; i < kShots; ++i) {
        const double speed = radii_a_step * kRadius / kUsualStep, y = kApart * (i - 0.5 * kShots);
        Body fixed = target, shot = body;
        fixed.position = {0, y};
        // Met at any part of the first three steps.
        shot.position = {-4 * kRadius - random.uniform(0, 3) * speed * kUsualStep,
                         y + random.uniform(-0.5, 0.5) * kRadius};
        shot.angle = random.uniform(0, 6);
        shot.velocity = {speed, 0};
        scene.add(fixed);
        scene.add(shot);
    }
    return scene;
}

Measures stopped(HardRun& run) {
    EnergyRise rise(run);
    for (int i = 0; i < 6 && run.step(); ++i) rise.look(run);
    int passed = 0;
    for (std::size_t shot = 1; shot < run.count(); shot += 2) passed += run.place(shot).x < 0 ? 0 : 1;
    return {{"passed", static_cast<double>(passed), 0},
            rise.measure(),
            {"quarantined", static_cast<double>(run.quarantined()), 0}};
}

Envelope speed(std::string name, std::string title, const Body& body, const Body& target) {
    return {.name = std::move(name),
            .title = std::move(title),
            .criterion = "of 20 shots none is behind its target after six steps, and energy keeps the rule",
            .range = {.first = 1, .last = 1e6, .stride = 10, .narrow = 1.5},
            .seeds = {1, 2, 3},
            .make = [=](double value, std::uint64_t seed) { return shots(value, seed, body, target); },
            .run = [](HardRun& run, double) { return stopped(run); }};
}

}  // namespace

Envelopes step_lengths() {
    return {{.name = "step-stack",
             .title = "seconds a step, ten discs on each other between walls",
             .criterion =
                 "after 10 s, and 60 steps at least, none has moved by 2.5 cm, is faster than 1 mm/s, or "
                 "out of order; overlap at most 1 %; energy keeps the rule",
             .range = kSteps,
             .seeds = {1},
             .make =
                 [](double, std::uint64_t) {
                     Scene scene = stack_between_walls(0, 0.2);
                     scene.accuracy.solver = Solver::automatic;
                     return scene;
                 },
             .run =
                 [](HardRun& run, double dt) {
                     return stack_after(run, std::vector<double>(std::size_t(steps_of(10, dt)), dt));
                 }},
            {.name = "step-tower",
             .title = "seconds a step, a tower of ten boxes",
             .criterion = "after 10 s, and 60 steps at least, no box has moved by 2 cm",
             .range = kSteps,
             .seeds = {1},
             .make = [](double, std::uint64_t seed) { return tower(10, 0.02, seed); },
             .run = [](HardRun& run, double dt) -> Measures {
                 const Shifts shifts(run);
                 run.steps(steps_of(10, dt), dt);
                 return {{"shift", shifts.farthest(run), 0.02}};
             }},
            {.name = "step-drop",
             .title = "seconds a step, 200 discs dropped into a box",
             .criterion = "after 20 s, and 60 steps at least, overlaps are at most 5 %; energy and speed as "
                          "falling allows all the time, none outside",
             .range = kSteps,
             .seeds = {1, 2, 3},
             .make = [](double, std::uint64_t seed) { return dropped_discs(seed); },
             .run = dropped}};
}

Envelopes speeds() {
    const Material elastic{.restitution = 0.5};
    Body disc{.shape = Disc{kRadius}, .material = elastic}, peg = disc, plate = disc, box = disc;
    peg.type = plate.type = BodyType::static_body;
    plate.shape = Box{0.2 * kRadius, 40 * kRadius};
    box.shape = Box{2 * kRadius, kRadius};
    return {speed("speed-disc", "radii a step, a disc of 5 cm at a fixed one", disc, peg),
            speed("speed-plate", "radii a step, a disc of 5 cm at a plate of 1 cm", disc, plate),
            speed("speed-box", "half sides a step, a box of 10 cm at a plate of 1 cm", box, plate)};
}

Envelopes distances() {
    return {{.name = "distance",
             .title = "metres from the origin, a tower of ten boxes",
             .criterion = "after 10 s no box has moved by 2 cm, rms speed at most 1 cm/s",
             .range = {.first = 1, .last = 1e7, .stride = 10, .narrow = 1.5},
             .seeds = {1},
             .make = [](double distance, std::uint64_t) { return stack_far_away(distance); },
             .run = [](HardRun& run, double) -> Measures {
                 const Shifts shifts(run);
                 run.steps(kTenSeconds);
                 return {{"shift", shifts.farthest(run), 0.02}, {"rms", run.rms_speed(), 0.01}};
             }}};
}

}  // namespace carom::torture
