#include "scene/choose_solver.hpp"

#include "scene/validation/event_limits.hpp"
#include "scene/validation/validation.hpp"
#include "shapes/convex_geometry.hpp"
#include "shapes/mass.hpp"
#include "shapes/materials.hpp"

namespace carom {
namespace {

/// A pair takes the larger restitution of the two, so what walls and immovable bodies have takes nothing
/// away.
bool is_inelastic(const Body& body) {
    return body.type == BodyType::dynamic_body && body.material.restitution < 1;
}

std::optional<Problem> find_roughness_problem(const Item& item, const Material& material, Vec2 gravity,
                                              Solver solver) {
    if (solver == Solver::soft || solver == Solver::rattle) return std::nullopt;  // this one has no contacts
    if (material.rolling_resistance > 0)
        return problem(ErrorCode::inconsistent, item, "/material/rolling_resistance", "rolling resistance ",
                       material.rolling_resistance, ", but the solver ", quoted(name_of(solver)),
                       " has none. Use \"soft\" or \"auto\", or set it to 0.");
    if (solver == Solver::event || material.friction == 0) return std::nullopt;
    if (solver != Solver::impulse)
        return problem(ErrorCode::inconsistent, item, "/material/friction", "friction ", material.friction,
                       ", but the solver ", quoted(name_of(solver)),
                       " has no friction. Use \"soft\" or \"auto\", or set it to 0.");
    if (gravity == Vec2{}) return std::nullopt;
    return problem(ErrorCode::inconsistent, item, "/material/friction", "friction ", material.friction,
                   " and gravity is ", gravity,
                   " m/s², but the solver \"impulse\" has friction in impacts alone, none where bodies rest; "
                   "with gravity expected 0. Use \"soft\" or \"auto\", or set friction or gravity to 0.");
}

std::optional<Problem> find_filter_problem(const Item& item, const Body& body) {
    const auto refuse = [&](std::string_view key, auto value) {
        return problem(ErrorCode::inconsistent, item, join("/filter/", key), key, " ", value,
                       ", but the solver \"event\" knows no filters. Use \"soft\", \"impulse\" or "
                       "\"auto\".");
    };
    if (body.group != 0) return refuse("group", body.group);
    if (body.category != kDefaultCategory) return refuse("category", body.category);
    if (body.mask != kDefaultMask) return refuse("mask", body.mask);
    return std::nullopt;
}

/// Lines are there to be touched alone.
std::optional<Problem> find_rattle_problem(const Item& item, const Body& body) {
    if (is_disc(body.shape) || is_convex(body.shape)) return std::nullopt;
    return problem(ErrorCode::inconsistent, item, join("/shape/", name_of(body.shape)), "the shape ",
                   quoted(name_of(body.shape)),
                   ", but the solver \"rattle\" has joints alone, no contacts. Use \"soft\" or \"auto\".");
}

}  // namespace

bool SolverFacts::would_change(const Body& body) const {
    return (no_disc.empty() && !is_disc(body.shape)) || (rough.empty() && has_friction(body)) ||
           (resists.empty() && has_rolling_resistance(body)) || (joined.empty() && body.sensor) ||
           (inelastic.empty() && is_inelastic(body));
}

void SolverFacts::add(const Body& body, std::string_view label) {
    ++bodies;
    if (no_disc.empty() && !is_disc(body.shape)) no_disc = join(label, " is a ", name_of(body.shape));
    if (rough.empty() && has_friction(body)) rough = join(label, " has friction");
    if (resists.empty() && has_rolling_resistance(body)) resists = join(label, " has rolling resistance");
    if (joined.empty() && body.sensor) joined = join(label, " is a sensor");
    if (inelastic.empty() && is_inelastic(body))
        inelastic = join(label, " has restitution ", body.material.restitution, ", below 1");
}

SolverFacts facts_of(const Scene& scene, std::optional<int> iterations) {
    SolverFacts facts;
    facts.has_walls = scene.walls.has_value();
    facts.has_gravity = scene.gravity != Vec2{};
    if (scene.walls && scene.walls->material.friction > 0)
        facts.rough = "the walls have friction";
    else if (scene.effects.friction == true)
        facts.rough = "friction is forced on";
    if (scene.walls && scene.walls->material.rolling_resistance > 0)
        facts.resists = "the walls have rolling resistance";
    if (scene.effects.rolling_resistance == true)
        facts.forced = "rolling resistance is forced on";
    else if (scene.effects.sleep == true)
        facts.forced = "sleeping is asked for";
    else if (iterations.value_or(1) > 1)
        facts.forced = join(*iterations, " iterations are asked for");
    if (!scene.joints.empty()) facts.joined = "the scene has joints";
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const bool is_news = facts.would_change(scene.bodies[i]);
        facts.add(scene.bodies[i], is_news ? join("body ", i) : "");
    }
    return facts;
}

SolverChoice choose_solver(const SolverFacts& facts) {
    for (const std::string* reason : {&facts.no_disc, &facts.joined, &facts.resists, &facts.forced})
        if (!reason->empty()) return {Solver::soft, *reason};
    if (facts.has_gravity && !facts.rough.empty()) return {Solver::soft, facts.rough};
    if (facts.bodies <= 1 && !facts.has_walls)
        return {Solver::impulse, "there is nothing to touch: free flight is exact"};
    if (!facts.inelastic.empty())
        return {Solver::soft, join("impacts take energy until bodies rest or crowd: ", facts.inelastic)};
    return {
        Solver::impulse,
        join(facts.rough.empty() ? "nothing has friction" : "without gravity friction acts in impacts alone",
             " and every body has restitution 1, so nothing comes to rest: each impact is resolved at "
             "its own time")};
}

SolverChoice choose_solver(const Scene& scene, const Accuracy& asked_for) {
    if (asked_for.solver == Solver::automatic) return choose_solver(facts_of(scene, asked_for.iterations));
    return {asked_for.solver, "asked for"};
}

std::optional<Problem> find_iterations_problem(std::optional<int> iterations, Solver solver) {
    if (solver == Solver::soft || iterations.value_or(1) == 1) return std::nullopt;
    return problem(ErrorCode::inconsistent, {"the accuracy has", "/accuracy", -1, ""}, "/iterations",
                   "iterations ", *iterations, ", but the solver ", quoted(name_of(solver)),
                   " does no sweeps that could be repeated; expected 1. Use \"soft\" or \"auto\", or leave "
                   "\"iterations\" out.");
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

std::optional<Problem> find_solver_problem(const Item& item, const Body& body, Vec2 gravity, Solver solver) {
    if (body.sensor && solver != Solver::soft)
        return problem(ErrorCode::inconsistent, item, "/sensor", "sensor true, but the solver ",
                       quoted(name_of(solver)), " knows no sensors. Use \"soft\" or \"auto\".");
    if (solver == Solver::rattle) return find_rattle_problem(item, body);
    if (!is_disc(body.shape) && solver != Solver::soft)
        return problem(ErrorCode::inconsistent, item, join("/shape/", name_of(body.shape)), "the shape ",
                       quoted(name_of(body.shape)), ", but the solver ", quoted(name_of(solver)),
                       " knows discs only. Use \"soft\" or \"auto\".");
    if (solver == Solver::event)
        if (auto found = find_filter_problem(item, body)) return found;
    return find_roughness_problem(item, body.material, gravity, solver);
}

std::optional<Problem> find_joint_solver_problem(std::size_t joints, Solver solver) {
    if (joints == 0 || solver == Solver::soft || solver == Solver::rattle) return std::nullopt;
    return problem(ErrorCode::inconsistent, {"the scene has", "/joints", -1, ""}, "", joints,
                   joints == 1 ? " joint" : " joints", ", but the solver ", quoted(name_of(solver)),
                   " knows none. Use \"soft\" or \"auto\", or take the joints out.");
}

std::optional<Problem> find_solver_problem(const Scene& scene, Solver solver) {
    if (auto found = find_solver_problem(scene.effects, solver)) return found;
    if (auto found = find_joint_solver_problem(scene.joints.size(), solver)) return found;
    if (solver == Solver::event)
        if (auto found = find_event_problem(scene)) return found;
    if (scene.walls && solver == Solver::rattle)
        return problem(ErrorCode::inconsistent, {"the scene has", "/walls", -1, ""}, "",
                       "walls, but the solver \"rattle\" has joints alone, no contacts. Use \"soft\" or "
                       "\"auto\", or take the walls out.");
    if (scene.walls)
        if (auto found = find_roughness_problem({"the walls have", "/walls", -1, ""}, scene.walls->material,
                                                scene.gravity, solver))
            return found;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Item item{"body", "/bodies", static_cast<std::ptrdiff_t>(i), scene.bodies[i].name};
        if (auto found = find_solver_problem(item, scene.bodies[i], scene.gravity, solver)) return found;
    }
    return std::nullopt;
}

int default_substeps(Solver solver) {
    return solver == Solver::soft || solver == Solver::rattle ? 4 : 1;
}

}  // namespace carom
