#include "torture/worlds/traits.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "measure/text.hpp"
#include "torture/random.hpp"
#include "torture/runs.hpp"

namespace carom::torture {
namespace {

using measure::format;

constexpr double kFewestOfWorld = 1, kMostOfWorld = 400;    // bodies
constexpr double kShortest = 1. / 240, kLongest = 1. / 20;  // s, of a step
constexpr std::array kAllShapes{ShapeKind::disc, ShapeKind::box, ShapeKind::capsule, ShapeKind::polygon,
                                ShapeKind::compound};

/// Every octave from 1 to 400 is there; half of the worlds have fewer than 9, one in ten more than 100.
std::int64_t bodies_of_world(Random& random) {
    return static_cast<std::int64_t>(random.skewed(kFewestOfWorld, kMostOfWorld, 1.5));
}

void draw_shapes(WorldTraits& traits, Random& random) {
    if (random.chance(0.3)) return;  // discs, which every solver knows
    traits.shapes.clear();
    const double share = random.uniform(0.2, 0.9);
    for (const ShapeKind kind : kAllShapes)
        if (random.chance(share)) traits.shapes.push_back(kind);
    if (traits.shapes.empty()) traits.shapes.push_back(random.one_of<ShapeKind>(kAllShapes));
}

void draw_sizes(WorldTraits& traits, Random& random) {
    traits.unit = random.log_uniform(1e-3, 1e3);
    traits.density = random.log_uniform(1e-3, 1e3);
    const double size_ratio = random.log_uniform(1.5, 1e3), mass_ratio = random.log_uniform(10, 1e6);
    if (random.chance(0.6)) traits.size_ratio = random.chance(0.5) ? 3 : size_ratio;
    if (random.chance(0.4)) traits.mass_ratio = mass_ratio;
    traits.fill = random.log_uniform(0.03, 0.5);
    traits.is_crowded = random.chance(0.2);
}

void draw_materials(WorldTraits& traits, Random& random) {
    constexpr std::array kOfRestitution{0., 0., 0.1, 0.3, 0.5, 0.8, 0.95, 1.};
    constexpr std::array kOfFriction{0., 0., 0.1, 0.5, 0.5, 1., 10.};
    constexpr std::array kOfRolling{0., 0., 0., 0.01, 0.1, 1.};
    traits.material.restitution = random.one_of<double>(kOfRestitution);
    traits.material.friction = random.one_of<double>(kOfFriction);
    traits.material.rolling_resistance = random.one_of<double>(kOfRolling);
    traits.has_many_materials = random.chance(0.3);
}

/// @param wildness  chance of each: some worlds have none of these, some nearly all
void draw_kinds_of_bodies(WorldTraits& traits, double wildness, Random& random) {
    const auto share = [&](double most) {
        const double value = random.uniform(0.02, most);
        return random.chance(wildness) ? value : 0;
    };
    traits.fixed_share = share(0.3);
    traits.kinematic_share = share(0.2);
    traits.sensor_share = share(0.2);
    traits.fixed_rotation_share = share(0.5);
    traits.has_filters = random.chance(0.5 * wildness);
}

void draw_joints(WorldTraits& traits, double wildness, Random& random) {
    const double joined = random.uniform(0.2, 1);
    if (random.chance(0.2 + 0.5 * wildness)) traits.joined_share = joined;
    traits.has_springs = random.chance(wildness);
    traits.has_motors = random.chance(wildness);
    traits.are_joints_stretched = random.chance(0.3 * wildness);
    traits.can_break = random.chance(0.4 * wildness);
}

void draw_forces(WorldTraits& traits, double wildness, Random& random) {
    const double strength = random.chance(0.8) ? 1 : random.log_uniform(0.1, 30);
    if (random.chance(0.7)) traits.gravity = kGravity * traits.unit * strength;
    const double linear = random.log_uniform(0.01, 100), angular = random.log_uniform(0.01, 100);
    if (random.chance(0.4 * wildness)) traits.drag.linear = linear;
    if (random.chance(0.4 * wildness)) traits.drag.angular = angular;
    const double speed = traits.unit * random.log_uniform(0.3, 30);
    traits.speed = random.chance(0.2) ? 0 : speed;
}

void draw_surroundings(WorldTraits& traits, double wildness, Random& random) {
    traits.fence = random.one_of<Fence>(std::array{Fence::walls, Fence::segments, Fence::chain});
    traits.sides = 3 + static_cast<int>(random.below(6));
    const double turning = (random.chance(0.5) ? 1 : -1) * random.log_uniform(0.1, 10);
    if (random.chance(0.15)) traits.surroundings = Surroundings::floor;
    if (random.chance(0.1)) traits.surroundings = Surroundings::open;
    if (!random.chance(0.3 * wildness)) return;
    traits.surroundings = Surroundings::drum, traits.fence = Fence::chain, traits.drum_speed = turning;
}

void draw_steps(WorldTraits& traits, double wildness, Random& random) {
    traits.dt = random.log_uniform(kShortest, kLongest);
    const double longest = random.uniform(traits.dt, kLongest);
    if (random.chance(0.25)) traits.dt_ratio = longest / traits.dt;
    traits.sleeps = random.chance(0.3);
    const int substeps = 1 + static_cast<int>(random.below(12)),
              iterations = 1 + static_cast<int>(random.below(6));
    if (random.chance(0.3 * wildness)) traits.substeps = substeps;
    if (random.chance(0.2 * wildness)) traits.iterations = iterations;
    traits.precision = random.chance(0.6) ? Precision::single_ : Precision::double_;
    traits.is_restored = random.chance(0.25);
}

std::string shapes_in_words(const WorldTraits& traits) {
    constexpr std::array kNames{"disc", "box", "capsule", "polygon", "compound"};  // as in ShapeKind
    std::string text;
    for (const ShapeKind kind : traits.shapes) {
        if (!text.empty()) text += '+';
        text += kNames[static_cast<std::size_t>(kind)];
    }
    return text;
}

std::string surroundings_in_words(const WorldTraits& traits) {
    if (traits.surroundings == Surroundings::open) return " open";
    if (traits.surroundings == Surroundings::floor) return " floor";
    if (traits.surroundings == Surroundings::drum)
        return format(" drum %d %.2g/s", traits.sides, traits.drum_speed);
    if (traits.fence == Fence::walls) return " walls";
    return format(traits.fence == Fence::chain ? " chain %d" : " segments %d", traits.sides);
}

std::string flags_in_words(const WorldTraits& traits) {
    std::string text;
    const auto add = [&](bool is_on, const char* word) {
        if (is_on) text += std::string(" ") + word;
    };
    add(traits.is_crowded, "crowded"), add(traits.has_many_materials, "materials");
    add(traits.fixed_share > 0, "static"), add(traits.kinematic_share > 0, "kinematic");
    add(traits.sensor_share > 0, "sensors"), add(traits.fixed_rotation_share > 0, "unturning");
    add(traits.has_filters, "filters"), add(traits.drag.linear > 0 || traits.drag.angular > 0, "drag");
    add(traits.joined_share > 0, "joints");
    if (traits.joined_share > 0) {
        add(traits.has_springs, "springs"), add(traits.has_motors, "motors");
        add(traits.are_joints_stretched, "stretched"), add(traits.can_break, "breaking");
    }
    add(traits.sleeps, "sleep"), add(traits.is_restored, "restored");
    return text;
}

}  // namespace

WorldTraits world_traits(std::uint64_t seed, std::uint64_t index, std::int64_t most_bodies) {
    Random random(seed ^ 0xD1B54A32D192ED03u, index);  // others than those of passive scenes
    WorldTraits traits{.seed = seed, .index = index};
    traits.bodies = std::min(most_bodies, bodies_of_world(random));
    const double wildness = random.uniform();
    draw_shapes(traits, random);
    draw_sizes(traits, random);
    draw_materials(traits, random);
    draw_kinds_of_bodies(traits, wildness, random);
    draw_joints(traits, wildness, random);
    draw_forces(traits, wildness, random);
    draw_surroundings(traits, wildness, random);
    draw_steps(traits, wildness, random);
    return traits;
}

std::string in_words(const WorldTraits& traits) {
    std::string text = format("#%llu N %lld ", static_cast<unsigned long long>(traits.index),
                              static_cast<long long>(traits.bodies)) +
                       shapes_in_words(traits);
    text += format(" %.2g m", traits.unit);
    if (traits.size_ratio > 1) text += format(" 1:%.2g", traits.size_ratio);
    if (traits.mass_ratio > 0) text += format(" m 1:%.2g", traits.mass_ratio);
    text += format(" e %g f %g", traits.material.restitution, traits.material.friction);
    if (traits.material.rolling_resistance > 0) text += format(" rr %g", traits.material.rolling_resistance);
    text += format(" v %.2g g %.2g dt %.3g", traits.speed, traits.gravity, traits.dt);
    if (traits.dt_ratio > 1) text += format("-%.3g", traits.dt * traits.dt_ratio);
    if (traits.substeps) text += format(" substeps %d", *traits.substeps);
    if (traits.iterations) text += format(" iterations %d", *traits.iterations);
    return text + surroundings_in_words(traits) + flags_in_words(traits);
}

}  // namespace carom::torture
