#include "torture/worlds/world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/body_mass.hpp"
#include "torture/random.hpp"
#include "torture/worlds/bodies.hpp"
#include "torture/worlds/group.hpp"
#include "torture/worlds/mechanisms.hpp"
#include "torture/worlds/places.hpp"

namespace carom::torture {
namespace {

Vec2 random_velocity(double speed, Random& random) {
    const double each = speed / std::numbers::sqrt2;
    return {each * random.normal(), each * random.normal()};
}

Group lone_body(const WorldTraits& traits, Random& random) {
    const double size = random_size(traits, random);
    Body body = random_body(traits, size, random);
    change_kind(body, traits, size, random);
    const double spin = traits.speed / size * random.normal() * random.uniform();
    if (body.type != BodyType::static_body && !body.fixed_rotation && random.chance(0.7))
        body.angular_velocity = spin;
    Group group;
    group.add(body);
    return group;
}

/// Whether something of it stays where it is: a drum that turns would go over it.
bool is_held_in_place(const Group& group) {
    const auto is_free = [](const Body& body) { return body.type == BodyType::dynamic_body; };
    const auto is_between_bodies = [](const Joint& joint) {
        return (joint.a && joint.b) || std::holds_alternative<GearJoint>(joint.kind);
    };
    return !std::all_of(group.bodies.begin(), group.bodies.end(), is_free) ||
           !std::all_of(group.joints.begin(), group.joints.end(), is_between_bodies);
}

Group random_group(const WorldTraits& traits, std::size_t most, Random& random) {
    constexpr std::size_t kMostOfMechanism = 40;
    for (;;) {
        Group group = most >= 2 && random.chance(traits.joined_share)
                          ? random_mechanism(traits, std::min(most, kMostOfMechanism), random)
                          : lone_body(traits, random);
        if (traits.surroundings != Surroundings::drum || !is_held_in_place(group)) return group;
    }
}

std::vector<Group> random_groups(const WorldTraits& traits, Random& random) {
    std::vector<Group> groups;
    const auto asked = static_cast<std::size_t>(traits.bodies);
    for (std::size_t bodies = 0; bodies < asked; bodies += groups.back().bodies.size())
        groups.push_back(random_group(traits, asked - bodies, random));
    return groups;
}

void put_into(Scene& scene, const Group& group, Vec2 at, const WorldTraits& traits, Random& random) {
    const Vec2 velocity = random_velocity(traits.speed, random);
    add_to(scene, placed(group, at, random.uniform(0, 2 * std::numbers::pi), velocity));
}

void add_floor(Scene& scene, const Enclosure& enclosure, const WorldTraits& traits) {
    constexpr double kWidth = 20;  // widths of the enclosure
    const Vec2 low = enclosure.low(), high = enclosure.high();
    if (traits.fence == Fence::walls) {
        scene.walls = Walls{.min = low,
                            .max = high,
                            .left = false,
                            .right = false,
                            .top = false,
                            .material = traits.material};
        return;
    }
    const double margin = kWidth * (high.x - low.x);
    Body floor;
    floor.type = BodyType::static_body, floor.material = traits.material, floor.category = kFenceCategory;
    floor.shape = Segment{{low.x - margin, low.y}, {high.x + margin, low.y}};
    scene.add(floor);
}

void surround(RandomWorld& world, const WorldTraits& traits) {
    Scene& scene = world.scene;
    world.is_closed =
        traits.surroundings == Surroundings::closed || traits.surroundings == Surroundings::drum;
    if (traits.surroundings == Surroundings::floor) add_floor(scene, world.enclosure, traits);
    if (!world.is_closed) return;
    const std::size_t first = scene.bodies.size();
    world.enclosure.add_to(scene, traits.material);
    for (std::size_t i = first; i < scene.bodies.size(); ++i) scene.bodies[i].category = kFenceCategory;
    if (traits.surroundings != Surroundings::drum) return;
    world.drum = first;
    scene.bodies[first].type = BodyType::kinematic_body;
    scene.bodies[first].angular_velocity = traits.drum_speed;
}

/// Where a body has no potential energy: as low as it can be in what is closed, else where it starts.
double lowest_of_body(const Body& body, const RandomWorld& world) {
    if (!world.is_closed) return body.position.y;
    const Disc* disc = std::get_if<Disc>(&body.shape);
    if (!world.drum) return world.enclosure.lowest_centre(disc ? disc->radius : 0);
    const Vec2 low = world.enclosure.low(), high = world.enclosure.high();  // it turns about (0, 0)
    return -std::hypot(std::fmax(-low.x, high.x), std::fmax(-low.y, high.y));
}

/// Where a rod holds a body of the scene or the world [m].
Vec2 end_of_rod(const Scene& scene, const std::optional<BodyId>& id, Vec2 anchor) {
    if (!id) return anchor;
    const Body& body = scene.bodies[id->index];
    const double cos = std::cos(body.angle), sin = std::sin(body.angle);
    return {body.position.x + cos * anchor.x - sin * anchor.y,
            body.position.y + sin * anchor.x + cos * anchor.y};
}

/// Whether a joint is a rod, which is drawn no shorter than a tenth of the world's unit, whose ends stand
/// nearer or farther than it keeps them: closing it lifts what hangs on it.
bool begins_open(const Scene& scene, const Joint& joint) {
    constexpr double kRoundOff = 1e-9;  // of the distance
    const auto* rod = std::get_if<DistanceJoint>(&joint.kind);
    if (!rod) return false;
    const Vec2 a = end_of_rod(scene, joint.a, rod->anchor_a), b = end_of_rod(scene, joint.b, rod->anchor_b);
    const double now = std::hypot(b.x - a.x, b.y - a.y);
    const double least = rod->length.value_or(rod->min.value_or(0)),
                 most = rod->length.value_or(rod->max.value_or(now));
    return now * (1 + kRoundOff) < least || now > most * (1 + kRoundOff);
}

EnergySources sources_of(const Scene& scene, const WorldTraits& traits) {
    EnergySources sources;
    for (const Body& body : scene.bodies) {
        sources.drives |= body.type == BodyType::kinematic_body;
        sources.falls |= body.sensor && body.type == BodyType::dynamic_body;  // through what is closed
    }
    for (const Joint& joint : scene.joints) sources.joints |= has_own_force(joint);
    const bool is_stretched = (traits.are_joints_stretched && !scene.joints.empty()) ||
                              std::any_of(scene.joints.begin(), scene.joints.end(),
                                          [&](const Joint& joint) { return begins_open(scene, joint); });
    sources.joints |= is_stretched;
    sources.overlaps = traits.is_crowded || is_stretched || sources.drives || sources.joints;
    sources.falls |= traits.surroundings == Surroundings::open || traits.surroundings == Surroundings::floor;
    return sources;
}

void settings_of(Scene& scene, const WorldTraits& traits) {
    scene.gravity = {0, -traits.gravity};
    scene.drag = traits.drag;
    scene.step.dt = traits.dt;
    scene.effects.ledger = true;
    if (traits.sleeps) scene.effects.sleep = true;
    scene.accuracy.substeps = traits.substeps, scene.accuracy.iterations = traits.iterations;
}

}  // namespace

RandomWorld random_world(const WorldTraits& traits) {
    Random random(traits.seed ^ 0xA24BAED4963EE407u, traits.index);  // others than those of the traits
    const std::vector<Group> groups = random_groups(traits, random);
    std::vector<double> radii;
    for (const Group& group : groups) radii.push_back(reach_of(group));
    Places places = places_for(radii, traits, random);
    RandomWorld world{.scene = {}, .enclosure = std::move(places.enclosure), .lowest = {}, .sources = {}};
    settings_of(world.scene, traits);
    for (std::size_t i = 0; i < groups.size(); ++i)
        put_into(world.scene, groups[i], places.at[i], traits, random);
    surround(world, traits);
    world.sources = sources_of(world.scene, traits);
    for (const Body& body : world.scene.bodies) {
        world.lowest.push_back(lowest_of_body(body, world));
        if (body.type == BodyType::dynamic_body)
            world.least_energy += 0.5 * tool::mass_of(body) * traits.unit * traits.unit;
    }
    return world;
}

}  // namespace carom::torture
