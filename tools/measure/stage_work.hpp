#pragma once

#include <carom/profile.hpp>

#include <optional>
#include <string_view>

#include "measure/ceilings.hpp"

namespace carom::measure {

/// What a stage works through in one step, and how much it does for one of those. Bytes and operations are
/// counted in the source of its kernels, each byte once: what must be moved, not what a cache moves.
struct StageWork {
    std::string_view item;  ///< "body", "candidate pair", ...
    double items = 0;       ///< a step
    Work work{};
};

/// What steps did that lie between two profiles of a world.
struct ProfiledSteps {
    Profile before, after;
    double bodies = 0;
    double real_bytes = 4;  ///< of a number: 4 or 8

    double steps() const { return static_cast<double>(after.steps - before.steps); }
};

/// @param calls  of the stage in a step: one a substep
/// @return nothing for a stage whose work is not a matter of items
std::optional<StageWork> work_of_stage(std::string_view stage, const ProfiledSteps& steps, double calls);

}  // namespace carom::measure
