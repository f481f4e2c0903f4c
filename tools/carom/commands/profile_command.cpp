#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>
#include <string>

#include "commands.hpp"
#include "profiling/profile_run.hpp"
#include "results/whole_file.hpp"
#include "run/run_settings.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/interrupt.hpp"

namespace carom::tool {
namespace {

struct ProfileWish {
    std::string scene;
    RunSettings settings;
    std::optional<std::string> trace;
    std::optional<std::string> out;
    bool json = false;
};

int profile(const ProfileWish& asked) {
    const Scene scene = read_measured_scene(asked.scene, asked.settings);
    catch_interrupts();
    Trace trace;
    const measure::Json json = profile_scene(scene, asked.settings.machine, asked.trace ? &trace : nullptr);
    if (asked.trace) write_whole_file(*asked.trace, trace.text(scene.name));
    if (asked.out) write_whole_file(*asked.out, measure::result_text(json));
    const std::string text = asked.json ? measure::result_text(json) : profile_text(json);
    std::fwrite(text.data(), 1, text.size(), stdout);
    if (asked.trace && trace.steps() == Trace::kMostSteps)
        std::fprintf(stderr, "carom: the trace ends after %lld steps\n",
                     static_cast<long long>(Trace::kMostSteps));
    return kDone;
}

}  // namespace

void add_profile_command(CLI::App& program, Action& action) {
    CLI::App* const command = program.add_subcommand("profile",
                                                     "Runs a scene and says by stage what it takes, how near "
                                                     "the machine's limits that is, and what limits it");
    auto asked = std::make_shared<ProfileWish>();
    command->add_option("scene", asked->scene, "Scene file")->required()->type_name("SCENE.json");
    command
        ->add_option("--trace", asked->trace,
                     "Also write the times of every step, for Perfetto or about:tracing")
        ->type_name("FILE.json");
    command->add_option("--out", asked->out, "Also write the profile as a result file, for carom report")
        ->type_name("FILE.json");
    command->add_flag("--json", asked->json, "Print it as JSON");
    add_settings_options(*command, asked->settings);
    command->callback([asked, &action] { action = [asked] { return profile(*asked); }; });
}

}  // namespace carom::tool
