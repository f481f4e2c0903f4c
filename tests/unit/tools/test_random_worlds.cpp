// Random worlds of `carom torture`: what is drawn is a scene that the engine takes, the same every time, and
// everything there is comes up.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "torture/worlds/traits.hpp"
#include "torture/worlds/world.hpp"

namespace test_random_worlds {

namespace {

using namespace carom;
using namespace carom::torture;

constexpr std::uint64_t kWorlds = 300;

RandomWorld world_of(std::uint64_t seed, std::uint64_t index, std::int64_t most_bodies = 60) {
    return random_world(world_traits(seed, index, most_bodies));
}

std::uint64_t hash_of(const RandomWorld& world) {
    return World64(world.scene, {.threads = 1}).state_hash();
}

TEST_CASE("random worlds are scenes that are accepted, with all bodies inside what is closed") {
    for (std::uint64_t index = 0; index < kWorlds; ++index) {
        CAPTURE(index);
        const RandomWorld world = world_of(1, index);
        const auto problem = world.scene.find_problem();
        CHECK_MESSAGE(!problem, (problem ? problem->statement : std::string()));
        CHECK(world.lowest.size() == world.scene.bodies.size());
        for (std::size_t i = 0; world.is_closed && i < world.scene.bodies.size(); ++i) {
            const Body& body = world.scene.bodies[i];
            if (body.type != BodyType::dynamic_body) continue;
            CHECK(world.enclosure.clearance(body.position) > 0);
            CHECK(body.position.y >= world.lowest[i]);
        }
    }
}

TEST_CASE("a random world is made of its seed and index alone") {
    std::set<std::uint64_t> hashes;
    for (std::uint64_t index = 0; index < 50; ++index) {
        const std::uint64_t hash = hash_of(world_of(3, index));
        CHECK(hash == hash_of(world_of(3, index)));
        hashes.insert(hash);
    }
    CHECK(hashes.size() == 50);
    CHECK(hash_of(world_of(4, 7)) != hash_of(world_of(3, 7)));
}

// A rod is drawn no shorter than a tenth of the world's unit, though its ends may stand nearer: what it
// parts, it lifts, which the judge of energy took for a gain of a passive world.
TEST_CASE("joints that begin open are sources of energy") {
    std::size_t open = 0;
    const auto look = [&](std::uint64_t seed, std::uint64_t index) {
        CAPTURE(index);
        const RandomWorld world = world_of(seed, index, 400);
        if (world.scene.joints.empty()) return;
        const JointErrors errors = World64(world.scene, {.threads = 1}).joint_errors();
        if (!(errors.max > 1e-6 * world_traits(seed, index, 400).unit)) return;
        ++open;
        CHECK((world.sources.joints && world.sources.overlaps));
    };
    for (std::uint64_t index = 0; index < kWorlds; ++index) look(1, index);
    look(201, 8118);  // two discs, one of which a rod holds .4 m beside its other end, .02 m too far
    CHECK(open > 1);
}

TEST_CASE("all shapes, kinds of bodies and kinds of joints come up in random worlds") {
    std::set<std::size_t> shapes, joints;
    std::set<BodyType> types;
    bool has_sensor = false, has_filter = false, breaks = false, turns = false, is_passive = false;
    for (std::uint64_t index = 0; index < kWorlds; ++index) {
        const RandomWorld world = world_of(1, index);
        for (const Body& body : world.scene.bodies) {
            shapes.insert(body.shape.index()), types.insert(body.type);
            has_sensor |= body.sensor, has_filter |= body.mask != kDefaultMask;
        }
        for (const Joint& joint : world.scene.joints)
            joints.insert(joint.kind.index()), breaks |= joint.break_force < 1e300;
        turns |= world.drum.has_value();
        is_passive |= !world.sources.drives && !world.sources.joints && !world.sources.overlaps;
    }
    CHECK(shapes.size() == std::variant_size_v<Shape>);
    CHECK(joints.size() == std::variant_size_v<JointKind>);
    CHECK(types.size() == 3);
    CHECK((has_sensor && has_filter && breaks && turns && is_passive));
}

}  // namespace

}  // namespace test_random_worlds
