#include <carom/carom.hpp>

#include <benchmark/benchmark.h>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "measure/gas.hpp"
#include "measure/text.hpp"

// 200 discs, and what has nothing to do with them: static discs far away, the rest of a long terrain of one
// chain or of separate segments, also one of which a segment is taken and put back, a speed that all share, a
// disc much smaller than the others, grains in the gaps of a pile; and piles in which some discs are heavier.
//     strangers/<case>/<float|double>
// `ratio` is the median time of a step over that of the same scene without it, both in processor time of the
// thread. docs/decisions/0033-costs-of-strangers.md has the figures, 0064-uneven-masses-in-sweeps.md those of
// heavier discs.

namespace carom::bench {
namespace {

constexpr double kStep = measure::kStep;
constexpr int kFirst = 60, kMeasured = 180;  // steps

Material material_of(double friction, double restitution) {
    return {.friction = friction, .restitution = restitution};
}

/// A thin gas beside so many static discs.
Scene beside_static(Solver solver, int strangers) {
    const Material elastic = material_of(0, 1);
    Scene scene;
    scene.accuracy.solver = solver;
    scene.walls = Walls{.min = {-2, -2}, .max = {1000, 1000}, .material = elastic};
    for (int i = 0; i < 200; ++i)
        scene.add({.shape = Disc{0.5},
                   .position = {3.0 * (i % 20), 3.0 * (i / 20)},
                   .velocity = {std::cos(2.4 * i), std::sin(2.4 * i)},
                   .material = elastic});
    const int columns = static_cast<int>(std::ceil(std::sqrt(strangers)));
    for (int i = 0; i < strangers; ++i)
        scene.add({.type = BodyType::static_body,
                   .shape = Disc{0.5},
                   .position = {200 + 1.5 * (i % columns), 200 + 1.5 * (i / columns)},
                   .material = elastic});
    return scene;
}

Scene rough(Vec2 gravity = {0, -10}) {
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = gravity;
    return scene;
}

enum class Terrain { chain, segments };

/// Discs that fall onto hills and roll.
Scene on_terrain(int points, Terrain terrain) {
    Scene scene = rough();
    std::vector<Vec2> hills;
    for (int i = 0; i < points; ++i)
        hills.push_back({0.5 * (points / 2 - i), 2 * std::sin(0.05 * i) + 0.2 * std::sin(0.9 * i)});
    if (terrain == Terrain::chain)
        scene.add({.type = BodyType::static_body, .shape = Chain{hills}, .material = material_of(0.5, 0)});
    for (std::size_t i = 0; i + 1 < hills.size() && terrain == Terrain::segments; ++i)
        scene.add({.type = BodyType::static_body,
                   .shape = Segment{hills[i], hills[i + 1]},
                   .material = material_of(0.5, 0)});
    for (int i = 0; i < 200; ++i)
        scene.add({.shape = Disc{0.5},
                   .position = {-25 + 1.25 * (i % 40), 8 + 1.3 * (i / 40)},
                   .material = material_of(0.5, 0)});
    return scene;
}

/// Discs side by side that fall at a common speed [m/s].
Scene falling(double speed) {
    Scene scene = rough();
    for (int i = 0; i < 200; ++i)
        scene.add({.shape = Disc{0.4 + 0.2 * ((i * 37) % 101) / 101},
                   .position = {1.1 * (i % 10), 1.1 * (i / 10)},
                   .velocity = {0.3 * std::sin(1.7 * i), -speed + 0.5 * std::sin(3.1 * i)},
                   .material = material_of(0.5, 0)});
    return scene;
}

/// A pile of 400 with one small disc, where the radius is above zero [m].
Scene with_small(double radius) {
    Scene scene = rough();
    scene.walls = Walls{.min = {0, 0}, .max = {22, 500}, .top = false, .material = material_of(0.5, 0)};
    for (int i = 0; i < 400; ++i)
        scene.add({.shape = Disc{0.4 + 0.2 * ((i * 37) % 101) / 101},
                   .position = {0.7 + 1.25 * (i % 16), 0.7 + 1.25 * (i / 16)},
                   .material = material_of(0.5, 0)});
    if (radius > 0)
        scene.add({.shape = Disc{radius}, .position = {10.3, 40}, .material = material_of(0.5, 0)});
    return scene;
}

/// 200 discs that fall into a pile, and twelve grains that fall into its gaps, where their radius is above
/// zero [m].
Scene with_grains(double radius, unsigned seed) {
    Scene scene = rough();
    scene.walls = Walls{.min = {0, 0}, .max = {15.2, 200}, .top = false, .material = material_of(0.5, 0)};
    std::mt19937 random(seed);
    const auto offset = [&] { return 0.2 * static_cast<double>(random()) / 4294967295.0; };
    for (int i = 0; i < 200; ++i)
        scene.add({.shape = Disc{0.5},
                   .position = {0.7 + 1.22 * (i % 12) + offset(), 0.6 + 1.05 * (i / 12)},
                   .material = material_of(0.5, 0)});
    for (int i = 0; i < 12 && radius > 0; ++i)
        scene.add({.shape = Disc{radius},
                   .position = {1.2 + 1.1 * i + offset(), 19.5 + offset()},
                   .material = material_of(0.5, 0)});
    return scene;
}

/// A pile of so many columns and as many rows in which one disc in `every` at random is heavier.
Scene of_masses(int columns, double friction, double ratio, unsigned every) {
    constexpr double kPitch = 1.05;  // m
    Scene scene = rough();
    scene.walls = Walls{
        .min = {0, 0}, .max = {kPitch * columns, 1e4}, .top = false, .material = material_of(friction, 0)};
    std::mt19937 random(1);
    for (int row = 0; row < columns; ++row)
        for (int column = 0; column < columns; ++column)
            scene.add({.shape = Disc{0.5},
                       .position = {kPitch * (0.5 + column) + 0.02 * std::sin(1.7 * (row + column)),
                                    kPitch * (0.5 + row)},
                       .mass = random() % every == 0 ? ratio : 1,
                       .material = material_of(friction, 0)});
    return scene;
}

/// Takes the first body of a world, which is a segment, out of it or puts it back.
template <class World>
class TouchedSegment {
  public:
    TouchedSegment(World& world, const Scene& scene) : world_(world), body_(scene.bodies.front()) {}
    void touch() {
        if (is_there_)
            world_.remove(id_);
        else
            id_ = world_.add(body_);
        is_there_ = !is_there_;
    }

  private:
    World& world_;
    Body body_;
    BodyId id_{0, 0};
    bool is_there_ = true;
};

/// Makes a scene when its benchmark runs: some have hundreds of thousands of bodies.
using Make = std::function<Scene()>;

template <class Fn, class... Args>
Make make(Fn scene_of, Args... args) {
    return [=] { return scene_of(args...); };
}

/// @param first  steps before those that are measured  @return s, median of a step
template <class World>
double time_of_step(const Scene& scene, int first, bool is_touched) {
    const auto now = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
    constexpr int kTogether = 5;  // steps: the clock ticks in microseconds
    World world(scene, {.threads = 1});
    TouchedSegment<World> segment(world, scene);
    for (int i = 0; i < first; ++i) world.step(kStep);
    std::vector<double> times;
    for (int i = 0; i < kMeasured / kTogether; ++i) {
        const double start = now();
        for (int k = 0; k < kTogether; ++k) {
            if (is_touched) segment.touch();
            world.step(kStep);
        }
        times.push_back((now() - start) / kTogether);
    }
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
    std::nth_element(times.begin(), middle, times.end());
    return *middle;
}

struct Strangers {
    Make with, without;
    bool is_touched = false;
    int first = kFirst;  // steps before those that are measured
};

template <class World>
void run_strangers(benchmark::State& state, const Strangers& strangers) {
    double time = 0;
    for (auto _ : state) {
        time = time_of_step<World>(strangers.with(), strangers.first, strangers.is_touched);
        state.SetIterationTime(time);
    }
    state.counters["ratio"] = time / time_of_step<World>(strangers.without(), strangers.first, false);
}

const bool kAdded = [] {
    const auto add_all = [](const std::string& name, const Strangers& strangers) {
        const auto add_for = [&](const char* precision, auto run) {
            benchmark::RegisterBenchmark(measure::joined("strangers/", name, "/", precision).c_str(),
                                         [=](benchmark::State& state) { run(state, strangers); })
                ->Unit(benchmark::kMicrosecond)
                ->UseManualTime()
                ->Iterations(1);
        };
        add_for("float", &run_strangers<World>);
        add_for("double", &run_strangers<World64>);
    };
    const auto add = [&](const std::string& name, const Make& with, const Make& without) {
        add_all(name, {.with = with, .without = without});
    };
    for (const int strangers : {10000, 100000})
        for (const Solver solver : {Solver::soft, Solver::impulse})
            add((solver == Solver::soft ? "static-soft-" : "static-impulse-") + std::to_string(strangers),
                make(beside_static, solver, strangers), make(beside_static, solver, 0));
    for (const int points : {2000, 60000})
        add("terrain-" + std::to_string(points), make(on_terrain, points, Terrain::chain),
            make(on_terrain, 200, Terrain::chain));
    for (const int points : {20001, 200001}) {
        const Make with = make(on_terrain, points, Terrain::segments),
                   without = make(on_terrain, 201, Terrain::segments);
        add("segments-" + std::to_string(points - 1), with, without);
        add_all("segment-touched-of-" + std::to_string(points - 1),
                {.with = with, .without = without, .is_touched = true});
    }
    add("falling-150", make(falling, 150), make(falling, 0));
    add("small-1e-3", make(with_small, 1e-3), make(with_small, 0));
    add("small-1e-6", make(with_small, 1e-6), make(with_small, 0));
    for (const auto& [size, radius] : {std::pair{"2e-2", 2e-2}, {"5e-3", 5e-3}})
        for (const unsigned seed : {1u, 2u, 3u, 4u, 5u})
            for (const int first : {kFirst, 10 * kFirst}) {
                const std::string when = first > kFirst ? "lie-" : "fall-";
                add_all(measure::joined("grains-", when, size, "-", std::to_string(seed)),
                        {.with = make(with_grains, radius, seed),
                         .without = make(with_grains, 0, seed),
                         .first = first});
            }
    for (const int ratio : {30, 100, 300})
        for (const double friction : {0.5, 0.0})
            add((friction > 0 ? "half-heavier-" : "half-heavier-smooth-") + std::to_string(ratio),
                make(of_masses, 20, friction, ratio, 2u), make(of_masses, 20, friction, 1, 2u));
    add("few-heavier-100", make(of_masses, 60, 0.5, 100, 1000u), make(of_masses, 60, 0.5, 1, 1000u));
    return true;
}();

}  // namespace
}  // namespace carom::bench
