#include "step/plan.hpp"

#include <carom/accuracy.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace carom {
namespace {

/// The kernels that a stage was given, in words.
template <class Real>
std::string name_of(KernelChoice choice, const Simulation<Real>& sim) {
    const std::string isa(sim.kernels->isa);
    const std::string radius = sim.world.bodies.radius.is_uniform() ? ", one radius" : ", radius a body";
    const Effects& effects = sim.world.effects;
    switch (choice) {
        case KernelChoice::isa:
            return isa;
        case KernelChoice::radius:
            return isa + radius;
        case KernelChoice::contacts:
            return isa + (effects.friction ? ", friction" : ", no friction") +
                   (effects.rolling_resistance ? ", rolling resistance" : "") + radius;
        case KernelChoice::scalar_f64:
            return "scalar, in double precision";
        default:
            return "";
    }
}

/// Coordinates are to differ by less than this share of half a body's thickness from one number to the next.
/// At 2e-3 a disc that rolls by 20 m is 8 cm off, at 0.016 1.2 m, and at 0.12 it stays where it is (B11).
constexpr double kCoarse = 1e-3;

/// Says of the body whose coordinates are the coarsest beside its size how coarse they are.
template <class Real>
void describe_precision(const WorldState<Real>& world, std::vector<std::string>& limits) {
    const Bodies<Real>& bodies = world.bodies;
    double worst = kCoarse;
    std::size_t worst_row = bodies.count;
    const auto step_at = [](Real x) {  // m, from this number to the next
        const Real magnitude = std::fabs(x);
        return static_cast<double>(std::nextafter(magnitude, std::numeric_limits<Real>::infinity()) -
                                   magnitude);
    };
    const auto farther = [&](std::size_t row) {
        return std::max(std::fabs(bodies.position_x[row]), std::fabs(bodies.position_y[row]));
    };
    for (std::size_t row = 0; row < bodies.count; ++row) {
        if (bodies.is_immovable(row)) continue;
        const double share = step_at(farther(row)) / static_cast<double>(bodies.inradius(row));
        if (share > worst) worst = share, worst_row = row;
    }
    if (worst_row == bodies.count) return;
    const bool is_single = sizeof(Real) == sizeof(float);
    char text[400];
    std::snprintf(
        text, sizeof text,
        "body %u is %.2g m from the origin, where coordinates in %s precision are %.2g m apart, %.2g %% "
        "of half its thickness: it may tremble, or not move at all where it is slow. %s",
        bodies.id[worst_row].index, static_cast<double>(farther(worst_row)), is_single ? "single" : "double",
        step_at(farther(worst_row)), 100 * worst,
        is_single ? "Use double precision, or an origin near the bodies" : "Use an origin near the bodies");
    limits.push_back(text);
}

/// Paths of contacts are solved with cubes of inverse masses, 1/kg³: from here to the inverse of it they are
/// numbers of single precision.
constexpr double kSmallestMassOfShapes = 1e-12;  // kg

/// Says of the body whose mass is the farthest beyond what contacts of shapes can be solved with.
template <class Real>
void describe_masses(const WorldState<Real>& world, std::vector<std::string>& limits) {
    const Bodies<Real>& bodies = world.bodies;
    if (!bodies.has_shapes || sizeof(Real) > sizeof(float)) return;
    double worst = kSmallestMassOfShapes;
    std::size_t worst_row = bodies.count;
    for (std::size_t row = 0; row < bodies.count; ++row) {
        if (bodies.is_immovable(row)) continue;
        const double mass = bodies.mass[row], share = std::fmin(mass, 1 / mass);
        if (share < worst) worst = share, worst_row = row;
    }
    if (worst_row == bodies.count) return;
    char text[400];
    std::snprintf(
        text, sizeof text,
        "body %u has a mass of %.2g kg; contacts of shapes are solved in single precision from %.0e "
        "to %.0e kg: beyond, bodies may sink into each other or fall through. Use double precision, "
        "or another unit of mass",
        bodies.id[worst_row].index, static_cast<double>(bodies.mass[worst_row]), kSmallestMassOfShapes,
        1 / kSmallestMassOfShapes);
    limits.push_back(text);
}

}  // namespace

template <class Real>
Plan describe_plan(Simulation<Real>& sim, const CalledEffects& called) {
    Plan plan;
    plan.solver = std::string(name_of(sim.solver()));
    plan.solver_reason = called.solver_reason;
    plan.substeps = std::max(sim.substeps_asked_for, sim.substeps_for_joints()),
    plan.iterations = sim.iterations();
    plan.precision = sizeof(Real) == sizeof(float) ? "float" : "double";
    plan.isa = std::string(sim.kernels->isa);
    plan.threads = sim.executor.threads();
    plan.effects = called.reports;
    plan.joints = sim.describe_joints();
    sim.report_stages([&](const StageState& stage) {
        if (stage.is_called_for)
            plan.stages.push_back({std::string(stage.name), name_of(stage.kernel, sim),
                                   std::string(stage.reads), std::string(stage.writes)});
    });
    sim.world.bodies.for_each_column([&](const char* name, const char* unit, auto& column) {
        plan.columns.push_back({name, unit, sizeof(column[0])});
        plan.bytes_per_body += sizeof(column[0]);
    });
    plan.shapes = sim.world.shapes.distinct();
    if (plan.shapes > 0) plan.bytes_per_shape = sizeof(ConvexShape<Real>);
    describe_precision(sim.world, plan.limits), describe_masses(sim.world, plan.limits);
    return plan;
}

template Plan describe_plan(Simulation<float>&, const CalledEffects&);
template Plan describe_plan(Simulation<double>&, const CalledEffects&);

}  // namespace carom
