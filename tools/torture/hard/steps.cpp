// Steps of other lengths than the usual one, and changing ones: B10 and B35.
#include "torture/hard/steps.hpp"

#include <cmath>
#include <string>

#include "measure/text.hpp"
#include "torture/hard/discs.hpp"
#include "torture/hard/passive_rule.hpp"
#include "torture/random.hpp"

namespace carom::torture {
namespace {

using measure::format;

constexpr double kRadius = 0.5;                 // m
constexpr double kCalm = 2e-3;                  // m/s, root mean square in a pile at rest
constexpr double kStill = 1e-3;                 // m/s
constexpr int kSettling = 1200;                 // steps
constexpr int kDiscsOfPile = 400;               // of 0.4 to 0.6 m
constexpr std::uint64_t kPile = 6, kPiles = 8;  // seeds: of one pile, of the last of all

/// Rough discs in a box open at the top, let go.
Scene rough_pile(std::uint64_t seed) {
    constexpr int kColumns = 15;
    const Material rough{.friction = 0.5};
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {20, 400}, .top = false, .material = rough};
    Random random(seed, 35);
    for (int i = 0; i < kDiscsOfPile; ++i) {
        const double radius = random.uniform(0.4, 0.6);
        scene.add({.shape = Disc{radius},
                   .position = {0.65 + 1.25 * (i % kColumns) + random.uniform(0, 0.04),
                                0.7 + 1.25 * (i / kColumns)},
                   .material = rough});
    }
    return scene;
}

std::vector<double> usual_steps(int count) {
    return std::vector<double>(static_cast<std::size_t>(count), kUsualStep);
}

std::vector<double> alternating_steps(int count) {
    std::vector<double> steps = usual_steps(count);
    for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = i % 2 == 0 ? 1.0 / 30 : 1.0 / 240;
    return steps;
}

/// Restitution 0 comes to rest by contacts, 1 never touches; the solver of a scene that leaves it open is the
/// one that is meant for it.
HardCase stack(const char* what, double restitution, const std::vector<double>& steps) {
    return {.code = "B10",
            .name = format("stack of ten, e %g: %s", restitution, what),
            .make = [=] { return stack_between_walls(restitution, 0); },
            .run =
                [=](HardRun& run) {
                    return worst_of_all(run, {stack_between_walls(restitution, 0.2)},
                                        [&](HardRun& each) { return stack_after(each, steps); });
                }};
}

}  // namespace

Scene stack_between_walls(double restitution, double slack) {
    const Material material{.restitution = restitution};
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {2 * kRadius + slack, 100}, .material = material};
    scene.accuracy.solver = restitution < 0.5 ? Solver::soft : Solver::impulse;
    double y = kRadius;
    for (int i = 0; i < 10; ++i) {
        scene.add(heavy_disc(kRadius, 1, {kRadius + (i % 2 == 0 ? 0 : slack), y}, material));
        y += std::sqrt(4 * kRadius * kRadius - slack * slack);
    }
    return scene;
}

namespace {

/// Places of a stack: where discs that have come to rest in it should be.
std::vector<Vec2> places_of(const Scene& stack) {
    std::vector<Vec2> places;
    for (const Body& body : stack.bodies) places.push_back(body.position);
    return places;
}

Measures standing(const HardRun& run, const std::vector<Vec2>& places) {
    Largest fastest, shift;
    int out_of_order = 0;
    double below = 0;
    for (std::size_t i = 0; i < run.count(); ++i) {
        const Vec2 at = run.place(i);
        fastest.take(run.speed(i));
        shift.take(std::hypot(at.x - places[i].x, at.y - places[i].y));
        out_of_order += at.y > below ? 0 : 1;
        below = at.y;
    }
    return {{"shift", shift.value(), 10 * 0.005 * kRadius},  // the slop of ten contacts on top of each other
            {"m/s at the end", fastest.value(), kStill},
            {"out of order", static_cast<double>(out_of_order), 0},
            {"overlap", run.overlap(), 0.01},
            {"quarantined", static_cast<double>(run.quarantined()), 0}};
}

/// From above its place, disc by disc higher.
Scene dropped_stack() {
    Scene scene = stack_between_walls(0.3, 0.2);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        scene.bodies[i].position.y += 0.05 * static_cast<double>(i + 1);
    return scene;
}

}  // namespace

Measures stack_after(HardRun& run, const std::vector<double>& steps) {
    const std::vector<Vec2> places = places_of(run.scene());
    EnergyRise rise(run);
    for (const double dt : steps) {
        if (!run.step(dt)) break;
        rise.look(run);
    }
    Measures measures = standing(run, places);
    measures.push_back(rise.measure());
    return measures;
}

HardCases odd_steps_of_a_pile(Extent) {
    HardCases all;
    for (const double times : {0.1, 0.5, 2.1, 5.0, 30.0})
        all.push_back(
            {.code = "B35",
             .name = format("pile of %d at rest, one step of %g times the usual", kDiscsOfPile, times),
             .make = [] { return rough_pile(kPile); },
             .run = [=](HardRun& run) -> Measures {
                 run.steps(kSettling);
                 const double before = run.rms_speed();
                 Largest most;
                 for (int i = 0; i < 60 && run.step((i == 0 ? times : 1) * kUsualStep); ++i)
                     most.take(run.rms_speed());
                 return {{"rms", most.value(), kCalm}, {"rms before", before, kCalm}};
             }});
    return all;
}

namespace {

/// Lengths of steps: drawn at random, or in turns.
struct Lengths {
    double shortest, longest;  // s
    bool is_random = true;

    std::string text() const {
        const double from = 1e3 * shortest, to = 1e3 * longest;
        if (!(from < to)) return format("steps of %.2g ms", to);
        return is_random ? format("random steps of %.2g to %.2g ms", from, to)
                         : format("steps of %.2g and %.2g ms in turns", from, to);
    }
};

Measures speed_under(HardRun& run, const Lengths& lengths) {
    run.steps(kSettling);
    Random random(5, 35);
    Largest most;
    for (int i = 0; i < 600; ++i) {
        const double in_turns = i % 2 == 0 ? lengths.shortest : lengths.longest;
        if (!run.step(lengths.is_random ? random.uniform(lengths.shortest, lengths.longest) : in_turns))
            break;
        most.take(run.rms_speed());
    }
    return {{"rms", most.value(), kCalm}};
}

constexpr Lengths kLengths[] = {{1.0 / 240, 1.0 / 30}, {1e-3, 0.05}, {1e-3, 0.05, false}};

/// @param more  seeds beside the first
HardCases random_steps(const char* what, std::uint64_t first, const std::vector<std::uint64_t>& more) {
    HardCases all;
    for (const Lengths& lengths : kLengths)
        all.push_back({.code = "B35",
                       .name = format("%s at rest, %s", what, lengths.text().c_str()),
                       .make = [=] { return rough_pile(first); },
                       .run =
                           [=](HardRun& run) {
                               std::vector<Scene> others;
                               for (const std::uint64_t seed : more) others.push_back(rough_pile(seed));
                               return worst_of_all(run, others,
                                                   [&](HardRun& each) { return speed_under(each, lengths); });
                           }});
    return all;
}

}  // namespace

HardCases random_steps_of_a_pile(Extent) {
    return random_steps("a pile of 400", kPile, {});
}

HardCases random_steps_of_eight_piles(Extent) {
    std::vector<std::uint64_t> more;
    for (std::uint64_t seed = 2; seed <= kPiles; ++seed) more.push_back(seed);
    return random_steps("eight piles of 400", 1, more);
}

/// The measure is how many of the piles move, a sixth of them at most: some are always about to slip, at
/// steps of any length, one in twenty at 1/60 s (docs/decisions/0095-piles-under-any-step.md).
HardCases changing_steps_of_many_piles(Extent extent) {
    constexpr Lengths kLong[] = {kLengths[0], kLengths[1], kLengths[2], {0.05, 0.05, false}};
    const int piles = extent.is_short ? 6 : 24;
    HardCases all;
    for (const Lengths& lengths : kLong) {
        if (extent.is_short && !lengths.is_random) continue;
        all.push_back({.code = "B35",
                       .name = format("%d piles of 400 at rest, %s", piles, lengths.text().c_str()),
                       .make = [] { return rough_pile(1); },
                       .run = [=](HardRun& run) -> Measures {
                           double moved = 0;
                           const auto look = [&](HardRun& each) {
                               moved += speed_under(each, lengths).front().passes() ? 0 : 1;
                           };
                           look(run);
                           for (int seed = 2; seed <= piles; ++seed)
                               look(*run.another(rough_pile(static_cast<std::uint64_t>(seed))));
                           return {{"piles that move", moved, piles / 6.0}};
                       }});
    }
    return all;
}

HardCases random_steps_of_a_pile_that_sleeps(Extent) {
    return {{.code = "B35",
             .name = format("pile of %d falls asleep under random steps of 1 to 50 ms", kDiscsOfPile),
             .make =
                 [] {
                     Scene scene = rough_pile(kPile);
                     scene.effects.sleep = true;
                     return scene;
                 },
             .run = [](HardRun& run) -> Measures {
                 Random random(5, 35);
                 for (int i = 0; i < 2400 && run.asleep() < kDiscsOfPile; ++i)
                     if (!run.step(random.uniform(1e-3, 0.05))) break;
                 return {{"awake", kDiscsOfPile - static_cast<double>(run.asleep()), 0}};
             }}};
}

namespace {

HardCases stacks(const char* what, const std::vector<double>& steps) {
    HardCases all;
    for (const double restitution : {0.0, 0.5, 1.0}) all.push_back(stack(what, restitution, steps));
    return all;
}

constexpr int kTwentySeconds = 1200;

}  // namespace

HardCases stacks_under_tiny_steps(Extent) {
    return stacks("steps of 1 ns", std::vector<double>(1000, 1e-9));
}

HardCases stacks_under_one_long_step(Extent) {
    // As the very first step, when no contact carries anything yet, it lets the stack give way; it comes
    // back.
    std::vector<double> late = usual_steps(600), cold = usual_steps(600);
    late[100] = cold[0] = 0.5;
    HardCases all = stacks("one step of 0.5 s", late);
    for (HardCase& each : stacks("a first step of 0.5 s", cold)) all.push_back(std::move(each));
    return all;
}

HardCases stacks_under_alternating_steps(Extent) {
    return stacks("steps of 1/30 and 1/240 s in turns", alternating_steps(600));
}

HardCases stacks_dropped_into_a_shaft(Extent) {
    HardCases all;
    for (const bool alternates : {false, true})
        all.push_back({.code = "B10",
                       .name = format("stack of ten dropped into a shaft, %s",
                                      alternates ? "steps of 1/30 and 1/240 s in turns" : "usual steps"),
                       .make = dropped_stack,
                       .run = [=](HardRun& run) {
                           EnergyRise rise(run);
                           const std::vector<double> steps =
                               alternates ? alternating_steps(kTwentySeconds) : usual_steps(kTwentySeconds);
                           for (const double dt : steps) {
                               if (!run.step(dt)) break;
                               rise.look(run);
                           }
                           Measures measures = standing(run, places_of(stack_between_walls(0.3, 0.2)));
                           measures.push_back(rise.measure());
                           return measures;
                       }});
    return all;
}

}  // namespace carom::torture
