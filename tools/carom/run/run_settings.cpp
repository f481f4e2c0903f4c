#include "run_settings.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <string_view>

#include "scene_file/scene_reader.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"
#include "terminal/option_values.hpp"

namespace carom::tool {
namespace {

struct EffectName {
    std::string_view name;
    std::optional<bool> EffectOverrides::*wish;
};

constexpr std::array<EffectName, 9> kEffects{{
    {"sleep", &EffectOverrides::sleep},
    {"continuous", &EffectOverrides::continuous},
    {"ledger", &EffectOverrides::ledger},
    {"gravity", &EffectOverrides::gravity},
    {"drag", &EffectOverrides::drag},
    {"rotation", &EffectOverrides::rotation},
    {"restitution", &EffectOverrides::restitution},
    {"friction", &EffectOverrides::friction},
    {"rolling_resistance", &EffectOverrides::rolling_resistance},
}};

constexpr int kMostThreads = 1024;
constexpr std::int64_t kMostSteps = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMostParts = 1024;  // substeps and iterations, as <carom/accuracy.hpp> says

/// One wish of a list such as "+ledger,-drag".
void add_effect(const std::string& wish, EffectOverrides& effects) {
    constexpr const char* kOption = "--effects";
    if (wish.empty() || (wish[0] != '+' && wish[0] != '-'))
        throw UsageError(joined(kOption, ": \"", wish,
                                "\" does not start with + or -; expected a list such as +ledger,-drag"));
    std::vector<std::string_view> names;
    for (const EffectName& effect : kEffects) names.push_back(effect.name);
    const std::string name = known_value(kOption, wish.substr(1), names);
    const auto effect = std::find_if(kEffects.begin(), kEffects.end(),
                                     [&name](const EffectName& known) { return known.name == name; });
    const bool on = wish[0] == '+';
    if (effects.*effect->wish == !on)
        throw UsageError(joined(kOption, ": ", name, " is asked for both on and off"));
    effects.*effect->wish = on;
}

/// Adds an option whose text `read` turns into a setting.
void add(CLI::App& command, const char* option, const char* value, const char* help,
         std::function<void(const std::string&)> read) {
    command.add_option_function<std::string>(option, read, help)->type_name(value);
}

void add_accuracy_options(CLI::App& command, RunSettings& settings) {
    add(command, "--solver", "NAME", "auto, impulse, soft, event, rattle or pairwise",
        [&settings](const std::string& text) {
            known_value("--solver", text,
                        {"auto", "pairwise", "impulse", "soft", "rigid", "event", "rattle"});
            settings.solver = solver_named(text);
        });
    add(command, "--substeps", "N", "Parts a step is cut into", [&settings](const std::string& text) {
        settings.substeps = static_cast<int>(whole_number("--substeps", text, 1, kMostParts));
    });
    add(command, "--iterations", "N", "Sweeps over the contacts a substep (solver soft)",
        [&settings](const std::string& text) {
            settings.iterations = static_cast<int>(whole_number("--iterations", text, 1, kMostParts));
        });
    add(command, "--precision", "NAME", "float or double", [&settings](const std::string& text) {
        known_value("--precision", text, {"float", "double"});
        settings.precision = text == "float" ? Precision::single_ : Precision::double_;
    });
}

}  // namespace

void add_settings_options(CLI::App& command, RunSettings& settings) {
    add(command, "--steps", "N", "Steps to take", [&settings](const std::string& text) {
        settings.steps = whole_number("--steps", text, 0, kMostSteps);
    });
    add(command, "--dt", "S", "Step length in seconds",
        [&settings](const std::string& text) { settings.dt = real_number("--dt", text); });
    add_accuracy_options(command, settings);
    add(command, "--threads", "N", "Threads; results do not depend on it (0: all)",
        [&settings](const std::string& text) {
            settings.machine.threads = static_cast<int>(whole_number("--threads", text, 0, kMostThreads));
        });
    command.add_option("--isa", settings.machine.isa, "Instruction set: auto, scalar, sse2, avx2, avx512")
        ->type_name("NAME");
    add(command, "--effects", "LIST",
        "Effects to force on or off, as in +ledger,-drag; the rest is what the scene calls for",
        [&settings](const std::string& text) {
            for (const std::string& wish : split_at_commas(text)) add_effect(wish, settings.effects);
        });
}

void apply_settings(const RunSettings& settings, Scene& scene) {
    if (settings.steps) scene.step.count = *settings.steps;
    if (settings.dt) scene.step.dt = *settings.dt;
    if (settings.solver) scene.accuracy.solver = *settings.solver;
    if (settings.substeps) scene.accuracy.substeps = settings.substeps;
    if (settings.iterations) scene.accuracy.iterations = settings.iterations;
    if (settings.precision) scene.accuracy.precision = *settings.precision;
    if (settings.precision == Precision::single_ && scene.accuracy.solver == Solver::pairwise)
        throw UsageError("--precision: the naive engine (solver pairwise) computes in double only");
    for (const EffectName& effect : kEffects)
        if (settings.effects.*effect.wish) scene.effects.*effect.wish = settings.effects.*effect.wish;
    if (!scene.effects.ledger) scene.effects.ledger = true;
}

Scene read_measured_scene(const std::string& file, const RunSettings& settings) {
    Scene scene = read_scene(file);
    const bool ledger_unasked = !scene.effects.ledger && !settings.effects.ledger;
    apply_settings(settings, scene);
    if (ledger_unasked) scene.effects.ledger.reset();
    if (scene.name.empty()) scene.name = std::filesystem::path(file).stem().string();
    return scene;
}

}  // namespace carom::tool
