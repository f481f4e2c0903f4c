#pragma once

#include <carom/scene.hpp>

#include <optional>
#include <string_view>
#include <vector>

namespace carom::tool {

/// What a scene can force on or off of an effect.
using Wish = std::optional<bool> EffectOverrides::*;

/// One line of the price list.
struct PricedEffect {
    std::string_view name;          ///< as in scene files
    std::vector<Wish> wishes;       ///< forced on together, to carry the effect
    std::vector<Wish> alongside;    ///< forced on in both worlds: the price is without theirs
    std::string_view what;          ///< a sentence on what it is
    std::string_view called_by;     ///< what calls for it
    void (*take_away)(Scene&);      ///< sets what calls for it to zero; null if it has no such values
    std::string_view instead_of{};  ///< how the scene is then described: "gravity zero"
};

/// All effects that a scene can force on or off. An effect more is a line more.
const std::vector<PricedEffect>& priced_effects();

}  // namespace carom::tool
