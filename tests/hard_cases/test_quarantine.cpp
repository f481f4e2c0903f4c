// B21 of docs/hard-cases.md, what no check at the door can see: a body whose state leaves the limits while it
// runs is disabled where it was, is reported, and its neighbours never know.
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <cmath>
#include <vector>

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// Neighbours in a box that is open at the top.
Scene neighbours() {
    Scene scene = gas_scene({.count = 120, .packing_fraction = 0.15, .restitution = 0.95});
    scene.gravity = {0, -9};
    scene.walls->top = false;
    return scene;
}

template <class Real>
bool same_bits(const BasicWorld<Real>& a, const BasicWorld<Real>& b, std::size_t bodies) {
    for (std::uint32_t i = 0; i < bodies; ++i) {
        const BodyState p = a.state({i, 0}), q = b.state({i, 0});
        if (!(p.position == q.position) || !(p.velocity == q.velocity)) return false;
    }
    return true;
}

struct Rogue {
    const char* why;
    Body body;
    int steps;  // until it is gone
};

std::vector<Rogue> rogues() {
    Body far = disc(0.5, 1, {0, 0.9999e8}, {0, 1e5}, 1);
    Body fast = disc(0.5, 1, {0, 9e7}, {0, 9e6}, 1);
    Body slow = disc(1e-3, 1e-9, {0.3, 200}, {0, 0.99e7}, 1);
    return {{"far out", far, 7}, {"fast, far out", fast, 70}, {"fast, from close by", slow, 700}};
}

}  // namespace

TEST_SUITE("hard cases/quarantine") {
    TEST_CASE_TEMPLATE(
        "a body that leaves the limits is disabled where it was, and its neighbours keep their bits", Real,
        float, double) {
        const Scene without = neighbours();
        for (const Rogue& rogue : rogues()) {
            CAPTURE(rogue.why);
            Scene with = without;
            const BodyId id = with.add(rogue.body);
            BasicWorld<Real> world(with, {.effects = {.ledger = true}}), reference(without);
            int gone_after = -1;
            for (int i = 0; i < rogue.steps + 60; ++i) {
                world.step(kStep);
                reference.step(kStep);
                if (gone_after < 0 && !world.quarantined().empty()) gone_after = i;
            }
            CHECK(same_bits(world, reference, without.bodies.size()));
            CHECK(gone_after >= 0);
            REQUIRE(world.quarantined().size() == 1);
            CHECK(world.quarantined()[0] == id);
            CHECK(world.profile().quarantined == 1);
            const BodyState state = world.state(id);
            CHECK(std::abs(state.position.y) <= kLargestPosition);
            CHECK(state.velocity == Vec2{0, 0});
            CHECK(world.body_count() == with.bodies.size());
            CHECK(std::isfinite(world.ledger().energy.total()));
        }
    }

    TEST_CASE_TEMPLATE("a body that gravity makes too fast is disabled, and the others go on", Real, float,
                       double) {
        Scene scene;
        scene.gravity = {0, -1e6};
        scene.add(disc(0.5, 1, {0, 0}, {0, -0.999e7}));
        scene.add(disc(0.5, 1, {10, 0}, {0, 0.9e7}));
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 60; ++i) world.step(kStep);
        REQUIRE(world.quarantined().size() == 1);
        CHECK(world.quarantined()[0] == BodyId{0, 0});
        // In float each substep rounds what gravity adds to ten million metres a second.
        CHECK(world.state({1, 0}).velocity.y == doctest::Approx(8e6).epsilon(1e-3));
    }

    TEST_CASE_TEMPLATE("a disabled body is in nobody's way, and can be removed", Real, float, double) {
        Scene scene;
        const BodyId rogue = scene.add(disc(5, 1, {0.9999e8, 0}, {9e6, 0}, 1));
        const BodyId passer = scene.add(disc(5, 1, {0.9999e8 - 64, 0}, {32, 0}, 1));
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 240; ++i) world.step(kStep);
        REQUIRE(world.quarantined().size() == 1);
        CHECK(world.profile().impacts == 0);
        CHECK(world.state(passer).velocity == Vec2{32, 0});
        world.remove(rogue);
        CHECK(world.quarantined().empty());
        world.step(kStep);
        CHECK(world.body_count() == 1);
    }
}
