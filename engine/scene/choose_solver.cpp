#include "scene/choose_solver.hpp"

#include <algorithm>

#include "scene/event_limits.hpp"
#include "scene/mass.hpp"

namespace carom {
namespace {

/// Bounces of a scene all of whose bodies have at least this restitution die out slowly enough that contact
/// at rest is the exception. A choice of speed, not of correctness.
constexpr double kBouncy = 0.5;

bool is_rough(const Material& material) {
    return material.friction > 0 || material.rolling_resistance > 0;
}

std::string_view roughness_of(const Material& material) {
    return material.friction > 0 ? "friction" : "rolling resistance";
}

/// What in the scene is rough, in words; empty if nothing is.
std::string what_is_rough(const Scene& scene) {
    if (scene.walls && is_rough(scene.walls->material))
        return join("the walls have ", roughness_of(scene.walls->material));
    const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                   [](const Body& b) { return is_rough(b.material); });
    if (body == scene.bodies.end()) return {};
    return join("body ", body - scene.bodies.begin(), " has ", roughness_of(body->material));
}

std::string_view name_of(const Shape& shape) {
    return std::holds_alternative<Segment>(shape) ? "segment"
           : std::holds_alternative<Chain>(shape) ? "chain"
                                                  : "disc";
}

SolverChoice choose(const Scene& scene) {
    const auto lines = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                    [](const Body& body) { return !is_disc(body.shape); });
    if (lines != scene.bodies.end())
        return {Solver::soft, join("body ", lines - scene.bodies.begin(), " is a ", name_of(lines->shape))};
    if (const std::string rough = what_is_rough(scene); !rough.empty()) return {Solver::soft, rough};
    if (scene.effects.friction == true) return {Solver::soft, "friction is forced on"};
    if (scene.effects.rolling_resistance == true) return {Solver::soft, "rolling resistance is forced on"};
    if (scene.effects.sleep == true) return {Solver::soft, "sleeping is asked for"};
    if (scene.bodies.size() <= 1 && !scene.walls)
        return {Solver::impulse, "there is nothing to touch: free flight is exact"};
    if (scene.gravity == Vec2{})
        return {Solver::impulse,
                "nothing has friction and without gravity nothing rests: each impact is "
                "resolved at its own time"};
    const auto dull = std::find_if(scene.bodies.begin(), scene.bodies.end(), [](const Body& b) {
        return b.type == BodyType::dynamic_body && b.material.restitution < kBouncy;
    });
    if (dull == scene.bodies.end())
        return {Solver::impulse, join("nothing has friction and every body bounces (restitution >= ", kBouncy,
                                      "): each impact is resolved at its own time")};
    return {Solver::soft,
            join("gravity brings bodies to rest on each other: body ", dull - scene.bodies.begin(),
                 " has restitution ", dull->material.restitution, ", below ", kBouncy)};
}

std::optional<Problem> find_roughness_problem(const Item& item, const Material& material, Solver solver) {
    if (solver == Solver::soft) return std::nullopt;
    if (material.rolling_resistance > 0)
        return problem(ErrorCode::inconsistent, item, "/material/rolling_resistance", "rolling resistance ",
                       material.rolling_resistance, ", but the solver ", quoted(name_of(solver)),
                       " has none. Use \"soft\" or \"auto\", or set it to 0.");
    if (solver != Solver::event && material.friction > 0)
        return problem(ErrorCode::inconsistent, item, "/material/friction", "friction ", material.friction,
                       ", but the solver ", quoted(name_of(solver)),
                       " has no friction. Use \"soft\" or \"auto\", or set it to 0.");
    return std::nullopt;
}

}  // namespace

SolverChoice choose_solver(const Scene& scene, Solver asked_for) {
    if (asked_for == Solver::automatic) return choose(scene);
    return {asked_for, "asked for"};
}

std::optional<Problem> find_solver_problem(const EffectOverrides& effects, Solver solver) {
    const auto refuse = [solver](std::string_view effect) {
        return problem(ErrorCode::inconsistent, {"the scene has", "/effects", -1, ""}, join("/", effect),
                       "the effect ", effect, " forced on, but the solver ", quoted(name_of(solver)),
                       " does not have it. Use \"soft\" or \"auto\", or leave \"", effect, "\" out.");
    };
    if (solver == Solver::soft) return std::nullopt;
    if (effects.sleep == true) return refuse("sleep");
    if (effects.rolling_resistance == true) return refuse("rolling_resistance");
    return std::nullopt;
}

std::optional<Problem> find_solver_problem(const Item& item, const Body& body, Solver solver) {
    if (!is_disc(body.shape) && solver != Solver::soft)
        return problem(ErrorCode::inconsistent, item, join("/shape/", name_of(body.shape)), "the shape ",
                       quoted(name_of(body.shape)), ", but the solver ", quoted(name_of(solver)),
                       " knows discs only. Use \"soft\" or \"auto\".");
    return find_roughness_problem(item, body.material, solver);
}

std::optional<Problem> find_solver_problem(const Scene& scene, Solver solver) {
    if (auto found = find_solver_problem(scene.effects, solver)) return found;
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

int default_substeps(Solver solver) {
    return solver == Solver::soft ? 4 : 1;
}

}  // namespace carom
