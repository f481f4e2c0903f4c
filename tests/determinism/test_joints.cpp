// B28 of docs/hard-cases.md for joints: the same bits for every instruction set, any number of threads, and
// after a snapshot.
#include "support/joints.hpp"

#include <string>

#include <doctest/doctest.h>

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

template <class Real>
std::uint64_t hash_after(const Scene& scene, int steps, const WorldOptions& options) {
    BasicWorld<Real> world(scene, options);
    for (int i = 0; i < steps; ++i) world.step(kStep);
    return world.state_hash();
}

std::vector<Scene> scenes_with_joints() {
    Scene grid = hanging_net(12);
    for (Joint& joint : grid.joints) std::get<DistanceJoint>(joint.kind).anchor_b = {0.05, 0.02};
    Scene hinges = hanging_net(12);
    for (Joint& joint : hinges.joints) joint.kind = RevoluteJoint{};
    return {every_joint(), weighted_chain(10, 100, {1, 0}), hanging_net(12), grid, hinges};
}

}  // namespace

TEST_SUITE("determinism: joints") {
    TEST_CASE_TEMPLATE("joints give the same bits for every instruction set and number of threads", Real,
                       float, double) {
        for (const Scene& scene : scenes_with_joints()) {
            const std::uint64_t expected = hash_after<Real>(scene, 60, {.isa = "scalar", .threads = 1});
            for (const std::string& isa : runnable_instruction_sets()) {
                CAPTURE(isa);
                CHECK(hash_after<Real>(scene, 60, {.isa = isa, .threads = 2}) == expected);
            }
            for (const int threads : {3, 7}) {
                CAPTURE(threads);
                CHECK(hash_after<Real>(scene, 60, {.threads = threads}) == expected);
            }
        }
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
