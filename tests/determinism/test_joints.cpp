// B28 of docs/hard-cases.md for joints: the same bits in every build, for every instruction set, any number
// of threads, and after a snapshot. New hashes are printed as those of test_same_bits.cpp are.
#include "determinism/golden_scenes.hpp"
#include "support/joints.hpp"
#include "support/ragdoll.hpp"

#include <optional>
#include <string>

#include <doctest/doctest.h>

namespace test_joints {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

constexpr int kSteps = 60;

/// Mechanisms of two kinds, more of one than are swept side by side, which fall on a floor and each other.
Scene crowd_of_ragdolls() {
    Scene scene;
    scene.name = "crowd of ragdolls", scene.gravity = {0, -10};
    scene.walls.emplace();
    scene.walls->max = {4.2, 100}, scene.walls->top = false;
    for (int i = 0; i < 28; ++i)
        add_ragdoll(scene, {0.6 * (i % 7) + 0.3, 1.2 + 1.9 * (i / 7)}, 0.02 * (i % 5), -1 - i,
                    {.has_limits = i % 3 != 0});
    return scene;
}

/// Ropes of two lengths that hang on the world, and one on a static body, through which boxes fall.
Scene crowd_of_ropes() {
    Scene scene;
    scene.name = "crowd of ropes", scene.gravity = {0, -10};
    for (int rope = 0; rope < 21; ++rope) {
        std::optional<BodyId> last;
        if (rope == 20)
            last = scene.add({.type = BodyType::static_body, .shape = Box{0.2, 0.2}, .position = {16, 0.4}});
        for (int i = 0; i < 10 + rope % 2; ++i) {
            const BodyId link =
                scene.add({.shape = Box{0.1, 0.6}, .position = {0.8 * rope, -0.6 * i}, .group = -1});
            scene.add(Joint{
                .a = last, .b = link, .kind = RevoluteJoint{.anchor = Vec2{0.8 * rope, 0.3 - 0.6 * i}}});
            last = link;
        }
    }
    for (int i = 0; i < 20; ++i)
        scene.add({.shape = Box{0.5, 0.4},
                   .position = {0.4 + 0.8 * i, 0.6},
                   .angle = 0.3 * i,
                   .velocity = {2.0 - 0.2 * i, -2}});
    return scene;
}

/// Cars on suspensions, of which one has a slider on it with a motor and ends, that fall on a floor.
Scene crowd_of_cars() {
    Scene scene;
    scene.name = "crowd of cars", scene.gravity = {0, -10};
    scene.walls.emplace();
    scene.walls->max = {80, 100}, scene.walls->top = false;
    for (int i = 0; i < 19; ++i) {
        const Vec2 at{3 + 4.0 * i, 1.5 + 0.1 * (i % 3)};
        const BodyId chassis = scene.add({.shape = Box{3, 0.6}, .position = at, .angle = 0.03 * (i % 4)});
        for (const double side : {-1.1, 1.1}) {
            const BodyId wheel = scene.add({.shape = Disc{0.4}, .position = {at.x + side, at.y - 0.5}});
            scene.add(Joint{.a = chassis,
                            .b = wheel,
                            .kind = WheelJoint{.frequency = 2.0 + 0.3 * i,
                                               .damping_ratio = 0.5,
                                               .motor_speed = -10,
                                               .max_motor_torque = i % 2 == 0 ? 5.0 : 0.0}});
        }
        if (i % 3 != 0) continue;
        const BodyId mast = scene.add({.shape = Box{0.2, 1}, .position = {at.x, at.y + 1}});
        scene.add(Joint{
            .a = chassis,
            .b = mast,
            .kind = PrismaticJoint{
                .axis = {0.2, 1}, .lower = -0.1, .upper = 0.4, .motor_speed = 1, .max_motor_force = 40}});
    }
    return scene;
}

std::vector<Scene> scenes_with_joints() {
    Scene every = every_joint(), chain = weighted_chain(10, 100, {1, 0}), net = hanging_net(12);
    Scene grid = net, hinges = net;
    every.name = "every joint", chain.name = "weighted chain", net.name = "net of rods";
    grid.name = "net of rods beside centres", hinges.name = "net of hinges";
    for (Joint& joint : grid.joints) std::get<DistanceJoint>(joint.kind).anchor_b = {0.05, 0.02};
    for (Joint& joint : hinges.joints) joint.kind = RevoluteJoint{};
    return {every, chain, net, grid, hinges, crowd_of_ragdolls(), crowd_of_ropes(), crowd_of_cars()};
}

constexpr Golden kGolden[] = {
    {"every joint", 0x404322d894b95cfc, 0x54bad1f3d9453b9f},
    {"weighted chain", 0xe7a214c17be4a80c, 0x949dfc6291b5ce2b},
    {"net of rods", 0x3b2bf1596fc0c671, 0x0cc473225a7d37df},
    {"net of rods beside centres", 0xaf184cf7d115621, 0x20acc8a1a91d08aa},
    {"net of hinges", 0xb085cbbfb070441c, 0xfe93b67ab4b2f330},
    {"crowd of ragdolls", 0xe0ece86f63d8566b, 0xb8181e692c2578bf},
    {"crowd of ropes", 0xf385cf2c85878daa, 0x8dd42173a70ce987},
    {"crowd of cars", 0x2e264d316aaaf528, 0x4dc12466dbb9ab63},
};

}  // namespace

TEST_SUITE("determinism: joints") {
    TEST_CASE_TEMPLATE("joints give the same bits for every instruction set and number of threads", Real,
                       float, double) {
        for (const Scene& scene : scenes_with_joints()) {
            const std::uint64_t expected = hash_after<Real>(scene, kSteps, {.isa = "scalar", .threads = 1});
            for (const std::string& isa : runnable_instruction_sets()) {
                CAPTURE(isa);
                CHECK(hash_after<Real>(scene, kSteps, {.isa = isa, .threads = 2}) == expected);
            }
            for (const int threads : {3, 7}) {
                CAPTURE(threads);
                CHECK(hash_after<Real>(scene, kSteps, {.threads = threads}) == expected);
            }
        }
    }

    TEST_CASE("the golden hashes of joints hold in every build") {
        for (const Scene& scene : scenes_with_joints()) check_golden(scene, kGolden, kSteps);
    }

    TEST_CASE("a large net gives the same bits on one thread and on three") {
        const Scene scene = hanging_net(100);
        const std::uint64_t expected = hash_after<float>(scene, 20, {.threads = 1});
        CHECK(hash_after<float>(scene, 20, {.threads = 2}) == expected);
        CHECK(hash_after<float>(scene, 20, {.threads = 3}) == expected);
    }

    TEST_CASE_TEMPLATE("a world with joints goes on from a snapshot to the same bits", Real, float, double) {
        for (const Scene& scene : scenes_with_joints()) {
            BasicWorld<Real> world(scene);
            for (int i = 0; i < 45; ++i) world.step(kStep);
            std::vector<std::byte> state(world.state_bytes());
            world.save_state(state);
            Scene other;
            BasicWorld<Real> again(other);
            again.restore_state(state);
            for (int i = 0; i < 45; ++i) world.step(kStep), again.step(kStep);
            CHECK(world.state_hash() == again.state_hash());
            CHECK(world.joint_count() == again.joint_count());
        }
    }
}

}  // namespace test_joints
