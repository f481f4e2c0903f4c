#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>
#include <string>

#include "commands.hpp"
#include "pricing/measure_prices.hpp"
#include "results/whole_file.hpp"
#include "run/run_settings.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/interrupt.hpp"
#include "terminal/option_values.hpp"

namespace carom::tool {
namespace {

constexpr std::int64_t kMostRepeats = 1000;

struct PricesWish {
    std::string scene;
    RunSettings settings;
    PriceOptions options;
    std::optional<std::string> out;
    bool json = false;
};

int prices(const PricesWish& asked) {
    const Scene scene = read_measured_scene(asked.scene, asked.settings);
    catch_interrupts();
    PriceOptions options = asked.options;
    options.machine = asked.settings.machine;
    const measure::Json json = measure_prices(scene, options);
    if (asked.out) write_whole_file(*asked.out, measure::result_text(json));
    const std::string text = asked.json ? measure::result_text(json) : prices_text(json);
    std::fwrite(text.data(), 1, text.size(), stdout);
    return kDone;
}

}  // namespace

void add_prices_command(CLI::App& program, Action& action) {
    CLI::App* const command = program.add_subcommand(
        "prices", "Measures what each effect costs: the scene with it and without it, in turns");
    auto asked = std::make_shared<PricesWish>();
    asked->settings.machine.threads = 1;  // processor time says more than the clock on the wall
    command->add_option("scene", asked->scene, "Scene file")->required()->type_name("SCENE.json");
    command
        ->add_option_function<std::string>(
            "--repeats",
            [asked](const std::string& text) {
                asked->options.repeats = static_cast<int>(whole_number("--repeats", text, 1, kMostRepeats));
            },
            "Turns of each side of a comparison (default: 11)")
        ->type_name("N");
    command->add_option("--out", asked->out, "Also write the prices as a result file, for carom report")
        ->type_name("FILE.json");
    command->add_flag("--json", asked->json, "Print it as JSON");
    add_settings_options(*command, asked->settings);
    command->callback([asked, &action] { action = [asked] { return prices(*asked); }; });
}

}  // namespace carom::tool
