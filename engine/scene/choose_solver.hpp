#pragma once

#include <carom/scene.hpp>

#include "scene/wording.hpp"

#include <optional>
#include <string>

namespace carom {

/// The solver a world gets, and why.
struct SolverChoice {
    Solver solver = Solver::impulse;
    std::string reason;
};

/// The solver asked for; for `automatic` the one that suits the scene. Cost: O(bodies) then.
SolverChoice choose_solver(const Scene& scene, Solver asked_for);

/// The first thing in the scene that `solver`, as chosen, cannot do. Cost: O(bodies).
std::optional<Problem> find_solver_problem(const Scene& scene, Solver solver);
/// Of effects that are forced on.
std::optional<Problem> find_solver_problem(const EffectOverrides& effects, Solver solver);
/// The same of one body, for whoever adds it later.
std::optional<Problem> find_solver_problem(const Item& item, const Body& body, Solver solver);

/// Parts a step is cut into unless a scene says otherwise.
int default_substeps(Solver solver);

}  // namespace carom
