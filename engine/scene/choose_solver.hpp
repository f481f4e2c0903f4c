#pragma once

#include <carom/scene.hpp>

#include "scene/validation/wording.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace carom {

/// The solver a world gets, and why.
struct SolverChoice {
    Solver solver = Solver::impulse;
    std::string reason;
};

/// What bears on the solver that suits bodies: why something calls for one, in words; empty if nothing does.
struct SolverFacts {
    std::size_t bodies = 0;
    bool has_walls = false, has_gravity = false;
    std::string no_disc;    ///< of a body of another shape
    std::string rough;      ///< of what has friction, or that it is forced on
    std::string resists;    ///< of what has rolling resistance
    std::string forced;     ///< of another effect, or of sweeps, that were asked for
    std::string joined;     ///< of a joint, or of a sensor
    std::string inelastic;  ///< of a body that bounces with less than its speed

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.bodies, self.has_walls, self.has_gravity, self.no_disc, self.rough, self.resists,
                self.forced, self.joined, self.inelastic);
    }

    /// Whether a body brings a reason that there is not yet.
    bool would_change(const Body& body) const;
    /// @param label  how reasons name the body, if it brings one
    void add(const Body& body, std::string_view label);
};
/// @param iterations  asked for, the scene's own or in their place
SolverFacts facts_of(const Scene& scene, std::optional<int> iterations);

/// The solver that suits them. It grows from `impulse` to `soft` as bodies are added, never back.
SolverChoice choose_solver(const SolverFacts& facts);

/// The solver asked for; for `automatic` the one that suits the scene. Cost: O(bodies) then.
SolverChoice choose_solver(const Scene& scene, const Accuracy& asked_for);

/// The first thing in the scene that `solver`, as chosen, cannot do. Cost: O(bodies).
std::optional<Problem> find_solver_problem(const Scene& scene, Solver solver);
/// The first effect that is forced on and that `solver` does not have.
std::optional<Problem> find_solver_problem(const EffectOverrides& effects, Solver solver);
/// Joints under a solver that has none.
std::optional<Problem> find_joint_solver_problem(std::size_t joints, Solver solver);
/// Sweeps that `solver`, as chosen, does not do.
std::optional<Problem> find_iterations_problem(std::optional<int> iterations, Solver solver);
/// The first thing about one body that `solver` cannot do, for a body that is added to a running world.
/// @param gravity  m/s², of the world
std::optional<Problem> find_solver_problem(const Item& item, const Body& body, Vec2 gravity, Solver solver);

/// Parts a step is cut into unless a scene says otherwise.
int default_substeps(Solver solver);

}  // namespace carom
