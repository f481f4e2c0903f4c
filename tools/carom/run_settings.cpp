#include "run_settings.hpp"

#include <array>
#include <string_view>

#include "exit_codes.hpp"
#include "format.hpp"

namespace carom::tool {
namespace {

struct EffectName {
    std::string_view name;
    std::optional<bool> EffectOverrides::*wish;
};

constexpr int kMostThreads = 1024;

constexpr std::array<EffectName, 7> kEffects{{
    {"sleep", &EffectOverrides::sleep},
    {"continuous", &EffectOverrides::continuous},
    {"ledger", &EffectOverrides::ledger},
    {"gravity", &EffectOverrides::gravity},
    {"drag", &EffectOverrides::drag},
    {"rotation", &EffectOverrides::rotation},
    {"restitution", &EffectOverrides::restitution},
}};

void apply_effect(const std::string& wish, EffectOverrides& effects, EffectOverrides& wished) {
    const std::string_view name = std::string_view(wish).substr(wish.empty() ? 0 : 1);
    if (wish.empty() || (wish[0] != '+' && wish[0] != '-'))
        throw UsageError(joined("--effects: \"", wish,
                                "\" does not start with + or -; expected, for example, +ledger,-drag"));
    std::string known;
    for (const EffectName& effect : kEffects) {
        known.append(known.empty() ? "" : ", ").append(effect.name);
        if (effect.name != name) continue;
        const bool on = wish[0] == '+';
        if (wished.*effect.wish == !on)
            throw UsageError(joined("--effects: ", name, " is asked for both on and off"));
        effects.*effect.wish = wished.*effect.wish = on;
        return;
    }
    throw UsageError(
        joined("--effects: there is no effect \"", name, "\" to force on or off; known are ", known));
}

}  // namespace

void add_settings_options(CLI::App& command, RunSettings& settings) {
    command.add_option("--steps", settings.steps, "Steps to take")
        ->type_name("N")
        ->check(CLI::NonNegativeNumber);
    command.add_option("--dt", settings.dt, "Step length in seconds")->type_name("S");
    command.add_option("--solver", settings.solver, "auto, impulse or pairwise")->type_name("NAME");
    command.add_option("--substeps", settings.substeps, "Parts a step is cut into")->type_name("N");
    command.add_option("--iterations", settings.iterations, "Passes of the solver")->type_name("N");
    command.add_option("--precision", settings.precision, "float or double")->type_name("NAME");
    command
        .add_option("--threads", settings.machine.threads, "Threads; results do not depend on it (0: all)")
        ->type_name("N")
        ->check(CLI::Range(0, kMostThreads));
    command.add_option("--isa", settings.machine.isa, "Instruction set: auto, scalar, sse2, avx2, avx512")
        ->type_name("NAME");
    command
        .add_option("--effects", settings.effects,
                    "Effects to force on or off, as in +ledger,-drag; the rest is what the scene calls for")
        ->type_name("LIST")
        ->delimiter(',')
        ->expected(1)
        ->take_all();
}

void apply_settings(const RunSettings& settings, Scene& scene) {
    if (settings.steps) scene.step.count = *settings.steps;
    if (settings.dt) scene.step.dt = *settings.dt;
    if (settings.solver) {
        const std::optional<Solver> solver = solver_named(*settings.solver);
        if (!solver)
            throw UsageError(joined("--solver: there is no solver \"", *settings.solver,
                                    "\"; expected auto, impulse or pairwise"));
        scene.accuracy.solver = *solver;
    }
    if (settings.substeps) scene.accuracy.substeps = settings.substeps;
    if (settings.iterations) scene.accuracy.iterations = settings.iterations;
    if (settings.precision) {
        if (*settings.precision != "float" && *settings.precision != "double")
            throw UsageError(
                joined("--precision: \"", *settings.precision, "\" is none; expected float or double"));
        if (*settings.precision == "float" && scene.accuracy.solver == Solver::pairwise)
            throw UsageError("--precision: the naive engine (solver pairwise) computes in double only");
        scene.accuracy.precision = *settings.precision == "float" ? Precision::single_ : Precision::double_;
    }
    EffectOverrides wished;
    for (const std::string& wish : settings.effects) apply_effect(wish, scene.effects, wished);
    if (!scene.effects.ledger) scene.effects.ledger = true;
}

}  // namespace carom::tool
