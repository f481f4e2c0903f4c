#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "commands.hpp"
#include "report/kinds/kinds.hpp"
#include "results/page_file.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"
#include "terminal/option_values.hpp"
#include "terminal/standard_output.hpp"

namespace carom::tool {
namespace {

namespace fs = std::filesystem;

struct Report {
    std::vector<fs::path> files;
    std::optional<fs::path> out;
    std::size_t page_bytes = report::kDefaultPageBytes;
};

/// Where the page goes unless it is said: into the folder of the run, if that is what is drawn.
fs::path default_out(const Report& asked) {
    std::error_code ignored;
    if (asked.files.size() == 1 && fs::is_directory(asked.files[0], ignored))
        return asked.files[0] / "report.html";
    throw UsageError("--out: say where the page shall go, as in --out page.html");
}

int report(const Report& asked) {
    const fs::path out = asked.out ? *asked.out : default_out(asked);
    try {
        write_page(out, report::page_of(asked.files, asked.page_bytes));
    } catch (const report::ResultError& error) {
        throw UsageError(error.what());
    } catch (const WriteError& error) {
        throw OutputError(error.what());
    }
    note_results_in(out);
    std::printf("Report in %s\n", out.c_str());
    return kDone;
}

}  // namespace

void add_report_command(CLI::App& program, Action& action) {
    CLI::App* const command =
        program.add_subcommand("report", "Draws result files, or the results of a run, as one HTML page");
    auto asked = std::make_shared<Report>();
    command->add_option("files", asked->files, "Result files, or the folder of a run")
        ->required()
        ->type_name("FILE.json|RUN_DIR");
    command->add_option("--out", asked->out, "The page (default for the folder of a run: report.html in it)")
        ->type_name("FILE.html");
    add_page_size_option(*command, asked->page_bytes);
    command->callback([asked, &action] { action = [asked] { return report(*asked); }; });
}

}  // namespace carom::tool
