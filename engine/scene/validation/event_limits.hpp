#pragma once

#include <carom/scene.hpp>

#include <optional>

namespace carom {

/// Under gravity the solver `event` lets nothing rest, it lets it shiver (docs/how-a-step-works.md). What
/// falls on something must bounce at least this well, else it would do nothing but that.
inline constexpr double kSmallestEventRestitution = 0.01;

/// The first thing in a scene that the solver `event` cannot do. Cost: O(bodies).
std::optional<Problem> find_event_problem(const Scene& scene);

}  // namespace carom
