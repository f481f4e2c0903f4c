#include "pricing/priced_effects.hpp"

namespace carom::tool {
namespace {

template <class Change>
void change_materials(Scene& scene, const Change& change) {
    for (Body& body : scene.bodies) {
        change(body.material);
        if (auto* compound = std::get_if<Compound>(&body.shape))
            for (Piece& piece : compound->pieces)
                if (piece.material) change(*piece.material);
    }
    if (scene.walls) change(scene.walls->material);
}

void without_gravity(Scene& scene) {
    scene.gravity = {};
}
void without_drag(Scene& scene) {
    scene.drag = {};
}
void without_restitution(Scene& scene) {
    change_materials(scene, [](Material& material) { material.restitution = 0; });
}
void without_friction(Scene& scene) {
    change_materials(scene, [](Material& material) { material.friction = 0; });
}
void without_rolling_resistance(Scene& scene) {
    change_materials(scene, [](Material& material) { material.rolling_resistance = 0; });
}
/// Friction turns bodies, so it goes with what it turns.
void without_turns(Scene& scene) {
    without_friction(scene);
    for (Body& body : scene.bodies) body.angle = 0, body.angular_velocity = 0;
}

}  // namespace

const std::vector<PricedEffect>& priced_effects() {
    using E = EffectOverrides;
    static const std::vector<PricedEffect> effects{
        {"gravity",
         {&E::gravity},
         {},
         "one acceleration of all bodies",
         "gravity that is not zero",
         &without_gravity,
         "gravity zero"},
        {"drag",
         {&E::drag},
         {},
         "a fluid at rest: velocity decays as exp(-k t)",
         "linear drag above zero",
         &without_drag,
         "drag zero"},
        {"restitution",
         {&E::restitution},
         {},
         "bodies that bounce",
         "a restitution above zero",
         &without_restitution,
         "every restitution zero"},
        {"rotation",
         {&E::rotation},
         {},
         "bodies that have an angle and a spin",
         "friction, or a body with an angle or a spin",
         &without_turns,
         "no friction, angle or spin"},
        {"friction",
         {&E::friction},
         {&E::rotation},
         "Coulomb friction, on top of rotation, which it needs",
         "a friction coefficient above zero",
         &without_friction,
         "every friction coefficient zero"},
        {"friction and rotation",
         {&E::friction, &E::rotation},
         {},
         "both together, against neither",
         "a friction coefficient above zero",
         &without_turns,
         "no friction, angle or spin"},
        {"rolling_resistance",
         {&E::rolling_resistance},
         {&E::rotation, &E::friction},
         "a moment against rolling, on top of friction, which it needs",
         "a rolling resistance above zero",
         &without_rolling_resistance,
         "every rolling resistance zero"},
        {"ledger",
         {&E::ledger},
         {},
         "energy and momentum by cause",
         "nothing: it has to be asked for",
         nullptr},
        {"continuous",
         {&E::continuous},
         {},
         "bodies do not pass through each other within a step",
         "every scene",
         nullptr},
        {"sleep",
         {&E::sleep},
         {},
         "bodies at rest are left alone",
         "nothing: it has to be asked for",
         nullptr},
    };
    return effects;
}

}  // namespace carom::tool
