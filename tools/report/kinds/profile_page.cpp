#include "report/kinds/measured.hpp"

namespace carom::report {
namespace {

/// Adds the row of one profile; files of older versions say nothing of threads.
void add_threads(const Json& json, const std::string& scene, Table& table) {
    if (!json.contains("shared_loops")) return;
    const Json& loops = json.at("shared_loops");
    std::vector<std::string> row{scene, digits(100 * loops.at("share_on_one_thread").get<double>(), 3)};
    const bool is_first = table.rows.empty();  // the columns are named by the first profile
    for (const Json& cores : loops.at("cores")) {
        if (is_first) table.headers.push_back(std::to_string(cores.at("cores").get<int>()) + " cores");
        row.push_back(digits(cores.at("times_at_most").get<double>(), 3));
    }
    row.resize(table.headers.size());
    table.rows.push_back(std::move(row));
}

}  // namespace

void draw_profile(const std::vector<Result>& results, Page& page) {
    page.set_title("Profile");
    add_origins(results, page);
    Chart chart{.id = "profile",
                .title = "Time by stage",
                .x_label = "",
                .y_label = "time a step (us)",
                .series = {},
                .bars = true};
    Table table{.caption = "Stages",
                .headers = {"stage", "us a step", "share (%)", "items", "item", "ns an item", "GB/s",
                            "share of the roof (%)", "times scalar", "limited by"},
                .rows = {},
                .sortable = true};
    Table threads{.caption = "Share on one thread, and how many times as fast more cores are at most",
                  .headers = {"scene", "on one thread (%)"},
                  .rows = {},
                  .sortable = false};
    for (std::size_t i = 0; i < results.size(); ++i) {
        const Json& json = results[i].json;
        Series series{.name = json.at("scene").get<std::string>() + tag_of(results, i)};
        for (const Json& stage : json.at("stages")) {
            const double micro = 1e6 * stage.at("seconds_per_step").get<double>();
            series.points.push_back({.y = micro, .label = stage.at("name").get<std::string>()});
            const auto number = [&](const char* key, double scale) {
                return stage.contains(key) ? digits(scale * stage.at(key).get<double>(), 3) : std::string();
            };
            table.rows.push_back({stage.at("name").get<std::string>() + tag_of(results, i), digits(micro, 4),
                                  number("share", 100), number("items", 1), stage.value("item", ""),
                                  number("ns_per_item", 1), number("bytes_per_second", 1e-9),
                                  number("roof_share", 100), number("times_scalar", 1),
                                  stage.at("limit").get<std::string>()});
        }
        add_threads(json, series.name, threads);
        chart.series.push_back(std::move(series));
    }
    page.chart(std::move(chart));
    page.table(table);
    if (!threads.rows.empty()) page.table(threads);
}

}  // namespace carom::report
