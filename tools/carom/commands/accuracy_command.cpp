#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "accuracy/analysis.hpp"
#include "accuracy/cases.hpp"
#include "accuracy/engines.hpp"
#include "accuracy/session.hpp"
#include "commands.hpp"
#include "report/kinds/kinds.hpp"
#include "results/page_file.hpp"
#include "results/text_file.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"
#include "terminal/interrupt.hpp"
#include "terminal/option_values.hpp"
#include "terminal/progress_bar.hpp"
#include "terminal/standard_output.hpp"

namespace carom::tool {
namespace {

namespace fs = std::filesystem;
using accuracy::Case;
using accuracy::CaseResult;

struct Accuracy {
    std::vector<std::string> cases;
    fs::path out = "out/accuracy";
    bool quick = false;
    bool json = false;
    bool list = false;
};

std::vector<const Case*> cases_named(const std::vector<std::string>& names) {
    std::vector<const Case*> chosen;
    std::vector<std::string_view> known;
    for (const Case& each : accuracy::all_cases()) known.push_back(each.id);
    for (const std::string& name : names) known_value("case", name, known);
    for (const Case& each : accuracy::all_cases())
        if (names.empty() || std::find(names.begin(), names.end(), each.id) != names.end())
            chosen.push_back(&each);
    return chosen;
}

void list_cases() {
    for (const Case& each : accuracy::all_cases())
        std::printf("%-10s  %-24s  %s\n", std::string(each.id).c_str(), std::string(each.kind).c_str(),
                    std::string(each.title).c_str());
}

/// Under a temporary name, then renamed: a result that is there is whole.
void write_text(const fs::path& path, const std::string& text) {
    const fs::path temporary = path.string() + ".part";
    {
        TextFile file(temporary);
        file.write(text);
        file.close();
    }
    std::error_code error;
    fs::rename(temporary, path, error);
    if (error) throw WriteError(joined(path.string(), ": ", error.message()));
}

/// Cheapest way to 1 %, 0.1 %, 0.01 % for each case.
void print_table(const std::vector<CaseResult>& results) {
    for (const CaseResult& result : results) {
        std::printf("%s  %s\n", std::string(result.of->id).c_str(), std::string(result.of->title).c_str());
        for (const double target : accuracy::kTargets) {
            const accuracy::Point* best = accuracy::cheapest(result, target);
            std::printf(
                "  %5g %%  %s\n", 100 * target,
                best ? joined(seconds_text(best->seconds.value), "  ", accuracy::in_words(best->setting))
                           .c_str()
                     : "nobody");
        }
    }
}

int run_accuracy(const Accuracy& asked) {
    const std::vector<const Case*> cases = cases_named(asked.cases);
    if (asked.list) {
        list_cases();
        return kDone;
    }
    catch_interrupts();
    const accuracy::Request request{cases, asked.quick, asked.out};
    accuracy::Measured measured;
    {
        std::unique_ptr<ProgressBar> bar;
        measured = accuracy::measure_all(
            request,
            [&](const accuracy::Progress& progress) {
                if (!bar) bar = std::make_unique<ProgressBar>(progress.total, true, "point");
                bar->update(progress.done);
            },
            is_interrupted);
    }
    if (!measured.is_complete) {
        std::fprintf(stderr, "Interrupted. The same command goes on from here; what was measured is in %s\n",
                     asked.out.c_str());
        return kDone;
    }
    const accuracy::Json json = accuracy::to_json(measured.results, asked.quick);
    const fs::path file = asked.out / "accuracy.json";
    write_text(file, json.dump(1) + '\n');
    write_text(asked.out / "accuracy.csv", accuracy::to_csv(measured.results));
    write_page(asked.out / "report.html", report::page_of({file}));
    accuracy::forget_points(asked.out);
    note_results_in(asked.out);
    if (asked.json) {
        const std::string text = json.dump(1) + '\n';
        std::fwrite(text.data(), 1, text.size(), stdout);
        return kDone;
    }
    print_table(measured.results);
    std::printf("\n");
    for (const accuracy::Json& advice : json.at("advice"))
        std::printf("%s\n", advice.get_ref<const std::string&>().c_str());
    for (const bench::MissingEngine& missing : bench::missing_engines())
        std::printf("Not in it: %s, because %s.\n", missing.family.c_str(), missing.why.c_str());
    std::printf("\nResults in %s: accuracy.json accuracy.csv report.html\n", asked.out.c_str());
    return kDone;
}

}  // namespace

void add_accuracy_command(CLI::App& program, Action& action) {
    CLI::App* const command =
        program.add_subcommand("accuracy", "Error against time: all solvers, on cases whose answer is known");
    auto asked = std::make_shared<Accuracy>();
    command->add_option("cases", asked->cases, "Cases (default: all; --list names them)")->type_name("CASE");
    command->add_option("--out", asked->out, "Folder of the results (default: out/accuracy)")
        ->type_name("DIR");
    command->add_flag("--quick", asked->quick, "Fewer settings, starts and runs: below a minute");
    command->add_flag("--json", asked->json, "Prints accuracy.json in place of the tables");
    command->add_flag("--list", asked->list, "Lists the cases and ends");
    command->callback([asked, &action] { action = [asked] { return run_accuracy(*asked); }; });
}

}  // namespace carom::tool
