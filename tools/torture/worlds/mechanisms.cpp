#include "torture/worlds/mechanisms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "simulation/body_mass.hpp"
#include "torture/worlds/bodies.hpp"
#include "torture/worlds/joints.hpp"

namespace carom::torture {
namespace {

constexpr double kApart = 2.05;  // distance of neighbours over their reach: they do not touch

/// N: what holds the body against gravity, or stops it within a second.
double force_on(const Body& body, const WorldTraits& traits) {
    return tool::mass_of(body) * (traits.gravity + traits.speed + traits.unit);
}

JointEnds ends_of(const Group& group, std::optional<BodyId> a, BodyId b, const WorldTraits& traits) {
    const Body& second = group.bodies[b.index];
    JointEnds ends{.a = a, .b = b, .at_a = second.position, .at_b = second.position};
    ends.force = force_on(second, traits);
    if (!a) return ends;
    ends.at_a = group.bodies[a->index].position;
    ends.force = std::fmax(ends.force, force_on(group.bodies[a->index], traits));
    return ends;
}

void turn_joined_contacts_off(Group& group) {
    for (Body& body : group.bodies) body.group = -7;
}

/// A hinge or rod that holds a body to a point of the world beside it.
void pin(Group& group, BodyId body, Vec2 at, const WorldTraits& traits, Random& random) {
    JointEnds ends = ends_of(group, std::nullopt, body, traits);
    ends.at_a = at;
    group.add(random_link(ends, traits, random));
}

Group random_chain(const WorldTraits& traits, std::size_t most, Random& random) {
    const std::size_t count = 2 + random.below(most - 1);
    const double size = random_size(traits, random), weight = random.log_uniform(1, 1e4);
    const Body link = random_body(traits, size, random);
    const double spacing = kApart * reach_of(link), start = -0.5 * spacing * static_cast<double>(count - 1);
    Group group;
    for (std::size_t i = 0; i < count; ++i) {
        Body body = random.chance(0.8) ? link : random_body(traits, size * random.uniform(0.5, 1), random);
        body.position = {start + spacing * static_cast<double>(i), 0};
        if (i + 1 == count && random.chance(0.3)) body.mass = weight * tool::mass_of(body);
        const BodyId added = group.add(body);
        if (i > 0)
            group.add(random_link(ends_of(group, BodyId{added.index - 1, 0}, added, traits), traits, random));
    }
    if (random.chance(0.5)) pin(group, {0, 0}, {start - 0.5 * spacing, 0}, traits, random);
    const Vec2 behind_last{start + spacing * (static_cast<double>(count) - 0.5), 0};
    if (random.chance(0.15))
        pin(group, {static_cast<std::uint32_t>(count - 1), 0}, behind_last, traits, random);
    return group;
}

Group random_net(const WorldTraits& traits, std::size_t most, Random& random) {
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(most)));
    const std::size_t columns = 2 + random.below(std::max<std::size_t>(side, 2) - 1),
                      rows = std::clamp<std::size_t>(most / columns, 1, columns);
    const Body knot = random_body(traits, random_size(traits, random), random);
    const double spacing = kApart * reach_of(knot);
    const bool is_hung = random.chance(0.5);
    Group group;
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column) {
            Body body = knot;
            body.position = {spacing * (static_cast<double>(column) - 0.5 * static_cast<double>(columns - 1)),
                             spacing * (static_cast<double>(row) - 0.5 * static_cast<double>(rows - 1))};
            const bool is_corner = row + 1 == rows && (column == 0 || column + 1 == columns);
            if (is_hung && is_corner) body.type = BodyType::static_body, body.mass.reset();
            group.add(body);
        }
    turn_joined_contacts_off(group);
    const auto join = [&](std::size_t a, std::size_t b) {
        const BodyId first{static_cast<std::uint32_t>(a), 0}, second{static_cast<std::uint32_t>(b), 0};
        if (group.bodies[a].type == BodyType::static_body && group.bodies[b].type == BodyType::static_body)
            return;
        group.add(random_link(ends_of(group, first, second, traits), traits, random));
    };
    for (std::size_t i = 0; i < group.bodies.size(); ++i) {
        if (i % columns > 0) join(i - 1, i);
        if (i >= columns) join(i - columns, i);
    }
    return group;
}

/// Limbs grow from limbs in any direction, so that some lie over each other.
Group random_figure(const WorldTraits& traits, std::size_t most, Random& random) {
    const std::size_t count = 2 + random.below(std::min<std::size_t>(most, 15) - 1);
    const double size = random_size(traits, random);
    Group group;
    for (std::size_t i = 0; i < count; ++i) {
        Body limb = random_body(traits, size * random.uniform(0.4, 1), random);
        if (i == 0) {
            group.add(limb);
            continue;
        }
        const BodyId parent{static_cast<std::uint32_t>(random.below(i)), 0};
        const Body& body = group.bodies[parent.index];
        const double away = 0.5 * kApart * (reach_of(body) + reach_of(limb)),
                     angle = random.uniform(0, 2 * std::numbers::pi);
        limb.position = {body.position.x + away * std::cos(angle), body.position.y + away * std::sin(angle)};
        limb.angle = angle;
        const BodyId added = group.add(limb);
        group.add(random_link(ends_of(group, parent, added, traits), traits, random));
    }
    if (!traits.is_crowded) turn_joined_contacts_off(group);
    return group;
}

Group random_ring(const WorldTraits& traits, std::size_t most, Random& random) {
    const std::size_t count = 3 + random.below(std::max<std::size_t>(most, 3) - 2);
    const Body link = random_body(traits, random_size(traits, random), random);
    const double each = 2 * std::numbers::pi / static_cast<double>(count),
                 radius = 0.5 * kApart * reach_of(link) / std::sin(0.5 * each);
    Group group;
    for (std::size_t i = 0; i < count; ++i) {
        Body body = link;
        const double angle = each * static_cast<double>(i);
        body.position = {radius * std::cos(angle), radius * std::sin(angle)}, body.angle = angle;
        group.add(body);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const BodyId a{static_cast<std::uint32_t>(i), 0}, b{static_cast<std::uint32_t>((i + 1) % count), 0};
        group.add(random_link(ends_of(group, a, b, traits), traits, random));
    }
    return group;
}

Group random_cart(const WorldTraits& traits, std::size_t, Random& random) {
    const double size = random_size(traits, random);
    Group group;
    const BodyId chassis = group.add(body_of(traits, Box{2 * size, 0.5 * size}, random));
    for (const double side : {-1., 1.}) {
        Body wheel = body_of(traits, Disc{0.3 * size}, random);
        wheel.position = {0.7 * side * size, -0.6 * size};
        const BodyId added = group.add(wheel);
        group.add(wheel_on(ends_of(group, chassis, added, traits), traits, random));
    }
    return group;
}

/// Wheels in a row, each on an axle of its own; each turns the next one.
Group random_gears(const WorldTraits& traits, std::size_t most, Random& random) {
    const std::size_t count = 2 + random.below(std::min<std::size_t>(most, 4) - 1);
    const double size = random_size(traits, random), spacing = kApart * size;
    Group group;
    std::vector<JointId> axles;
    for (std::size_t i = 0; i < count; ++i) {
        Body wheel = body_of(traits, Disc{size}, random);
        wheel.position = {spacing * (static_cast<double>(i) - 0.5 * static_cast<double>(count - 1)), 0};
        wheel.fixed_rotation = false;
        const BodyId added = group.add(wheel);
        axles.push_back(
            group.add(hinge_at(ends_of(group, std::nullopt, added, traits), wheel.position, traits, random)));
    }
    for (std::size_t i = 1; i < count; ++i) {
        const double ratio = (random.chance(0.5) ? 1 : -1) * random.log_uniform(0.2, 5);
        group.add(Joint{.kind = GearJoint{axles[i - 1], axles[i], ratio}});
    }
    return group;
}

Group random_couple(const WorldTraits& traits, std::size_t, Random& random) {
    Group group;
    const BodyId a = group.add(random_body(traits, random_size(traits, random), random));
    Body other = random_body(traits, random_size(traits, random), random);
    const double away = 0.5 * kApart * (reach_of(group.bodies[0]) + reach_of(other));
    group.bodies[0].position = {-0.5 * away, 0}, other.position = {0.5 * away, 0};
    const BodyId b = group.add(other);
    group.add(random_joint(ends_of(group, a, b, traits), traits, random));
    if (random.chance(0.2)) group.add(random_joint(ends_of(group, a, b, traits), traits, random));
    if (random.chance(0.2)) pin(group, a, {-away, 0}, traits, random);
    return group;
}

}  // namespace

Group random_mechanism(const WorldTraits& traits, std::size_t most, Random& random) {
    using Make = Group (*)(const WorldTraits&, std::size_t, Random&);
    constexpr std::array<Make, 7> kMakers{random_chain, random_net,   random_figure, random_ring,
                                          random_cart,  random_gears, random_couple};
    return random.one_of<Make>(kMakers)(traits, most, random);
}

bool has_own_force(const Joint& joint) {
    return std::visit(
        [](const auto& kind) {
            using Kind = std::decay_t<decltype(kind)>;
            if constexpr (std::is_same_v<Kind, TargetJoint>)
                return true;
            else if constexpr (std::is_same_v<Kind, GearJoint>)
                return false;
            else if constexpr (requires { kind.motor_speed; })
                return kind.frequency > 0 || kind.motor_speed.has_value();
            else
                return kind.frequency > 0;
        },
        joint.kind);
}

}  // namespace carom::torture
