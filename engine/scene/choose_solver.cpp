#include "scene/choose_solver.hpp"

#include "scene/event_limits.hpp"

namespace carom {
namespace {

SolverChoice choose(const Scene&) {
    return {Solver::impulse,
            "every shape is a disc and nothing has friction: each impact is resolved at its own time"};
}

std::optional<Problem> find_roughness_problem(const Item& item, const Material& material, Solver solver) {
    if (material.friction > 0 && solver != Solver::event)
        return problem(ErrorCode::not_built_yet, item, "/material/friction", "friction ", material.friction,
                       "; friction is not built yet for the solver ", quoted(name_of(solver)),
                       ": it comes with the solver \"soft\". Use \"event\", or set it to 0.");
    if (material.rolling_resistance > 0)
        return problem(
            ErrorCode::not_built_yet, item, "/material/rolling_resistance", "rolling resistance ",
            material.rolling_resistance,
            "; rolling resistance is not built yet: it comes with the solver \"soft\". Set it to 0.");
    return std::nullopt;
}

}  // namespace

SolverChoice choose_solver(const Scene& scene, Solver asked_for) {
    if (asked_for == Solver::automatic) return choose(scene);
    return {asked_for, "asked for"};
}

std::optional<Problem> find_solver_problem(const Item& item, const Body& body, Solver solver) {
    return find_roughness_problem(item, body.material, solver);
}

std::optional<Problem> find_solver_problem(const Scene& scene, Solver solver) {
    if (solver == Solver::event)
        if (auto found = find_event_problem(scene)) return found;
    if (scene.walls)
        if (auto found =
                find_roughness_problem({"the walls have", "/walls", -1, ""}, scene.walls->material, solver))
            return found;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Item item{"body", "/bodies", static_cast<std::ptrdiff_t>(i), scene.bodies[i].name};
        if (auto found = find_solver_problem(item, scene.bodies[i], solver)) return found;
    }
    return std::nullopt;
}

int default_substeps(Solver) {
    return 1;
}

}  // namespace carom
