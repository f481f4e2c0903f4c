#include "report/kinds/run_page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "report/frames/player.hpp"
#include "report/kinds/kinds.hpp"
#include "report/kinds/ledger_charts.hpp"
#include "report/kinds/run_tables.hpp"
#include "report/readers/file_checksum.hpp"

namespace carom::report {
namespace {

constexpr std::size_t kMostLedgerRows = 2000;  // of the ledger: more than a chart has pixels
constexpr double kBooksClose = 0.01;           // of the energy that moved: beyond, the reader is warned

/// "2.5 %": a part of something, in words.
std::string percent(double part) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g %%", 100 * part);
    return text;
}

/// Whether the causes of the ledger add up; the naive engine keeps no books, which is no news.
void warn_of_books(const Json& summary, Page& page) {
    if (!summary.contains("energy_by_cause") || summary.at("solver") == "pairwise") return;
    double moved = 0;
    for (const auto& [cause, work] : summary.at("energy_by_cause").items())
        if (cause != "unexplained") moved = std::max(moved, std::abs(number_of(work)));
    moved = std::max(moved, number_of(summary.at("energy").at("initial").at("kinetic")));
    const double rest = std::abs(number_of(summary.at("energy_by_cause").at("unexplained")));
    if (rest > kBooksClose * moved)
        page.warning("The books do not close: " + percent(rest / moved) +
                     " of the energy that moved is explained by no cause. A shorter step or more substeps "
                     "would help.");
}

void add_warnings(const Json& summary, Page& page) {
    for (const Json& message : summary.at("messages")) {
        std::string text = message.get<std::string>();
        if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
            text[0] = static_cast<char>(text[0] - 'a' + 'A');
        page.warning(text + ".");
    }
    warn_of_books(summary, page);
}

void add_introduction(const Json& summary, Page& page) {
    char text[200];
    std::snprintf(text, sizeof text, "%lld bodies, %lld steps of %.6g s: %.6g s simulated in %.4g s. ",
                  summary.at("bodies").get<long long>(), summary.at("steps").get<long long>(),
                  number_of(summary.at("dt")), number_of(summary.at("time")),
                  number_of(summary.at("wall").at("total_s")));
    page.paragraph(text + std::string("Solver ") + summary.at("solver").get<std::string>() + ", " +
                   summary.at("precision").get<std::string>() + " precision.");
}

void add_stage_times(const Json& summary, Page& page) {
    Series seconds{.name = "time"};
    for (const Json& stage : summary.at("stages"))
        seconds.points.push_back(
            {.y = 1e3 * number_of(stage.at("seconds")), .label = stage.at("name").get<std::string>()});
    if (seconds.points.empty()) return;
    page.chart({.id = "stages",
                .title = "Time by stage",
                .y_label = "time (ms)",
                .series = {seconds},
                .bars = true});
}

void add_charts(const RunFiles& files, Page& page) {
    page.heading("What happened over time");
    if (!files.ledger_csv.empty()) {
        const NumberTable ledger = read_numbers(files.ledger_csv, kMostLedgerRows);
        if (ledger.at("time").size() != ledger.row_count())
            throw ResultError(files.ledger_csv.string() +
                              ": has no column \"time\"; expected a ledger that a run wrote");
        if (ledger.row_count() < ledger.rows_in_file)
            page.paragraph("The charts show " + std::to_string(ledger.row_count()) + " of " +
                           std::to_string(ledger.rows_in_file) +
                           " steps, evenly chosen; ledger.csv has all.");
        add_ledger_charts(ledger, page);
    } else {
        page.paragraph("This run kept no ledger, so there are no charts of energy and momentum.");
    }
    add_contact_charts(files.summary, page);
    add_stage_times(files.summary, page);
}

}  // namespace

void draw_run(const RunFiles& files, Page& page) {
    const Json& summary = files.summary;
    page.set_title(summary.at("scene").get<std::string>());
    add_warnings(summary, page);
    add_introduction(summary, page);
    if (!files.trajectory_h5.empty())
        add_player(files, page);
    else
        page.paragraph("This run recorded no trajectory, so there is nothing to play.");
    add_charts(files, page);
    page.heading("Settings and results");
    add_summary_tables(summary, page);
    if (!files.final_csv.empty()) add_body_table(files, page);
}

void draw_run(const Result& result, Page& page) {
    RunFiles files{.summary = result.json,
                   .final_csv = {},
                   .ledger_csv = {},
                   .trajectory_h5 = {},
                   .page_bytes = result.page_bytes};
    const std::filesystem::path folder = result.file.parent_path();
    const Json& written = result.json.at("files");
    const auto path_of = [&](const char* name) {
        const bool is_there = std::find(written.begin(), written.end(), name) != written.end();
        return is_there ? folder / name : std::filesystem::path();
    };
    files.final_csv = path_of("final.csv");
    files.ledger_csv = path_of("ledger.csv");
    files.trajectory_h5 = path_of("trajectory.h5");
    if (!files.trajectory_h5.empty()) check_file(folder, "trajectory.h5", result.json);
    draw_run(files, page);
}

}  // namespace carom::report
