#pragma once

#include <carom/scene.hpp>

namespace carom {

/// Calls fn(material) for all that a body is made of.
template <class Fn>
void for_each_material(const Body& body, const Fn& fn) {
    const auto* compound = std::get_if<Compound>(&body.shape);
    bool all_have_one = compound != nullptr;
    if (compound)
        for (const Piece& piece : compound->pieces)
            piece.material ? fn(*piece.material) : void(all_have_one = false);
    if (!all_have_one) fn(body.material);
}

/// Whether something of a body is made of a material for which `holds` does.
template <class Holds>
bool any_material(const Body& body, const Holds& holds) {
    bool any = false;
    for_each_material(body, [&](const Material& material) { any = any || holds(material); });
    return any;
}
inline bool has_friction(const Body& body) {
    return any_material(body, [](const Material& m) { return m.friction > 0; });
}
inline bool has_restitution(const Body& body) {
    return any_material(body, [](const Material& m) { return m.restitution > 0; });
}
inline bool has_rolling_resistance(const Body& body) {
    return any_material(body, [](const Material& m) { return m.rolling_resistance > 0; });
}

}  // namespace carom
