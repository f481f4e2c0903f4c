#include <unistd.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>

#include "commands.hpp"
#include "measure/scaling.hpp"
#include "measure/text.hpp"
#include "report/kinds/kinds.hpp"
#include "results/page_file.hpp"
#include "results/whole_file.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"
#include "terminal/interrupt.hpp"
#include "terminal/option_values.hpp"

namespace carom::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kFewestBodies = 10;
constexpr std::int64_t kMostBodies = 10'000'000;  // about 2 GiB a world, and six worlds take turns
constexpr std::int64_t kMostRounds = 1000;

struct ScalingWish {
    std::int64_t max_bodies = 100'000;
    std::int64_t rounds = 5;
    fs::path out = "out/scaling";
};

void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw UsageError(joined("--out: ", folder.string(), ": ", error.message()));
}

int scaling(const ScalingWish& asked) {
    make_folder(asked.out);
    catch_interrupts();
    measure::ScalingOptions options;
    options.max_bodies = asked.max_bodies;
    options.contest.rounds = static_cast<int>(asked.rounds);
    options.is_interrupted = &is_interrupted;
    if (isatty(STDERR_FILENO) != 0)
        options.progress = [](std::int64_t bodies) {
            std::fprintf(stderr, "%s bodies ...\n", measure::grouped(bodies).c_str());
        };
    const std::vector<measure::ScalingRow> rows = measure::run_scaling(options);
    if (rows.empty()) return kDone;  // ended before anything was measured
    const measure::Json json = measure::scaling_json(rows);
    const fs::path data = asked.out / "scaling.json", page = asked.out / "scaling.html";
    write_whole_file(data, measure::result_text(json));
    write_page(page, report::page_of({data}));
    const std::string text = joined(measure::scaling_text(json), "\nResults in ", asked.out.string(),
                                    ": scaling.json scaling.html\n");
    std::fwrite(text.data(), 1, text.size(), stdout);
    return kDone;
}

}  // namespace

void add_scaling_command(CLI::App& program, Action& action) {
    CLI::App* const command = program.add_subcommand(
        "scaling",
        "Measures time a step against the number of bodies, beside loops over all pairs, and draws it");
    auto asked = std::make_shared<ScalingWish>();
    const auto add = [&](const char* option, const char* help, std::int64_t min, std::int64_t max, auto set) {
        command
            ->add_option_function<std::string>(
                option, [=](const std::string& text) { set(whole_number(option, text, min, max)); }, help)
            ->type_name("N");
    };
    add("--max-bodies", "The largest world (default 100000)", kFewestBodies, kMostBodies,
        [asked](std::int64_t value) { asked->max_bodies = value; });
    add("--rounds", "How often everything is timed (default 5)", 1, kMostRounds,
        [asked](std::int64_t value) { asked->rounds = value; });
    command
        ->add_option("--out", asked->out, "Folder for scaling.json and scaling.html (default: out/scaling)")
        ->type_name("DIR");
    command->callback([asked, &action] { action = [asked] { return scaling(*asked); }; });
}

}  // namespace carom::tool
