#include <carom/version.hpp>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.hpp"
#include "results/plan_json.hpp"
#include "run/run_settings.hpp"
#include "scene_file/printable.hpp"
#include "scene_file/scene_reader.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"

namespace carom::tool {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kIndent = 2;  // spaces

struct Explain {
    std::string scene;
    RunSettings settings;
    bool json = false;
};

Json to_json(const Plan& plan, const std::string& scene, std::size_t bodies) {
    Json json{{"scene", scene}, {"version", kVersion}, {"bodies", bodies}};
    json.update(plan_json(plan));
    return json;
}

std::string to_text(const Plan& plan, const std::string& scene, std::size_t bodies) {
    std::string text = format(
        "%s: %zu bodies\n\nsolver     %s (%s)\nsubsteps   %d\niterations %d\nprecision  %s\nisa        "
        "%s\nthreads    %d\n",
        printable(scene).c_str(), bodies, plan.solver.c_str(), plan.solver_reason.c_str(), plan.substeps,
        plan.iterations, plan.precision.c_str(), plan.isa.c_str(), plan.threads);
    if (!plan.joints.empty()) text += format("joints     %s\n", plan.joints.c_str());
    text += "\neffects\n";
    for (const EffectReport& effect : plan.effects)
        text += format("  %-3s  %-20s  %s\n", effect.on ? "on" : "off", effect.name.c_str(),
                       effect.reason.c_str());
    text += "\nstages: what each reads -> writes\n";
    std::size_t longest = 0;
    for (const StageReport& stage : plan.stages) longest = std::max(longest, stage.name.size());
    const auto width = static_cast<int>(longest);
    for (const StageReport& stage : plan.stages) {
        text += format("  %-*s  %s -> %s\n", width, stage.name.c_str(), stage.reads.c_str(),
                       stage.writes.c_str());
        if (!stage.kernel.empty()) text += format("  %-*s  kernel: %s\n", width, "", stage.kernel.c_str());
    }
    text += format("\ncolumns: %zu bytes a body\n", plan.bytes_per_body);
    for (const ColumnReport& column : plan.columns)
        text +=
            format("  %-20s  %4zu  %s\n", column.name.c_str(), column.bytes_per_body, column.unit.c_str());
    if (plan.shapes > 0)
        text += format("\nshapes: %zu distinct, %zu bytes each\n", plan.shapes, plan.bytes_per_shape);
    for (const std::string& limit : plan.limits) text += format("\nlimit: %s\n", limit.c_str());
    return text;
}

/// The ledger is the one effect that `carom run` turns on unasked: its reason is not in the scene.
void explain_ledger(Plan& plan) {
    for (EffectReport& effect : plan.effects)
        if (effect.name == "ledger") effect.reason = "carom run keeps it; --effects -ledger leaves it out";
}

int explain(const Explain& asked) {
    Scene scene = read_scene(asked.scene);
    const bool ledger_unasked = !scene.effects.ledger && !asked.settings.effects.ledger;
    apply_settings(asked.settings, scene);
    Plan plan = make_simulation(scene, asked.settings.machine)->plan();
    if (ledger_unasked) explain_ledger(plan);
    const std::string name = scene.name.empty() ? asked.scene : scene.name;
    std::string text = asked.json ? to_json(plan, name, scene.bodies.size())
                                        .dump(kIndent, ' ', false, Json::error_handler_t::replace)
                                  : to_text(plan, name, scene.bodies.size());
    if (asked.json) text += '\n';
    std::fwrite(text.data(), 1, text.size(), stdout);
    return kDone;
}

}  // namespace

void add_explain_command(CLI::App& program, Action& action) {
    CLI::App* const command = program.add_subcommand(
        "explain", "Says what a scene calls for and why: effects, stages, kernels, columns, bytes a body");
    auto asked = std::make_shared<Explain>();
    command->add_option("scene", asked->scene, "Scene file")->required()->type_name("SCENE.json");
    command->add_flag("--json", asked->json, "As JSON");
    add_settings_options(*command, asked->settings);
    command->callback([asked, &action] { action = [asked] { return explain(*asked); }; });
}

}  // namespace carom::tool
