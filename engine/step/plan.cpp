#include "step/plan.hpp"

#include <carom/accuracy.hpp>

#include <algorithm>
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
    return plan;
}

template Plan describe_plan(Simulation<float>&, const CalledEffects&);
template Plan describe_plan(Simulation<double>&, const CalledEffects&);

}  // namespace carom
