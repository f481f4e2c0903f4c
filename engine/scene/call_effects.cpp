#include "scene/call_effects.hpp"

#include <string>

#include "math/vec2_math.hpp"
#include "scene/validation/validation.hpp"
#include "shapes/mass.hpp"
#include "shapes/materials.hpp"

namespace carom {
namespace {

/// Decides one effect: forced, or called for by `what`, which is empty if nothing calls for it.
bool decide(std::vector<EffectReport>& reports, const char* name, const std::optional<bool>& forced,
            const std::string& what, const char* nothing) {
    const bool called = !what.empty();
    const bool on = forced.value_or(called);
    std::string reason = called ? what : nothing;
    if (forced && *forced && !called) reason = "forced on; " + reason;
    if (forced && !*forced) reason = "forced off";
    reports.push_back({name, on, reason});
    return on;
}

/// "body 3" or "body 3 ("ball")".
std::string label(const Scene& scene, std::size_t body) {
    const std::string& name = scene.bodies[body].name;
    return "body " + std::to_string(body) + (name.empty() ? "" : " (\"" + name + "\")");
}

/// The first body for which `calls` holds, as a reason; empty if there is none.
template <class Calls>
std::string first_body(const Scene& scene, const Calls& calls, const char* has) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        if (calls(scene.bodies[i])) return label(scene, i) + has;
    return {};
}

std::string number(double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
}

}  // namespace

EffectOverrides merged(const EffectOverrides& first, const EffectOverrides& second) {
    EffectOverrides effects;
    for (const auto effect :
         {&EffectOverrides::sleep, &EffectOverrides::continuous, &EffectOverrides::ledger,
          &EffectOverrides::gravity, &EffectOverrides::drag, &EffectOverrides::rotation,
          &EffectOverrides::restitution, &EffectOverrides::friction, &EffectOverrides::rolling_resistance})
        effects.*effect = first.*effect ? first.*effect : second.*effect;
    return effects;
}

CalledEffects call_effects(const Scene& scene, const EffectOverrides& overrides) {
    CalledEffects called;
    Effects& on = called.effects;
    auto& reports = called.reports;
    const EffectOverrides forced = merged(overrides, scene.effects);
    const Vec2 g = scene.gravity;
    on.gravity = decide(reports, "gravity", forced.gravity,
                        g == Vec2{} ? "" : "gravity is (" + number(g.x) + ", " + number(g.y) + ") m/s²",
                        "gravity is zero");
    on.drag = decide(reports, "drag", forced.drag,
                     scene.drag.linear > 0 ? "linear drag is " + number(scene.drag.linear) + " 1/s" : "",
                     "linear drag is zero");
    on.walls =
        decide(reports, "walls", {}, scene.walls ? "the scene has walls" : "", "the scene has no walls");
    std::string bounces = first_body(scene, has_restitution, " has a restitution above zero");
    if (bounces.empty() && scene.walls && scene.walls->material.restitution > 0)
        bounces = "the walls have a restitution above zero";
    on.restitution = decide(reports, "restitution", forced.restitution, bounces, "every restitution is zero");
    std::string rubs = first_body(scene, has_friction, " has friction");
    std::string resists = first_body(scene, has_rolling_resistance, " has rolling resistance");
    if (resists.empty() && scene.walls && scene.walls->material.rolling_resistance > 0)
        resists = "the walls have rolling resistance";
    if (rubs.empty() && (!resists.empty() || forced.rolling_resistance == true))
        rubs = "rolling resistance needs contacts that turn bodies";
    on.friction = decide(reports, "friction", forced.friction, rubs, "every friction coefficient is zero");
    on.rolling_resistance = decide(reports, "rolling resistance", forced.rolling_resistance, resists,
                                   "every rolling resistance is zero");
    std::string turns = first_body(
        scene, [](const Body& b) { return b.angular_velocity != 0 || b.angle != 0; },
        " has an angle or a spin");
    if (turns.empty() && on.friction) turns = "friction turns bodies";
    if (turns.empty()) turns = first_body(scene, is_turned_by_contacts, " is no disc: contacts turn it");
    for (const Joint& joint : scene.joints)
        if (turns.empty() && turns_bodies(joint)) turns = "a joint turns bodies";
    on.rotation = decide(reports, "rotation", forced.rotation, turns,
                         "no body has an angle or a spin, and nothing can give one");
    on.angular_drag = decide(reports, "angular drag", {},
                             on.rotation && scene.drag.angular > 0
                                 ? "angular drag is " + number(scene.drag.angular) + " 1/s and bodies turn"
                                 : "",
                             scene.drag.angular > 0 ? "nothing turns" : "angular drag is zero");
    decide(reports, "continuous collision", {}, "every solver looks ahead over the whole step", "");
    on.ledger = decide(reports, "ledger", forced.ledger, "", "not asked for");
    on.joints =
        decide(reports, "joints", {},
               scene.joints.empty() ? "" : "the scene has " + std::to_string(scene.joints.size()) + " joints",
               "the scene has no joints");
    on.sleeping = decide(reports, "sleeping", forced.sleep, "", "not asked for");
    return called;
}

}  // namespace carom
