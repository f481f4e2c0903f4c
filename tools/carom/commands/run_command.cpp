#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "commands.hpp"
#include "run/pictures.hpp"
#include "run/run_scene.hpp"
#include "run/summary_table.hpp"
#include "scene_file/scene_reader.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"
#include "terminal/interrupt.hpp"
#include "terminal/option_values.hpp"
#include "terminal/standard_output.hpp"

namespace carom::tool {
namespace {

struct Run {
    std::string scene;
    std::optional<std::string> out;
    RunSettings settings;
    RunChoices choices;
    PictureChoices pictures;
};

void print_results(const Run& asked, const Scene& scene, const Simulation& simulation,
                   const RunOutcome& outcome) {
    std::string text =
        joined(summary_table(outcome), body_table(scene, simulation), "\nResults in ", *asked.out, ":");
    for (const std::string& file : outcome.files) text.append(" ").append(file);
    text += "\n";
    if (!asked.choices.no_report)
        text +=
            joined("Open ", (std::filesystem::path(*asked.out) / "report.html").string(), " in a browser.\n");
    std::fwrite(text.data(), 1, text.size(), stdout);
}

int run(Run& asked) {
    check_pictures(asked.pictures, asked.choices.no_trajectory);
    Scene scene = read_scene(asked.scene);
    apply_settings(asked.settings, scene);
    if (scene.name.empty()) scene.name = std::filesystem::path(asked.scene).stem().string();
    if (!asked.out) asked.out = joined("out/", folder_name(scene.name));
    asked.choices.scene_text = text_of_file(asked.scene);

    asked.settings.machine.should_stop = &is_interrupted;
    const auto simulation = make_simulation(scene, asked.settings.machine);
    ResultFolder folder(*asked.out);
    catch_interrupts();
    const RunOutcome outcome = run_scene(scene, *simulation, folder, asked.choices);
    write_pictures(asked.pictures, folder.path() / "trajectory.h5");
    note_results_in(*asked.out);
    if (!asked.choices.quiet) print_results(asked, scene, *simulation, outcome);
    for (const std::string& message : outcome.messages) std::fprintf(stderr, "carom: %s\n", message.c_str());
    return outcome.quarantined.empty() && !outcome.given_up ? kDone : kDoubtful;
}

}  // namespace

void add_run_command(CLI::App& program, Action& action) {
    CLI::App* const command = program.add_subcommand("run", "Runs a scene and writes what happened");
    auto asked = std::make_shared<Run>();
    command->add_option("scene", asked->scene, "Scene file")->required()->type_name("SCENE.json");
    command->add_option("--out", asked->out, "Folder for the results (default: out/<scene name>)")
        ->type_name("DIR");
    add_settings_options(*command, asked->settings);
    add_picture_options(*command, asked->pictures);
    command->add_flag("--no-report", asked->choices.no_report, "Do not write report.html");
    add_page_size_option(*command, asked->choices.page_bytes);
    command->add_flag("--no-trajectory", asked->choices.no_trajectory, "Do not write trajectory.h5");
    command->add_flag("--events", asked->choices.events,
                      "Write events.csv: what came into sensors and left them, joints that broke");
    command->add_flag("--quiet", asked->choices.quiet, "Print nothing but errors");
    command->callback([asked, &action] { action = [asked] { return run(*asked); }; });
}

}  // namespace carom::tool
