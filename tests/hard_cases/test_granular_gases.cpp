// B31 of docs/hard-cases.md: gases that cool come together in crowds, and no step of them is long.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>

#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

namespace test_granular_gases {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;
constexpr std::int64_t kDiscs = 1000, kSteps = 1000;
/// What a step may have of the work of the first one.
constexpr double kMostOfFirst = 10;

/// Work of the last step, in units of about 10 ns (docs/how-a-step-works.md, steps that end early): an impact
/// is 32, a contact in a sweep one, a body in a stage one. Substeps have two sweeps and one stage at least.
double work_of(const Profile& before, const Profile& now, int substeps) {
    return 32 * static_cast<double>(now.impacts - before.impacts) +
           substeps * (2 * static_cast<double>(now.contacts) + static_cast<double>(kDiscs));
}

}  // namespace

TEST_SUITE("hard cases/granular gases") {
    TEST_CASE("B31: of a gas that cools no step has ten times the work of the first one") {
        int number = 0;
        for (const double friction : {0.0, 0.3})
            for (const double restitution : {0.1, 0.3, 0.5, 0.7, 0.9, 0.95}) {
                if (number++ % scaled(1, 5) > 0) continue;
                CAPTURE(friction);
                CAPTURE(restitution);
                Scene scene = gas_scene({.count = kDiscs,
                                         .packing_fraction = 0.4,
                                         .velocity_rms = 1,
                                         .restitution = restitution});
                for (Body& body : scene.bodies) body.material.friction = friction;
                scene.walls->material.friction = friction;
                World world(scene, {.threads = 1});
                const int substeps = world.plan().substeps;
                const double start = world.ledger().energy.total();
                double first = 0, most = 0;
                std::int64_t contacts = 0;
                Profile before = world.profile();
                for (int i = 0; i < kSteps; ++i) {
                    world.step(kStep);
                    const Profile now = world.profile();
                    const double work = work_of(before, now, substeps);
                    if (i == 0) first = work;
                    most = std::max(most, work), contacts = std::max(contacts, now.contacts);
                    before = now;
                }
                report("gas, restitution ", restitution, ", friction ", friction, ": most work of a step ",
                       most / first, " of the first, impacts ", before.impacts, ", contacts at most ",
                       contacts, ", energy left ", world.ledger().energy.total() / start);
                CHECK(most <= kMostOfFirst * first);
                // Discs that touch are a plane graph: 3 N edges at most, and as many near misses.
                CHECK(contacts <= 6 * kDiscs);
                CHECK(world.ledger().energy.total() < 0.5 * start);  // it has cooled
                CHECK(before.impacts > kDiscs);
            }
    }
}

}  // namespace test_granular_gases
