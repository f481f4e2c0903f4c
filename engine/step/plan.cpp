#include "step/plan.hpp"

#include <carom/accuracy.hpp>

#include <cmath>
#include <string>

#include "math/vec2_math.hpp"
#include "solvers/shared/stages.hpp"
#include "step/stage_info.hpp"

namespace carom {
namespace {

/// Decides one effect: forced, or called for by `what`, which is empty if nothing calls for it.
bool decide(std::vector<EffectReport>& reports, const char* name, const std::optional<bool>& forced,
            const std::string& what, const char* nothing) {
    const bool called = !what.empty();
    const bool on = forced.value_or(called);
    std::string reason = called ? what : nothing;
    if (forced && *forced && !called) reason = "forced on; " + reason;
    if (forced && !*forced) reason = "forced off";
    reports.push_back({name, on, reason});
    return on;
}

/// "body 3" or "body 3 ("ball")".
std::string label(const Scene& scene, std::size_t body) {
    const std::string& name = scene.bodies[body].name;
    return "body " + std::to_string(body) + (name.empty() ? "" : " (\"" + name + "\")");
}

/// The first body for which `calls` holds, as a reason; empty if there is none.
template <class Calls>
std::string first_body(const Scene& scene, const Calls& calls, const char* has) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        if (calls(scene.bodies[i])) return label(scene, i) + has;
    return {};
}

template <class Real>
bool has_anything_to_move(const Simulation<Real>& sim) {
    const Bodies<Real>& bodies = sim.world.bodies;
    if (sim.world.immovable_rows.size() < bodies.count) return true;
    for (const std::int32_t row : sim.world.immovable_rows)
        if (bodies.flags_of(static_cast<std::size_t>(row)) & kKinematic) return true;
    return false;
}

std::string number(double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
}

}  // namespace

CalledEffects call_effects(const Scene& scene, const EffectOverrides& overrides) {
    CalledEffects called;
    Effects& on = called.effects;
    auto& reports = called.reports;
    const auto either = [](const std::optional<bool>& first, const std::optional<bool>& second) {
        return first ? first : second;
    };
    const EffectOverrides& own = scene.effects;
    const Vec2 g = scene.gravity;
    on.gravity = decide(reports, "gravity", either(overrides.gravity, own.gravity),
                        g == Vec2{} ? "" : "gravity is (" + number(g.x) + ", " + number(g.y) + ") m/s²",
                        "gravity is zero");
    const auto drag = either(overrides.drag, own.drag);
    on.drag = decide(reports, "drag", drag,
                     scene.drag.linear > 0 ? "linear drag is " + number(scene.drag.linear) + " 1/s" : "",
                     "linear drag is zero");
    on.walls =
        decide(reports, "walls", {}, scene.walls ? "the scene has walls" : "", "the scene has no walls");
    std::string bounces = first_body(
        scene, [](const Body& b) { return b.material.restitution > 0; }, " has a restitution above zero");
    if (bounces.empty() && scene.walls && scene.walls->material.restitution > 0)
        bounces = "the walls have a restitution above zero";
    on.restitution = decide(reports, "restitution", either(overrides.restitution, own.restitution), bounces,
                            "every restitution is zero");
    std::string rubs = first_body(
        scene, [](const Body& b) { return b.material.friction > 0; }, " has friction");
    std::string resists = first_body(
        scene, [](const Body& b) { return b.material.rolling_resistance > 0; }, " has rolling resistance");
    if (resists.empty() && scene.walls && scene.walls->material.rolling_resistance > 0)
        resists = "the walls have rolling resistance";
    const auto rolling = either(overrides.rolling_resistance, own.rolling_resistance);
    if (rubs.empty() && (!resists.empty() || rolling == true))
        rubs = "rolling resistance needs contacts that turn bodies";
    on.friction = decide(reports, "friction", either(overrides.friction, own.friction), rubs,
                         "every friction coefficient is zero");
    on.rolling_resistance =
        decide(reports, "rolling resistance", rolling, resists, "every rolling resistance is zero");
    std::string turns = first_body(
        scene, [](const Body& b) { return b.angular_velocity != 0 || b.angle != 0; },
        " has an angle or a spin");
    if (turns.empty() && on.friction) turns = "friction turns bodies";
    on.rotation = decide(reports, "rotation", either(overrides.rotation, own.rotation), turns,
                         "no body has an angle or a spin, and nothing can give one");
    on.angular_drag = decide(reports, "angular drag", {},
                             on.rotation && scene.drag.angular > 0
                                 ? "angular drag is " + number(scene.drag.angular) + " 1/s and bodies turn"
                                 : "",
                             scene.drag.angular > 0 ? "nothing turns" : "angular drag is zero");
    decide(reports, "continuous collision", {}, "every solver looks ahead over the whole step", "");
    on.ledger = decide(reports, "ledger", either(overrides.ledger, own.ledger), "", "not asked for");
    decide(reports, "joints", {}, "", "the scene has no joints");
    on.sleeping = decide(reports, "sleeping", either(overrides.sleep, own.sleep), "", "not asked for");
    return called;
}

namespace {

/// Substeps of solver `soft`: so many that a body falls at most this share of the smallest radius from rest
/// in one, because contacts are looked at once a substep.
constexpr double kLargestFall = 0.005;

template <class Real>
int substeps_against_gravity(const Simulation<Real>& sim, double dt) {
    const Bodies<Real>& bodies = sim.world.bodies;
    double smallest = sim.candidates.smallest_radius();
    if (!(smallest > 0)) {
        smallest = bodies.radius[0];
        for (std::size_t row = 1; row < bodies.count && !bodies.radius.is_uniform(); ++row)
            smallest = std::fmin(smallest, bodies.radius[row]);
    }
    const double gravity = std::sqrt(length_squared(sim.world.gravity));
    return static_cast<int>(std::ceil(dt * std::sqrt(0.5 * gravity / (kLargestFall * smallest))));
}

}  // namespace

template <class Real>
StepPlan<Real> make_step_plan(const Simulation<Real>& sim, double dt) {
    StepPlan<Real> plan;
    if (!has_anything_to_move(sim)) return plan;
    const WorldState<Real>& world = sim.world;
    // Strong drag: more substeps, so that the series of effects/flight.hpp stay exact.
    const double largest_drag = std::fmax(world.drag.linear, world.drag.angular);
    const int substeps = std::max(sim.substeps_asked_for,
                                  static_cast<int>(std::ceil(dt * largest_drag / kLargestDragTimesStep)));
    const bool can_meet = world.bodies.rows() > 1 || world.effects.walls;
    if (sim.solver == Solver::event) {
        plan.flights = 1;
        plan.run_events = run_events<Real>;
        return plan;
    }
    plan.begin_flight = begin_flight<Real>;
    if (sim.solver == Solver::soft) {
        plan.flights = 1;
        plan.contact_substeps = std::max(substeps, substeps_against_gravity(sim, dt));
        plan.begin_substeps = begin_substeps<Real>;
        plan.advance_bodies = advance_bodies<Real>;
        plan.end_substeps = end_substeps<Real>;
        if (world.effects.ledger) plan.book_displacements = book_displacements<Real>;
        if (world.effects.ledger || world.effects.walls) plan.book_substep = book_substep<Real>;
        if (!can_meet) return plan;
        plan.sort_rows = sort_rows<Real>;
        plan.update_candidates = update_candidates<Real>;
        plan.update_contacts = update_contacts<Real>;
        plan.find_contacts = find_contacts<Real>;
        plan.solve_contacts = solve_contacts<Real>;
        plan.end_contacts = end_contacts<Real>;
        if (world.effects.sleeping)
            plan.wake_sleepers = wake_sleepers<Real>, plan.put_to_sleep = put_to_sleep<Real>;
        return plan;
    }
    plan.flights = substeps;
    plan.end_flight = end_flight<Real>;
    if (can_meet) {
        plan.find_impacts = find_impacts<Real>;
        plan.settle_contacts = settle_contacts<Real>;
        plan.resolve_impacts = resolve_impacts<Real>;
        plan.sort_rows = sort_rows<Real>;
        plan.update_candidates = update_candidates<Real>;
    }
    if (world.effects.ledger) plan.keep_books = keep_books<Real>;
    if (world.effects.rotation) plan.advance_rotation = advance_rotation<Real>;
    return plan;
}

template <class Real>
Plan describe_plan(Simulation<Real>& sim, const CalledEffects& called) {
    Plan plan;
    plan.solver = std::string(name_of(sim.solver));
    plan.solver_reason = called.solver_reason;
    plan.substeps = sim.substeps_asked_for;
    plan.precision = sizeof(Real) == sizeof(float) ? "float" : "double";
    plan.isa = std::string(sim.kernels->isa);
    plan.threads = sim.executor.threads();
    plan.effects = called.reports;

    const StepPlan<Real> stages = make_step_plan(sim, 0);
    const bool uniform = sim.world.bodies.radius.is_uniform();
    const std::string variant = uniform ? ", one radius" : ", radius a body";
    const auto list = [&](auto stage, StageName name, const std::string& kernel) {
        if (!stage) return;
        const StageInfo& info = info_of(name);
        plan.stages.push_back(
            {std::string(info.name), kernel, std::string(info.reads), std::string(info.writes)});
    };
    list(stages.sort_rows, StageName::sort_rows, "");
    list(stages.begin_flight, StageName::begin_flight, plan.isa + variant);
    list(stages.update_candidates, StageName::update_candidates, plan.isa);
    list(stages.wake_sleepers, StageName::wake_sleepers, "");
    list(stages.find_impacts, StageName::find_impacts, plan.isa + variant);
    list(stages.settle_contacts, StageName::settle_contacts, "");
    list(stages.resolve_impacts, StageName::resolve_impacts, "");
    list(stages.keep_books, StageName::keep_books, "");
    list(stages.advance_rotation, StageName::advance_rotation, plan.isa);
    list(stages.end_flight, StageName::end_flight, plan.isa);
    list(stages.run_events, StageName::run_events, "scalar, in double precision");
    const std::string contact = plan.isa + (sim.world.effects.friction ? ", friction" : ", no friction") +
                                (sim.world.effects.rolling_resistance ? ", rolling resistance" : "") +
                                variant;
    list(stages.update_contacts, StageName::update_contacts, "");
    list(stages.begin_substeps, StageName::begin_substeps, plan.isa);
    list(stages.find_contacts, StageName::find_contacts, contact);
    list(stages.solve_contacts, StageName::solve_contacts, contact);
    list(stages.advance_bodies, StageName::advance_bodies, plan.isa);
    list(stages.book_substep, StageName::book_substep, "");
    list(stages.end_contacts, StageName::end_contacts, "");
    list(stages.end_substeps, StageName::end_substeps, plan.isa);
    list(stages.book_displacements, StageName::book_displacements, "");
    list(stages.put_to_sleep, StageName::put_to_sleep, "");

    sim.world.bodies.for_each_column([&](const char* name, const char* unit, auto& column) {
        plan.columns.push_back({name, unit, sizeof(column[0])});
        plan.bytes_per_body += sizeof(column[0]);
    });
    return plan;
}

template StepPlan<float> make_step_plan(const Simulation<float>&, double);
template StepPlan<double> make_step_plan(const Simulation<double>&, double);
template Plan describe_plan(Simulation<float>&, const CalledEffects&);
template Plan describe_plan(Simulation<double>&, const CalledEffects&);

}  // namespace carom
