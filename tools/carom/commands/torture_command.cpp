#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "commands.hpp"
#include "report/kinds/kinds.hpp"
#include "results/page_file.hpp"
#include "results/whole_file.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"
#include "terminal/interrupt.hpp"
#include "terminal/option_values.hpp"
#include "terminal/progress_bar.hpp"
#include "torture/case.hpp"
#include "torture/results.hpp"
#include "torture/rows.hpp"
#include "torture/run_tasks.hpp"
#include "torture/tables.hpp"

namespace carom::tool {
namespace {

namespace fs = std::filesystem;
using torture::Row;

constexpr std::int64_t kLargestNumber = 1'000'000;         // of scenes, steps, bodies
constexpr std::int64_t kLargestIndex = 1'000'000'000'000;  // of a random scene
constexpr double kLongestLimit = 1e5;                      // s

struct Torture {
    std::vector<std::string> cases;
    torture::Options options;
    std::int64_t jobs = std::max(1u, std::thread::hardware_concurrency());
    fs::path out = "out/torture";
    bool json = false;
    bool list = false;
};

std::vector<const torture::Case*> torture_cases_named(const std::vector<std::string>& names) {
    std::vector<const torture::Case*> chosen;
    std::vector<std::string_view> known;
    for (const torture::Case& each : torture::all_cases()) known.push_back(each.id);
    for (const std::string& name : names) known_value("case", name, known);
    for (const torture::Case& each : torture::all_cases())
        if (names.empty() || std::find(names.begin(), names.end(), each.id) != names.end())
            chosen.push_back(&each);
    return chosen;
}

void list_torture_cases() {
    for (const torture::Case& each : torture::all_cases())
        std::printf("%-10s  %s\n", std::string(each.id).c_str(), std::string(each.title).c_str());
}

std::vector<Row> rows_of(const Torture& asked, const torture::Case& of) {
    const std::vector<torture::Task> tasks = of.tasks(asked.options);
    ProgressBar bar(static_cast<std::int64_t>(tasks.size()), true, "run");
    std::vector<Row> rows = torture::run_tasks(
        tasks, static_cast<int>(asked.jobs),
        [&](std::size_t done) { bar.update(static_cast<std::int64_t>(done)); }, is_interrupted);
    if (!of.is_matrix) std::erase_if(rows, [](const Row& row) { return !row.has_run(); });
    return rows;
}

void make_torture_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw UsageError(joined("--out: ", folder.string(), ": ", error.message()));
}

int run_torture(const Torture& asked) {
    const std::vector<const torture::Case*> cases = torture_cases_named(asked.cases);
    if (asked.list) {
        list_torture_cases();
        return kDone;
    }
    make_torture_folder(asked.out);
    catch_interrupts();
    std::vector<Row> rows;
    for (const torture::Case* each : cases) {
        const std::vector<Row> found = rows_of(asked, *each);
        if (!asked.json) std::printf("%s\n", torture::table_of(*each, found).c_str());
        std::fflush(stdout);
        rows.insert(rows.end(), found.begin(), found.end());
    }
    const std::string text = torture::to_json(cases, rows, asked.options).dump(1) + '\n';
    const fs::path file = asked.out / "torture.json";
    write_whole_file(file, text);
    write_page(asked.out / "report.html", report::page_of({file}));
    if (asked.json) std::fwrite(text.data(), 1, text.size(), stdout);
    const auto failed =
        std::count_if(rows.begin(), rows.end(), [](const Row& row) { return row.has_failed(); });
    const auto ran = std::count_if(rows.begin(), rows.end(), [](const Row& row) { return row.has_run(); });
    if (!asked.json)
        std::printf("%td runs, %td failed. Results in %s: torture.json report.html\n", ran, failed,
                    asked.out.c_str());
    if (is_interrupted()) std::fprintf(stderr, "Interrupted: what had ended until then is in the result\n");
    return failed > 0 ? kDoubtful : kDone;
}

double time_limit(const std::string& text) {
    const double value = real_number("--limit", text);
    if (!(value > 0 && value <= kLongestLimit))
        throw UsageError(joined("--limit: \"", text, "\" is not a number of seconds above 0, up to ",
                                format("%g", kLongestLimit)));
    return value;
}

std::vector<Solver> solvers_named(const std::string& text) {
    const std::vector<std::string_view> known{"auto", "impulse", "soft", "event", "rattle", "pairwise"};
    std::vector<Solver> solvers;
    for (const std::string& name : split_at_commas(text))
        solvers.push_back(*solver_named(known_value("--solver", name, known)));
    return solvers;
}

std::vector<std::string> rows_named(const std::string& text) {
    const std::vector<std::string> names = torture::names_of_rows();
    const std::vector<std::string_view> known(names.begin(), names.end());
    std::vector<std::string> rows;
    for (const std::string& name : split_at_commas(text)) rows.push_back(known_value("--rows", name, known));
    return rows;
}

void add_numbers(CLI::App& command, const std::shared_ptr<Torture>& asked) {
    const auto add = [&](const char* option, const char* help, std::int64_t min, std::int64_t max, auto set) {
        command
            .add_option_function<std::string>(
                option, [=](const std::string& text) { set(whole_number(option, text, min, max)); }, help)
            ->type_name("N");
    };
    torture::Options& options = asked->options;  // lives as long as `asked`, which the callback holds
    add("--scenes", "Random scenes of `passive` (default 2000) and `random` (10000)", 1, kLargestNumber,
        [&options](std::int64_t value) { options.scenes = value; });
    add("--seed", "Seed of random scenes (default 1)", 0, INT64_MAX,
        [&options](std::int64_t value) { options.seed = static_cast<std::uint64_t>(value); });
    add("--only", "The random scene of that index alone", 0, kLargestIndex,
        [&options](std::int64_t value) { options.only = value; });
    add("--steps", "Steps of a run (default: the case's own)", 1, kLargestNumber,
        [&options](std::int64_t value) { options.steps = value; });
    add("--bodies", "Bodies of a crowd; of random scenes, at most (default: the case's own)", 10,
        kLargestNumber, [&options](std::int64_t value) { options.bodies = value; });
    add("--jobs", "Processes at a time (default: as many as processors)", 1, 1024,
        [asked](std::int64_t value) { asked->jobs = value; });
}

}  // namespace

void add_torture_command(CLI::App& program, Action& action) {
    CLI::App* const command =
        program.add_subcommand("torture", "Hard cases under every solver: pass or fail, with the number");
    auto asked = std::make_shared<Torture>();
    command->add_option("cases", asked->cases, "Cases (default: all; --list names them)")->type_name("CASE");
    command->add_option("--out", asked->out, "Folder of torture.json and report.html (default: out/torture)")
        ->type_name("DIR");
    add_numbers(*command, asked);
    command
        ->add_option_function<std::string>(
            "--solver", [asked](const std::string& text) { asked->options.solvers = solvers_named(text); },
            "Solvers, with commas between them (default: the case's own)")
        ->type_name("NAME");
    command
        ->add_option_function<std::string>(
            "--precision",
            [asked](const std::string& text) {
                const bool is_double = known_value("--precision", text, {"float", "double"}) == "double";
                asked->options.precision = is_double ? Precision::double_ : Precision::single_;
            },
            "float or double (default: the case's own)")
        ->type_name("NAME");
    command
        ->add_option_function<std::string>(
            "--limit", [asked](const std::string& text) { asked->options.limit = time_limit(text); },
            "Seconds of processor time after which a run is given up (default 20)")
        ->type_name("S");
    command
        ->add_option_function<std::string>(
            "--rows", [asked](const std::string& text) { asked->options.rows = rows_named(text); },
            "Codes of `hard`, names of `envelopes`, with commas between them (default: all)")
        ->type_name("NAME");
    command->add_flag("--quick", asked->options.is_quick,
                      "`hard` does a part of its long cases, `envelopes` tries their first values alone");
    command->add_flag_callback(
        "--no-joints", [asked] { asked->options.has_joints = false; },
        "`random` has lone bodies in place of mechanisms");
    command->add_flag("--json", asked->json, "Prints torture.json in place of the tables");
    command->add_flag("--list", asked->list, "Lists the cases and ends");
    command->callback([asked, &action] { action = [asked] { return run_torture(*asked); }; });
}

}  // namespace carom::tool
