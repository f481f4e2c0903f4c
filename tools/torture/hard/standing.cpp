// Boxes and stones that stand: B1, B2, B15, B40, A28, A30, and the rod of B25 that does not.
#include <cmath>
#include <numbers>

#include "measure/text.hpp"
#include "torture/hard/box_scenes.hpp"
#include "torture/hard/passive_rule.hpp"

namespace carom::torture {
namespace {

using measure::format;

constexpr double kLargestRms = 1e-3;   // m/s
constexpr double kLargestSink = 1e-3;  // of the height

/// Ten seconds to come to rest, and the rest of the time to stay.
HardCase tower_at_rest(int boxes, std::uint64_t seed, int steps) {
    constexpr int kToRest = 600;
    constexpr double kOffset = 0.02;  // m, how far each box is aside, and the most that it may go
    return {.code = "B1",
            .name = format("tower of %d boxes, seed %d", boxes, static_cast<int>(seed)),
            .make = [=] { return tower(boxes, kOffset, seed); },
            .run = [=](HardRun& run) -> Measures {
                const Shifts shifts(run);
                run.steps(kToRest);
                const double early = run.rms_speed();
                run.steps(steps - kToRest);
                return {{"rms after 10 s", early, kLargestRms},
                        {"rms at the end", run.rms_speed(), kLargestRms},
                        {"shift", shifts.farthest(run), kOffset},
                        {"sink/height", shifts.sink(run, run.last()) / boxes, kLargestSink}};
            }};
}

/// From one second on: rows of a pyramid have gaps to close before.
HardCase pyramid_at_rest(int base, int steps_to_rest) {
    constexpr int kSettling = 60, kSteps = 600;
    constexpr double kFarthest = 0.03;  // m
    return {.code = "B2",
            .name = format("pyramid of %d boxes, base %d", base * (base + 1) / 2, base),
            .make = [=] { return box_pyramid(base); },
            .run = [=](HardRun& run) -> Measures {
                const double top = run.place(run.last()).y;
                run.steps(kSettling);
                const Shifts shifts(run);
                run.steps(steps_to_rest - kSettling);
                const double early = run.rms_speed();
                run.steps(kSteps - steps_to_rest);
                return {{"rms, early", early, kLargestRms},
                        {"rms at the end", run.rms_speed(), kLargestRms},
                        {"shift", shifts.farthest(run), kFarthest},
                        {"sink/height", (top - run.place(run.last()).y) / base, kLargestSink}};
            }};
}

constexpr double kStands = 1e-3;  // m, the farthest that something goes which stands
constexpr int kTwentySeconds = 1200;

HardCase stands(std::string code, std::string name, std::function<Scene()> make) {
    return {
        .code = std::move(code), .name = std::move(name), .make = std::move(make), .run = [](HardRun& run) {
            const Shifts shifts(run);
            run.steps(kTwentySeconds);
            return Measures{{"shift", shifts.farthest(run), kStands}};
        }};
}

/// @param body  that falls
/// @param way  m, at least
HardCase falls(std::string code, std::string name, std::function<Scene()> make, std::size_t body,
               double way) {
    return {
        .code = std::move(code), .name = std::move(name), .make = std::move(make), .run = [=](HardRun& run) {
            const Shifts shifts(run);
            run.steps(kTwentySeconds);
            return Measures{{"m fallen", shifts.sink(run, body), way, Sense::at_least}};
        }};
}

/// Painlevé: rigid bodies with this much friction have no acceleration; velocities always exist.
Scene rod_on_tip(double friction, double angle) {
    Scene scene = box_ground(friction);
    const double reach = 0.5 * (std::sin(angle) + 0.02 * std::cos(angle));
    Body rod = box_at(0, reach, 1, 0.02, friction, angle);
    rod.velocity = {-5, 0};
    scene.add(rod);
    scene.effects.ledger = true;
    return scene;
}

Measures energy_of_rod(HardRun& run) {
    constexpr double kMore = 0.1;  // J
    EnergyRise rise(run, std::fabs(run.energy()) + kMore);
    for (int i = 0; i < 180 && run.step(); ++i) rise.look(run);
    const Vec2 at = run.place(1);
    return {rise.measure(), {"not finite", std::isfinite(at.x + at.y) ? 0. : 1., 0}};
}

}  // namespace

HardCases towers_of_20(Extent extent) {
    return {tower_at_rest(20, 1, extent.of(3600, 900)), tower_at_rest(20, 77, extent.of(3600, 900))};
}

HardCases towers_of_40(Extent extent) {
    return {tower_at_rest(40, 77, extent.of(3600, 900))};
}

HardCases towers_that_sleep(Extent) {
    constexpr int kBoxes = 20;
    return {{.code = "B1",
             .name = format("tower of %d boxes that sleeps", kBoxes),
             .make =
                 [] {
                     Scene scene = tower(kBoxes, 0.02, 5);
                     scene.effects.sleep = true;
                     return scene;
                 },
             .run = [](HardRun& run) -> Measures {
                 run.steps(180);
                 return {{"awake after 3 s", kBoxes - static_cast<double>(run.asleep()), 0}};
             }}};
}

HardCases small_pyramids(Extent) {
    return {pyramid_at_rest(20, 600)};
}

HardCases large_pyramids(Extent extent) {
    return {pyramid_at_rest(extent.of(100, 40), 300)};
}

HardCases overhangs(Extent) {
    HardCases all;
    for (const int blocks : {5, 10, 20}) {
        all.push_back(stands("A28", format("overhang of %d blocks, .99 of the limit", blocks),
                             [=] { return overhang(blocks, 0.99); }));
        all.push_back(falls(
            "A28", format("overhang of %d blocks, 1.01 of the limit", blocks),
            [=] { return overhang(blocks, 1.01); }, static_cast<std::size_t>(blocks), 0.2));
    }
    return all;
}

HardCases arches(Extent) {
    constexpr int kStones = 31;
    return {stands("A30", "arch, thickness .115 of the radius", [] { return arch(0.115, kStones); }),
            falls(
                "A30", "arch, thickness .100 of the radius", [] { return arch(0.100, kStones); },
                1 + kStones / 2, 1)};
}

HardCases card_houses(Extent) {
    HardCases all;
    for (const double slope : {65.0, 70.0, 75.0})  // degrees
        all.push_back({.code = "B15",
                       .name = format("card house at %g degrees", slope),
                       .make = [=] { return card_house(slope * std::numbers::pi / 180, 0.6); },
                       .run = [](HardRun& run) -> Measures {
                           const Shifts shifts(run);
                           run.steps(600);
                           return {{"shift/card", shifts.farthest(run), 0.01},
                                   {"rms at the end", run.rms_speed(), kLargestRms}};
                       }});
    return all;
}

HardCases rods_on_their_tip(Extent) {
    HardCases all;
    for (const double friction : {1.4, 2.0, 5.0})
        all.push_back({.code = "B25",
                       .name = format("rod that slides on its tip, friction %g", friction),
                       .make = [=] { return rod_on_tip(friction, 0.4); },
                       .run =
                           [=](HardRun& run) {
                               return worst_of_all(run,
                                                   {rod_on_tip(friction, 0.8), rod_on_tip(friction, 1.2)},
                                                   energy_of_rod);
                           }});
    return all;
}

}  // namespace carom::torture
