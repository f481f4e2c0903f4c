#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr std::array<double, 3> kHeights{0.5, 1, 2};           // m
constexpr std::size_t kCount = 60, kFrom = 20, kTo = 40;       // dominoes; those that are timed
constexpr double kSpacing = 0.4, kThick = 0.1;                 // heights
constexpr double kLean = 0.15, kFalls = 0.1, kFriction = 0.3;  // rad, rad: then one counts
constexpr double kApart = 60, kLongest = 20;                   // m, s

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.add(ground(-50, 250, kFriction));
    double begin = 0;
    for (const double height : kHeights) {
        for (std::size_t i = 0; i < kCount; ++i)
            scene.add(box(kThick * height, height,
                          {begin + static_cast<double>(i) * kSpacing * height, 0.5 * height}, 0, kFriction));
        // The first, turned about its lower right corner beyond its balance.
        Body& first = scene.bodies[scene.bodies.size() - kCount];
        const double arm_x = -0.5 * kThick * height, arm_y = 0.5 * height;
        first.angle = -kLean;
        first.position = {begin + 0.5 * kThick * height + arm_x * std::cos(kLean) + arm_y * std::sin(kLean),
                          arm_y * std::cos(kLean) - arm_x * std::sin(kLean)};
        begin += kApart;
    }
    return scene;
}

/// When a domino passes an angle.
struct Watch {
    std::size_t body;
    double before = 0, time = -1;  // rad, s

    void look(const Stepper& stepper, double now, double dt) {
        if (time >= 0) return;
        const double angle = -stepper.state(body).angle;
        if (angle > kFalls) time = now - dt * (angle - kFalls) / (angle - before);
        before = angle;
    }
};

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    std::vector<Watch> watches;
    for (std::size_t wave = 0; wave < kHeights.size(); ++wave)
        for (const std::size_t domino : {kFrom, kTo}) watches.push_back({1 + wave * kCount + domino});
    const double dt = stepper.setting().dt;
    const auto is_done = [](const Watch& watch) { return watch.time >= 0; };
    for (int i = 1; !std::all_of(watches.begin(), watches.end(), is_done); ++i) {
        if (dt * i > kLongest) throw Failure("a wave of dominoes stopped");
        stepper.advance_to(dt * i);
        for (Watch& watch : watches) watch.look(stepper, dt * i, dt);
    }
    double slowest = 0, fastest = 0;
    for (std::size_t wave = 0; wave < kHeights.size(); ++wave) {
        const double time = watches[2 * wave + 1].time - watches[2 * wave].time;
        const double speed =
            kSpacing * static_cast<double>(kTo - kFrom) / time * std::sqrt(kHeights[wave] / kGravity);
        slowest = wave == 0 ? speed : std::min(slowest, speed), fastest = std::max(fastest, speed);
    }
    return {fastest / slowest - 1};
}

}  // namespace

Case dominoes() {
    return {.id = "A33",
            .title = "Waves of dominoes 0.5, 1 and 2 m high",
            .kind = "structures at their threshold",
            .effects = "G N F W",
            .exact = "v/sqrt(g l) is the same for all three, timed from the 20th to the 40th domino",
            .errors = {{"spread", "the largest of the three over the smallest, less 1"}},
            .solvers = {"soft"},
            .steps = steps_of_structures(),
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy
