#pragma once

#include <cstddef>

#include "solvers/paths/cut/path_choice.hpp"

namespace carom {

/// How paths are solved: iterations of the active set, at most, of paths that alone hold their bodies and of
/// others; whether those that do not settle are solved in pieces; Gauss-Seidel sweeps over what does not
/// settle so either; and over contacts beside the paths, behind each solve of the paths.
struct PathPlan {
    int most_of_slender, most;
    bool tries_pieces;
    int sweeps_of_unsettled, sweeps_of_watched;
};
/// By PathMood. Where contacts come and go, exact solutions are soon out of date, sooner in a crowd.
/// docs/decisions/0042-contacts-that-cannot-close.md has the measurements of the last,
/// 0091-wild-and-restless-crowds.md those of crowds.
inline constexpr PathPlan kPlans[] = {{40, 10, true, 4, 2}, {8, 8, true, 4, 2}, {4, 4, false, 4, 2}},
                          kPlansOfCrowds[] = {{40, 10, true, 4, 2}, {8, 5, true, 4, 2}, {3, 3, false, 2, 1}};

inline const PathPlan& plan_of(PathMood mood, bool is_crowd) {
    return (is_crowd ? kPlansOfCrowds : kPlans)[static_cast<std::size_t>(mood)];
}

}  // namespace carom
