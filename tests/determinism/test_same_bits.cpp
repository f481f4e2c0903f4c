// B28 of docs/hard-cases.md: the same scene gives the same bits on rerun, for every instruction set and any
// number of threads, in every build. The hashes below hold for gcc and clang, release and debug; those in
// tests/embed/main.cpp are also checked with gcc and no optimisation. To print new ones after a change that
// is meant to change them:
//   CAROM_TEST_FIGURES=1 build/release/bin/carom_tests --test-case="*golden*"
#include <carom/carom.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "determinism/golden_scenes.hpp"
#include "scene/call_effects.hpp"
#include "support/box_scenes.hpp"
#include "support/effort.hpp"

#include <doctest/doctest.h>

namespace test_same_bits {

using namespace carom;
using namespace carom::test;

namespace {

constexpr int kSteps = 90;

constexpr Golden kGolden[] = {
    {"mixed shapes", 0xd77d4afbd902c77f, 0x25bec3e9a4fd83ed},
    {"bouncing crowd", 0x32f5cf7cf7591ae8, 0x5d0e0f7fea4c8122},
    {"rough gas", 0xc009256aceff94e4, 0xb74961daf77a2622},
    {"gas", 0x680b8eec4001de52, 0x87bedad9b790c353},
    {"falling sizes", 0x4fe0c9b61ea50e9c, 0xc84f698047eb650e},
    {"moving obstacles", 0x9450532e75523df8, 0x81f8d27062c9d725},
    {"stack at rest", 0xa436021f760768ad, 0xfd75b447dc578a50},
    {"rough sizes", 0x978ce39c4b2a828d, 0x47a831af8e9e43fa},
    {"rolling sizes", 0xdd32abbb7b454e76, 0xd5c23181496b0a46},
    {"turning chain", 0x23d48a3c8e08a612, 0x279669f7e07a9a72},
    {"woken sleepers", 0x77fa00849de7a9ee, 0xe5c36c16593eee67},
    {"falling compounds", 0x3fba9fac5562a5f8, 0xbbafc864b2858d77},
    {"discs about one place", 0x42b99e272e415c71, 0x064f8cc5da90374b},
    {"uneven discs about one place", 0x73f23059a3b733ca, 0x330bfe60ec193eba},
};

}  // namespace

TEST_SUITE("determinism/same bits") {
    TEST_CASE_TEMPLATE("every instruction set and a rerun give the same bits", Real, float, double) {
        for (const Scene& scene : golden_scenes()) {
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
        SUBCASE("solver impulse with friction") {
            scene = gas(40'000, {0.5, 0.5}, 1);
            for (Body& body : scene.bodies) body.material.friction = 0.5;
        }
        SUBCASE("solver soft") {
            scene = gas(12'000, {0.4, 0.6}, 0.2);
            scene.gravity = {0, -30};
            for (Body& body : scene.bodies) body.material.friction = 0.5;
        }
        SUBCASE("solver soft with boxes") {
            scene = box_pyramid(90);
        }
        SUBCASE("solver soft with what bounces") {
            scene = gas(12'000, {0.4, 0.6}, 0.6);
            scene.accuracy.solver = Solver::soft;
            for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
                Material& material = scene.bodies[i].material;
                material.restitution = 0.3 + 0.1 * static_cast<double>(i % 8);
                material.friction = i % 3 == 0 ? 0 : 0.4;
            }
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
        for (const Scene& scene : golden_scenes()) {
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
            if (own.friction && World(scene).plan().solver == "soft")
                force(own.rolling_resistance, on.effects.rolling_resistance, rolling);
            CHECK(hash_after<Real>(scene, kSteps, on) == hash_after<Real>(scene, kSteps, {.threads = 1}));
        }
        for (const int count : {gravity, drag, rotation, restitution, rolling}) CHECK(count > 0);
    }

    TEST_CASE("the golden hashes hold in every build") {
        for (const Scene& scene : golden_scenes()) check_golden(scene, kGolden, kSteps);
    }
}

}  // namespace test_same_bits
