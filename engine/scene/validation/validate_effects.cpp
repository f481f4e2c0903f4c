#include "scene/validation/validation.hpp"
#include "shapes/mass.hpp"
#include "shapes/materials.hpp"

#include <algorithm>

namespace carom {
namespace {

constexpr Item kEffectsItem{"the scene has", "/effects", -1, ""};

/// An effect that is forced off although the scene needs it.
template <class... Words>
Problem forced_off(std::string_view effect, const Words&... because) {
    return problem(ErrorCode::inconsistent, kEffectsItem, join("/", effect), "the effect ", effect,
                   " forced off although it has ", because..., ". Leave \"", effect,
                   "\" out, or take away what needs it.");
}

/// The largest of a coefficient that a body has anywhere: pieces of a compound can have their own materials.
double largest_of(const Body& body, double Material::*coefficient) {
    double largest = 0;
    for_each_material(body, [&](const Material& m) { largest = std::max(largest, m.*coefficient); });
    return largest;
}

bool bounces(const Body& body) {
    return body.type == BodyType::dynamic_body && has_restitution(body);
}

/// A turned body counts: without the effect there is no column for its angle.
bool turns(const Body& body) {
    return body.angle != 0 || body.angular_velocity != 0;
}

std::optional<Problem> find_rotation_problem(const std::vector<Body>& bodies) {
    const auto body = std::find_if(bodies.begin(), bodies.end(), turns);
    if (body != bodies.end())
        return forced_off("rotation", "body ", body - bodies.begin(), " with angle ", body->angle,
                          " rad and angular velocity ", body->angular_velocity, " rad/s");
    const auto turned = std::find_if(bodies.begin(), bodies.end(), is_turned_by_contacts);
    if (turned == bodies.end()) return std::nullopt;
    return forced_off("rotation", "body ", turned - bodies.begin(), " with the shape ",
                      quoted(name_of(turned->shape)), " and without \"fixed_rotation\", which contacts turn");
}

std::optional<Problem> find_restitution_problem(const Scene& scene) {
    if (scene.walls && scene.walls->material.restitution > 0)
        return forced_off("restitution", "walls with restitution ", scene.walls->material.restitution);
    const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(), bounces);
    if (body == scene.bodies.end()) return std::nullopt;
    return forced_off("restitution", "body ", body - scene.bodies.begin(), " with restitution ",
                      largest_of(*body, &Material::restitution));
}

/// Forced on, it needs contacts with friction that turn bodies; forced off, nothing may have any.
std::optional<Problem> find_rolling_problem(const Scene& scene, const EffectOverrides& effects) {
    const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(), has_rolling_resistance);
    std::string has;
    if (scene.walls && scene.walls->material.rolling_resistance > 0)
        has = join("walls with rolling resistance ", scene.walls->material.rolling_resistance);
    else if (body != scene.bodies.end())
        has = join("body ", body - scene.bodies.begin(), " with rolling resistance ",
                   largest_of(*body, &Material::rolling_resistance));
    if (effects.rolling_resistance == false && !has.empty()) return forced_off("rolling_resistance", has);
    if (has.empty() && effects.rolling_resistance != true) return std::nullopt;
    if (has.empty()) has = "rolling_resistance forced on";
    if (effects.friction == false) return forced_off("friction", has);
    if (effects.rotation == false) return forced_off("rotation", has);
    return std::nullopt;
}

std::optional<Problem> find_friction_problem(const Scene& scene, const EffectOverrides& effects) {
    if (effects.friction == true && effects.rotation == false)
        return problem(
            ErrorCode::inconsistent, kEffectsItem, "/friction",
            "the effect friction forced on and rotation forced off; expected both, because friction "
            "turns bodies. Leave \"rotation\" out.");
    if (effects.friction != false && effects.rotation != false) return std::nullopt;
    const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(), has_friction);
    if (body == scene.bodies.end()) return std::nullopt;
    return forced_off(effects.friction == false ? "friction" : "rotation", "body ",
                      body - scene.bodies.begin(), " with friction ", largest_of(*body, &Material::friction));
}

}  // namespace

std::optional<Problem> find_effects_problem(const Scene& scene, const EffectOverrides& effects) {
    if (effects.continuous == false && scene.accuracy.solver != Solver::pairwise)
        return problem(
            ErrorCode::inconsistent, kEffectsItem, "/continuous",
            "the effect continuous forced off, but every solver except \"pairwise\" looks ahead over "
            "the whole step: nothing passes through. Leave \"continuous\" out, or use "
            "\"pairwise\".");
    if (effects.gravity == false && scene.gravity != Vec2{})
        return forced_off("gravity", "gravity ", scene.gravity, " m/s²");
    if (effects.drag == false && (scene.drag.linear != 0 || scene.drag.angular != 0))
        return forced_off("drag", "drag ", scene.drag.linear, " 1/s (linear) and ", scene.drag.angular,
                          " 1/s (angular)");
    if (effects.rotation == false)
        if (auto found = find_rotation_problem(scene.bodies)) return found;
    if (effects.rotation == false)
        for (std::size_t i = 0; i < scene.joints.size(); ++i)
            if (turns_bodies(scene.joints[i]))
                return forced_off("rotation", "joint ", i, ", which turns bodies");
    if (effects.restitution == false)
        if (auto found = find_restitution_problem(scene)) return found;
    if (auto found = find_friction_problem(scene, effects)) return found;
    return find_rolling_problem(scene, effects);
}

void validate_effects(const Scene& scene, const EffectOverrides& effects, std::string_view where) {
    raise_if(where, find_effects_problem(scene, effects));
}

}  // namespace carom
