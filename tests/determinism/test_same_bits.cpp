// B28 of docs/hard-cases.md: the same scene gives the same bits on rerun, for every instruction set and any
// number of threads, in every build. The hashes below hold for gcc and clang, release and debug; those in
// tests/embed/main.cpp are also checked with gcc and no optimisation. To print new ones after a change that
// is meant to change them:
//   CAROM_TEST_FIGURES=1 build/release/bin/carom_tests --test-case="*golden*"
#include <doctest/doctest.h>
#include <carom/carom.hpp>
#include <carom/generators.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "scene/call_effects.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60;  // s

Scene gas(std::int64_t count, RadiusRange radius, double restitution) {
    Scene scene;
    scene.name = "gas";
    scene.walls.emplace();
    const double side = std::sqrt(static_cast<double>(count) * 3.2 * radius.max * radius.max / 0.4);
    scene.walls->max = {side, side};
    scene.walls->material.restitution = restitution;
    Gas discs;
    discs.count = count, discs.radius = radius, discs.velocity_rms = 3, discs.seed = 4;
    discs.body.material.restitution = restitution;
    add_gas(scene, discs);
    return scene;
}

Scene falling_sizes() {
    Scene scene = gas(300, {0.01, 1}, 0.6);
    scene.name = "falling sizes";
    scene.gravity = {0.5, -9.81};
    scene.drag = {.linear = 0.3, .angular = 0.1};
    scene.bodies[5].angular_velocity = 2;
    return scene;
}

Scene moving_obstacles() {
    Scene scene = gas(200, {0.3, 0.5}, 0.8);
    scene.name = "moving obstacles";
    scene.gravity = {0, -5};
    const double side = scene.walls->max.x;
    Body post;
    post.type = BodyType::static_body;
    post.shape = Disc{1.5};
    post.position = {side / 2, side / 3};
    scene.add(post);
    post.type = BodyType::kinematic_body;
    post.position = {2, -3}, post.velocity = {1, 0.5};
    scene.add(post);
    return scene;
}

Scene stack_at_rest() {
    Scene scene;
    scene.name = "stack at rest";
    scene.gravity = {0, -10};
    scene.walls.emplace();
    scene.walls->max = {3, 30};
    Stack discs;
    discs.count = 6, discs.origin = {1.5, 0.5};
    discs.body.material.restitution = 0.5;
    add_stack(scene, discs);
    return scene;
}

/// Solver `soft` with all it has: friction, sizes, bodies that do not turn, restitution, a moving obstacle.
Scene rough_sizes() {
    Scene scene = moving_obstacles();
    scene.name = "rough sizes";
    scene.drag = {.linear = 0.1, .angular = 0.1};
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        Material& material = scene.bodies[i].material;
        material.friction = i % 3 == 0 ? 0.2 : 0.6;
        material.restitution = i % 4 == 0 ? 0.5 : 0;
        scene.bodies[i].fixed_rotation = i % 7 == 0;
    }
    scene.walls->material = {.friction = 0.4};
    return scene;
}

Scene rolling_sizes() {
    Scene scene = rough_sizes();
    scene.name = "rolling sizes";
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        scene.bodies[i].material.rolling_resistance = i % 5 == 0 ? 0.3 : 0.05;
    return scene;
}

/// A container that turns, a segment that moves, a static chain under all of them.
Scene turning_chain() {
    Scene scene;
    scene.name = "turning chain";
    scene.gravity = {0, -10};
    const Material rough{.friction = 0.5, .restitution = 0.3};
    scene.add({.type = BodyType::kinematic_body,
               .shape = Chain{.points = {{-6, -5}, {0, -6}, {6, -5}, {6, 6}, {-6, 6}}, .loop = true},
               .angle = 0.2,
               .angular_velocity = 0.7,
               .material = rough});
    Lattice discs;
    discs.count_x = 9, discs.count_y = 8, discs.origin = {-3.6, -3.2}, discs.spacing = {0.9, 0.9};
    discs.jitter = 0.05, discs.seed = 8, discs.radius_range = RadiusRange{0.25, 0.4};
    discs.body.material = rough;
    add_lattice(scene, discs);
    scene.add({.type = BodyType::kinematic_body,
               .shape = Segment{{-0.5, 0}, {0.5, 0.3}},
               .position = {0, 4.5},
               .velocity = {0.3, -1},
               .material = rough});
    scene.add({.type = BodyType::static_body, .shape = Chain{.points = {{-9, -9}, {0, -9.5}, {9, -9}}}});
    scene.add({.shape = Disc{0.5}, .position = {0.1, -8.5}, .material = rough});
    return scene;
}

/// Discs on a floor that fall asleep and are woken by one that drops among them.
Scene woken_sleepers() {
    Scene scene;
    scene.name = "woken sleepers";
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {20, 20}, .material = {.friction = 0.5}};
    scene.effects.sleep = true;
    for (int i = 0; i < 30; ++i) {
        const double radius = 0.3 + 0.01 * (i % 5);
        scene.add({.shape = Disc{radius},
                   .position = {0.7 + 0.64 * i, radius},
                   .material = {.friction = 0.4, .rolling_resistance = 0.05}});
    }
    scene.add({.shape = Disc{0.5}, .position = {10.1, 7.3}, .material = {.friction = 0.4}});
    return scene;
}

std::vector<Scene> scenes() {
    return {woken_sleepers(),   rolling_sizes(), gas(400, {0.5, 0.5}, 1), falling_sizes(),
            moving_obstacles(), stack_at_rest(), rough_sizes(),           turning_chain()};
}

template <class Real>
std::uint64_t hash_after(const Scene& scene, int steps, const WorldOptions& options) {
    BasicWorld<Real> world(scene, options);
    for (int i = 0; i < steps; ++i) world.step(kStep);
    return world.state_hash();
}

constexpr int kSteps = 90;

struct Golden {
    const char* scene;
    std::uint64_t single_precision, double_precision;
};
constexpr Golden kGolden[] = {
    {"gas", 0x680b8eec4001de52, 0x87bedad9b790c353},
    {"falling sizes", 0x4fe0c9b61ea50e9c, 0xc84f698047eb650e},
    {"moving obstacles", 0x9450532e75523df8, 0x81f8d27062c9d725},
    {"stack at rest", 0xa436021f760768ad, 0xfd75b447dc578a50},
    {"rough sizes", 0xe205a815944fe984, 0x23ea3ec6377d430c},
    {"rolling sizes", 0x3c3992b72d7e76e5, 0x32b2ce6148eb257d},
    {"turning chain", 0xa170b92b5d1fd58a, 0x9c0312f4b30d2d38},
    {"woken sleepers", 0x6ab2e75856d9e0e5, 0x3a95da24a3804626},
};

}  // namespace

TEST_SUITE("determinism/same bits") {
    TEST_CASE_TEMPLATE("every instruction set and a rerun give the same bits", Real, float, double) {
        for (const Scene& scene : scenes()) {
            CAPTURE(scene.name);
            const std::uint64_t expected = hash_after<Real>(scene, kSteps, {.isa = "scalar", .threads = 1});
            for (const std::string& isa : runnable_instruction_sets()) {
                CAPTURE(isa);
                CHECK(hash_after<Real>(scene, kSteps, {.isa = isa, .threads = 1}) == expected);
            }
        }
    }

    TEST_CASE_TEMPLATE("1, 2, 3 and 7 threads, and an embedding program's own, give the same bits", Real,
                       float, double) {
        Scene scene;
        SUBCASE("solver impulse") {
            scene = gas(40'000, {0.5, 0.5}, 0.9);  // enough rows for threads to be used
            scene.gravity = {0, -1};
            scene.bodies[9].angular_velocity = 1;
        }
        SUBCASE("solver soft") {
            scene = gas(12'000, {0.4, 0.6}, 0.2);
            scene.gravity = {0, -30};
            for (Body& body : scene.bodies) body.material.friction = 0.5;
        }
        const int steps = test::scaled(12, 4);
        const std::uint64_t expected = hash_after<Real>(scene, steps, {.threads = 1});
        for (const int threads : {2, 3, 7}) {
            CAPTURE(threads);
            CHECK(hash_after<Real>(scene, steps, {.threads = threads}) == expected);
        }
        std::size_t tasks_run = 0;
        WorldOptions own{.threads = 2};
        own.parallel_for = [&](std::size_t count, const std::function<void(std::size_t)>& task) {
            const std::size_t half = count / 2;
            std::thread other([&] {
                for (std::size_t i = 0; i < half; ++i) task(i);
            });
            for (std::size_t i = count; i-- > half;) task(i);
            other.join();
            tasks_run += count;
        };
        CHECK(hash_after<Real>(scene, steps, own) == expected);
        CHECK(tasks_run > 0);
    }

    TEST_CASE_TEMPLATE("effects that are on but zero-valued, and the ledger, change no bit", Real, float,
                       double) {
        int gravity = 0, drag = 0, rotation = 0, restitution = 0, rolling = 0;  // in so many scenes
        for (const Scene& scene : scenes()) {
            CAPTURE(scene.name);
            const Effects own = call_effects(scene, {}).effects;
            REQUIRE_FALSE(own.ledger);
            WorldOptions on{.threads = 1, .effects = {.ledger = true}};
            // Only what the scene has not is zero-valued: what it has is on in both.
            const auto force = [](bool has, std::optional<bool>& wish, int& count) {
                if (!has) wish = true, ++count;
            };
            force(own.gravity, on.effects.gravity, gravity), force(own.drag, on.effects.drag, drag);
            force(own.rotation, on.effects.rotation, rotation);
            force(own.restitution, on.effects.restitution, restitution);
            if (own.friction) force(own.rolling_resistance, on.effects.rolling_resistance, rolling);
            CHECK(hash_after<Real>(scene, kSteps, on) == hash_after<Real>(scene, kSteps, {.threads = 1}));
        }
        for (const int count : {gravity, drag, rotation, restitution, rolling}) CHECK(count > 0);
    }

    TEST_CASE("the golden hashes hold in every build") {
        for (const Scene& scene : scenes()) {
            CAPTURE(scene.name);
            const std::uint64_t single = hash_after<float>(scene, kSteps, {.threads = 1});
            const std::uint64_t twice = hash_after<double>(scene, kSteps, {.threads = 1});
            test::report(std::hex, "{\"", scene.name, "\", 0x", single, ", 0x", twice, "},");
            const auto* golden = std::find_if(std::begin(kGolden), std::end(kGolden),
                                              [&](const Golden& g) { return g.scene == scene.name; });
            REQUIRE(golden != std::end(kGolden));
            CHECK(single == golden->single_precision);
            CHECK(twice == golden->double_precision);
        }
    }
}
