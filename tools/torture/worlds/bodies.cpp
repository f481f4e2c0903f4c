#include "torture/worlds/bodies.hpp"

#include <cmath>
#include <numbers>

#include "simulation/outlines.hpp"
#include "torture/worlds/shapes.hpp"

namespace carom::torture {
namespace {

Material material_of_body(const WorldTraits& traits, Random& random) {
    Material material = traits.material;
    material.density = traits.density;
    if (!traits.has_many_materials) return material;
    material.restitution *= random.uniform(), material.friction *= random.uniform();
    material.rolling_resistance *= random.uniform();
    material.density *= random.log_uniform(0.1, 10);
    return material;
}

void give_filter(Body& body, Random& random) {
    constexpr int kBits = 4, kGroups = 3;
    body.category = static_cast<std::uint16_t>(1u << random.below(kBits));
    body.mask = static_cast<std::uint16_t>(random.below(1u << kBits) | kFenceCategory);
    if (random.chance(0.3)) body.group = static_cast<std::int32_t>(random.below(2 * kGroups + 1)) - kGroups;
}

double length_of_vector(Vec2 point) {
    return std::hypot(point.x, point.y);
}

}  // namespace

double random_size(const WorldTraits& traits, Random& random) {
    const double ratio = std::sqrt(traits.size_ratio);
    return random.skewed(traits.unit / ratio, traits.unit * ratio, 2);
}

Body body_of(const WorldTraits& traits, const Shape& shape, Random& random) {
    Body body;
    body.shape = shape;
    body.material = material_of_body(traits, random);
    if (traits.mass_ratio > 0)
        body.mass = traits.density * traits.unit * traits.unit * random.log_uniform(1, traits.mass_ratio);
    body.fixed_rotation = random.chance(traits.fixed_rotation_share);
    if (traits.has_filters) give_filter(body, random);
    return body;
}

Body random_body(const WorldTraits& traits, double size, Random& random) {
    return body_of(traits, random_shape(random.one_of<ShapeKind>(traits.shapes), size, random), random);
}

void change_kind(Body& body, const WorldTraits& traits, double size, Random& random) {
    const bool is_fixed = random.chance(traits.fixed_share),
               is_kinematic = random.chance(traits.kinematic_share);
    if (is_fixed || is_kinematic) {
        body.type = is_fixed ? BodyType::static_body : BodyType::kinematic_body;
        body.mass.reset();
        if (random.chance(0.4)) body.shape = random_line(size, random);
    }
    const bool has_area =
        !std::holds_alternative<Segment>(body.shape) && !std::holds_alternative<Chain>(body.shape);
    body.sensor = has_area && random.chance(traits.sensor_share);
}

double reach_of(const Body& body) {
    if (const auto* segment = std::get_if<Segment>(&body.shape))
        return std::fmax(length_of_vector(segment->a), length_of_vector(segment->b));
    if (const auto* chain = std::get_if<Chain>(&body.shape)) {
        double reach = 0;
        for (const Vec2 point : chain->points) reach = std::fmax(reach, length_of_vector(point));
        return reach;
    }
    return tool::extent_of(body);
}

}  // namespace carom::torture
