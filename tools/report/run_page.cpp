#include "report/kinds.hpp"

namespace carom::report {
namespace {

/// JSON as a person writes it: texts without quotes.
std::string plain(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

void add_settings(const Json& summary, Page& page) {
    Table table{.caption = "Settings", .headers = {"setting", "value"}};
    for (const char* key : {"bodies", "steps", "dt", "time", "solver", "substeps", "iterations", "precision",
                            "isa", "threads", "version", "state_hash"})
        table.rows.push_back({key, plain(summary.at(key))});
    page.table(table);
}

void add_stage_times(const Json& summary, Page& page) {
    Series seconds{.name = "time"};
    for (const Json& stage : summary.at("stages"))
        seconds.points.push_back(
            {.y = 1e3 * stage.at("seconds").get<double>(), .label = plain(stage.at("name"))});
    page.chart({.id = "stages",
                .title = "Time by stage",
                .x_label = "",
                .y_label = "time (ms)",
                .series = {seconds},
                .bars = true});
}

}  // namespace

void draw_run(const Result& result, Page& page) {
    const Json& summary = result.json;
    page.set_title(plain(summary.at("scene")));
    for (const Json& message : summary.at("messages")) page.warning(plain(message));
    add_stage_times(summary, page);
    add_settings(summary, page);
}

}  // namespace carom::report
