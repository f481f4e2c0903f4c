#pragma once

#include <optional>

namespace carom {

/// Effects a scene forces on or off; what is left out is on when the scene calls for it.
struct EffectOverrides {
    std::optional<bool> sleep{};       ///< bodies at rest are left alone; off unless asked for; needs `soft`
    std::optional<bool> continuous{};  ///< every solver of `World` always is: `false` is an error
    std::optional<bool> ledger{};      ///< energy and momentum by cause; off unless asked for
    std::optional<bool>
        gravity{};  ///< `true` keeps the stages even for zero gravity; `false` is an error if it is not zero
    std::optional<bool> drag{};         ///< likewise
    std::optional<bool> rotation{};     ///< likewise; `true` gives every body an angle and a spin
    std::optional<bool> restitution{};  ///< likewise
    std::optional<bool> friction{};     ///< likewise; needs rotation; not at rest under `impulse`
    std::optional<bool>
        rolling_resistance{};  ///< likewise; needs rotation and friction, and the solver `soft`
};

}  // namespace carom
