#include "report/kinds/measured.hpp"

namespace carom::report {
namespace {

constexpr double kNano = 1e9;
constexpr std::string_view kStagePrefix = "stage:";

/// One chart for each scene and precision: time a body of every stage, on top of each other.
void add_stage_charts(const Result& result, const std::string& tag, Page& page) {
    std::vector<Chart> charts;
    for (const Json& run : result.json.at("benchmarks")) {
        const std::string name = run.at("name").get<std::string>();
        const std::vector<std::string> parts = name_parts(name);
        const std::string title = parts.at(1) + ", " + parts.at(2) + tag;
        if (charts.empty() || charts.back().title != title)
            charts.push_back({.id = "stages-" + parts.at(1) + "-" + parts.at(2) +
                                    (tag.empty() ? "" : "-" + tag.substr(2, 1)),
                              .title = title,
                              .x_label = "bodies",
                              .y_label = "time a body and step (ns)",
                              .log_x = true,
                              .series = {}});
        const double bodies = name_value(name, "bodies");
        for (const auto& [key, value] : run.items()) {
            if (!key.starts_with(kStagePrefix)) continue;
            Series& series = series_named(charts.back().series, key.substr(kStagePrefix.size()));
            series.area = true;
            series.stack = "step";
            series.points.push_back({.x = bodies, .y = kNano * value.get<double>() / bodies});
        }
    }
    for (Chart& chart : charts) page.chart(std::move(chart));
}

}  // namespace

void draw_stages(const std::vector<Result>& results, Page& page) {
    page.set_title("Stages of a step");
    add_origins(results, page);
    Table table{
        .caption = "Stages", .headers = {"benchmark", "stage", "ns a body"}, .rows = {}, .sortable = true};
    for (std::size_t i = 0; i < results.size(); ++i) {
        add_stage_charts(results[i], tag_of(results, i), page);
        for (const Json& run : results[i].json.at("benchmarks")) {
            const std::string name = run.at("name").get<std::string>();
            for (const auto& [key, value] : run.items())
                if (key.starts_with(kStagePrefix))
                    table.rows.push_back({name + tag_of(results, i), key.substr(kStagePrefix.size()),
                                          digits(kNano * value.get<double>() / name_value(name, "bodies"))});
        }
    }
    page.table(table);
}

void draw_scenes(const std::vector<Result>& results, Page& page) {
    page.set_title("Whole scenes");
    add_origins(results, page);
    Chart chart{.id = "scenes",
                .title = "Time against the number of bodies",
                .x_label = "bodies",
                .y_label = "time a body and step (ns)",
                .log_x = true,
                .log_y = true,
                .series = {}};
    Table table{.caption = "Time and accuracy",
                .headers = {"benchmark", "ns a body", "relative energy error", "overlap mean (%)",
                            "overlap max (%)", "impacts a body", "bytes a body"},
                .rows = {},
                .sortable = true};
    for (std::size_t i = 0; i < results.size(); ++i)
        for (const Json& run : results[i].json.at("benchmarks")) {
            const std::string name = run.at("name").get<std::string>();
            const std::vector<std::string> parts = name_parts(name);
            const double bodies = name_value(name, "bodies"), threads = name_value(name, "threads");
            const double ns = kNano / run.at("items_per_second").get<double>();
            if (threads == 1)
                series_named(chart.series,
                             parts.at(1) + " " + parts.at(2) + " " + parts.at(3) + tag_of(results, i))
                    .points.push_back({.x = bodies, .y = ns});
            const auto number = [&](const char* key, double scale) {
                return digits(scale * run.at(key).get<double>());
            };
            table.rows.push_back({name + tag_of(results, i), digits(ns), number("energy_error", 1),
                                  number("overlap_mean", 100), number("overlap_max", 100),
                                  number("impacts_per_body", 1), number("bytes_per_body", 1)});
        }
    page.chart(std::move(chart));
    page.table(table);
}

}  // namespace carom::report
