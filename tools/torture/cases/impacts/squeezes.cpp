#include <carom/generators.hpp>

#include <cmath>

#include "measure/text.hpp"
#include "torture/cases/impacts/parts.hpp"

namespace carom::torture {
namespace {

constexpr double kSpeed = 1;  // m/s, of the wedge

/// A floor, and a kinematic segment that rises from it to the right and comes down: a disc between them has
/// to move to the right at kSpeed / tan(angle), whatever its size.
Scene wedge(double angle, int discs) {
    constexpr double kLength = 8, kRadius = 0.1, kAt = 2, kGap = 0.01;  // m
    Scene scene;
    scene.walls = Walls{.min = {-1e4, 0}, .max = {1e4, 1e4}, .left = false, .right = false, .top = false};
    for (int i = 0; i < discs; ++i)
        scene.add(disc_of(kRadius, {kAt + i * (2 * kRadius + kGap), kRadius}, {}, {}));
    Body blade;
    blade.type = BodyType::kinematic_body;
    blade.shape = Segment{{0, 0}, {kLength, 0}};
    blade.angle = angle, blade.velocity = {0, -kSpeed};
    // Where its line passes the first disc at a distance of the radius and a gap.
    const double reach = kRadius + kGap;
    blade.position = {0, kRadius + (reach - kAt * std::sin(angle)) / std::cos(angle)};
    scene.add(blade);
    return scene;
}

Outcome run_wedge(const Scene& scene, Solver solver, Precision precision, double limit) {
    constexpr double kLargestRatio = 1.5, kWay = 8;  // m
    const double fastest = kSpeed / std::tan(scene.bodies.back().angle);
    Watch watch(scene, solver, precision, limit);
    double speed = 0, lowest = 1;
    while (watch.simulation().time() < 1.5 * kWay / fastest && watch.step())
        for (std::size_t i = 0; i + 1 < scene.bodies.size(); ++i) {
            const BodyState state = watch.state(i);
            speed = std::fmax(speed, std::hypot(state.velocity.x, state.velocity.y));
            lowest = std::fmin(lowest, state.position.y);
        }
    return {.measures = {{"speed/limit", speed / fastest, kLargestRatio},
                         {"m below the floor", std::fmax(0, -lowest), 0},
                         {"m/s", speed},
                         {"limit", fastest}},
            .failure = watch.failure()};
}

constexpr double kSide = 10;  // m, of a closed box

Scene pushed(double height, double restitution, double friction) {
    const Material material = material_of(restitution, friction);
    Scene scene;
    scene.walls = Walls{.min = {0, 0}, .max = {kSide, kSide}, .material = material};
    scene.add(disc_of(0.5, {5, 5}, {}, material));
    Body pusher = disc_of(0.5, {3, 5 + height}, {2, 0}, material);
    pusher.type = BodyType::kinematic_body;
    scene.add(pusher);
    return scene;
}

/// A crowd that a large disc drives through.
Scene pushed_crowd(double restitution, double friction) {
    const Material material = material_of(restitution, friction);
    Scene scene;
    scene.walls = Walls{.min = {4, 0}, .max = {kSide, kSide}, .material = material};
    Gas gas;
    gas.count = 50, gas.radius = {0.3, 0.5}, gas.seed = 1, gas.body.material = material;
    add_gas(scene, gas);
    scene.walls->min.x = 0;
    Body pusher = disc_of(2, {2, 5}, {2, 0}, material);
    pusher.type = BodyType::kinematic_body;
    scene.add(pusher);
    return scene;
}

Outcome run_pushed(const Scene& scene, Solver solver, Precision precision, double limit) {
    constexpr double kTime = 8;  // s: the pusher is far outside by then
    Watch watch(scene, solver, precision, limit);
    double beyond = 0, speed = 0, overlap = 0;
    while (watch.simulation().time() < kTime && watch.step()) {
        for (std::size_t i = 0; i + 1 < scene.bodies.size(); ++i) {
            const BodyState state = watch.state(i);
            const Vec2 x = state.position;
            beyond = std::fmax(beyond, std::fmax(std::fmax(-x.x, x.x - kSide), std::fmax(-x.y, x.y - kSide)));
            speed = std::fmax(speed, std::hypot(state.velocity.x, state.velocity.y));
        }
        overlap = std::fmax(overlap, watch.simulation().overlaps().max);
    }
    Outcome outcome{.measures = {{"m outside", beyond, 0}, {"m/s", speed}, {"overlap", overlap}},
                    .failure = watch.failure()};
    tell_times(outcome, watch);
    return outcome;
}

}  // namespace

void add_squeezes(std::vector<Task>& all, const Options& asked) {
    const double limit = asked.limit;
    const Run run_one = [=](const Scene& scene, Solver solver, Precision precision) {
        return run_pushed(scene, solver, precision, limit);
    };
    for (const double angle : {0.05, 0.2, 0.5})
        for (const int discs : {1, 3})
            add_impacts(
                all, asked, measure::format("wedge of %g rad, discs: %d", angle, discs), precisions_of(asked),
                [=] { return wedge(angle, discs); },
                [=](const Scene& scene, Solver solver, Precision precision) {
                    return run_wedge(scene, solver, precision, limit);
                });
    for (const double friction : {0., 0.3})
        for (const double e : {0., 0.6}) {
            const auto add = [&](const char* what, const std::function<Scene()>& make) {
                add_impacts(all, asked, measure::format("%s, e %g friction %g", what, e, friction),
                            precisions_of(asked), make, run_one);
            };
            add("pushed against a wall", [=] { return pushed(0, e, friction); });
            add("pushed aside", [=] { return pushed(0.1, e, friction); });
            add("a crowd that is pushed", [=] { return pushed_crowd(e, friction); });
        }
}

}  // namespace carom::torture
