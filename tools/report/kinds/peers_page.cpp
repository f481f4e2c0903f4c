#include "report/kinds/measured.hpp"

namespace carom::report {
namespace {

/// Time a body against the number of bodies, one chart a scene.
void add_time_charts(const std::vector<Result>& results, Page& page) {
    std::vector<Chart> charts;
    for (std::size_t i = 0; i < results.size(); ++i)
        for (const Json& scene : results[i].json.at("scenes")) {
            const std::string title = scene.at("scene").get<std::string>();
            Chart* chart = nullptr;
            for (Chart& each : charts)
                if (each.title == title) chart = &each;
            if (!chart)
                chart = &charts.emplace_back(Chart{.id = "peers-" + title,
                                                   .title = title,
                                                   .x_label = "bodies",
                                                   .y_label = "time a body and step (ns)",
                                                   .log_x = true,
                                                   .log_y = true,
                                                   .series = {}});
            for (const Json& row : scene.at("engines"))
                if (row.contains("ns_per_body"))
                    series_named(chart->series, row.at("engine").get<std::string>() + tag_of(results, i))
                        .points.push_back(
                            spread_point(scene.at("bodies").get<double>(), row.at("ns_per_body")));
        }
    for (Chart& chart : charts) page.chart(std::move(chart));
}

std::vector<std::string> row_of(const Json& scene, const Json& row, const std::string& tag) {
    std::vector<std::string> cells{scene.at("scene").get<std::string>(), scene.at("bodies").dump(),
                                   row.at("engine").get<std::string>() + tag};
    if (row.contains("missing")) {
        cells.resize(9);
        cells[3] = "not run";
        return cells;
    }
    const Json& measures = row.at("measures");
    const auto measure = [&](const char* key, double scale) {
        return digits(scale * measures.at(key).get<double>(), 3);
    };
    cells.push_back(digits(row.at("ns_per_body").at("median").get<double>()));
    cells.push_back(row.contains("ratio_to_ours")
                        ? digits(row.at("ratio_to_ours").at("median").get<double>(), 3) + " (" +
                              digits(row.at("ratio_to_ours").at("low").get<double>(), 3) + " to " +
                              digits(row.at("ratio_to_ours").at("high").get<double>(), 3) + ")"
                        : "");
    cells.push_back(measures.contains("kinetic_ratio") ? digits(measures.at("kinetic_ratio").get<double>(), 5)
                                                       : "");
    cells.push_back(measure("overlap_mean", 100));
    cells.push_back(measure("overlap_max", 100));
    cells.push_back(measure("speed_rms", 1));
    return cells;
}

}  // namespace

void draw_peers(const std::vector<Result>& results, Page& page) {
    page.set_title("Other engines");
    add_origins(results, page);
    page.paragraph(
        "All engines start a scene from the same state, settle on their own and then take turns, so that "
        "what "
        "else the machine does hits all alike. Energy, overlap and speed are measured from positions and "
        "velocities by the same code for all. One thread.");
    add_time_charts(results, page);
    Table table{.caption = "Time and accuracy",
                .headers = {"scene", "bodies", "engine", "ns a body", "times ours (95 %)", "kinetic energy x",
                            "overlap mean (%)", "overlap max (%)", "speed rms (m/s)"},
                .rows = {},
                .sortable = true};
    for (std::size_t i = 0; i < results.size(); ++i)
        for (const Json& scene : results[i].json.at("scenes"))
            for (const Json& row : scene.at("engines"))
                table.rows.push_back(row_of(scene, row, tag_of(results, i)));
    page.table(table);
    Table settings{.caption = "Settings", .headers = {"engine", "settings"}, .rows = {}};
    if (!results.front().json.at("scenes").empty())
        for (const Json& row : results.front().json.at("scenes").front().at("engines"))
            settings.rows.push_back(
                {row.at("engine").get<std::string>(), row.at("settings").get<std::string>()});
    page.table(settings);
}

}  // namespace carom::report
