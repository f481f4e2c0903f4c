#include <algorithm>

#include "report/kinds/measured.hpp"

namespace carom::report {
namespace {

constexpr double kGiga = 1e-9;
constexpr double kLeastIntensity = 0.05, kMostIntensity = 20;  // operations a byte, of the roofs drawn

/// The roof of one level of memory: bandwidth times intensity, up to the peak of the best instruction set.
Series roof(const Json& level, double peak, const std::string& tag) {
    const double bandwidth = level.at("bytes_per_second").get<double>();
    Series series{.name = "roof: " + level.at("level").get<std::string>() + tag};
    for (const double intensity : {kLeastIntensity, peak / bandwidth, kMostIntensity})
        if (intensity >= kLeastIntensity && intensity <= kMostIntensity)
            series.points.push_back(
                {.x = intensity, .y = kGiga * std::min(peak, bandwidth * intensity), .label = series.name});
    std::sort(series.points.begin(), series.points.end(),
              [](const Point& a, const Point& b) { return a.x < b.x; });
    return series;
}

/// Single precision in the first cache, each kernel once an instruction set.
Chart roofline_chart(const std::vector<Result>& results) {
    Chart chart{
        .id = "roofline",
        .title = "Roofline: kernels in single precision, data in the first cache",
        .x_label = "operations a byte",
        .y_label = "operations a second (G/s)",
        .log_x = true,
        .log_y = true,
        .series = {},
        .note =
            "Roofs of copying: a kernel that only reads can be above that of the memory its data are in."};
    for (std::size_t i = 0; i < results.size(); ++i) {
        const Json& json = results[i].json;
        const double peak = json.at("ceilings").at("peak").back().at("float_per_second").get<double>();
        for (const Json& level : json.at("ceilings").at("copy"))
            chart.series.push_back(roof(level, peak, tag_of(results, i)));
        for (const Json& row : json.at("rows")) {
            if (row.at("precision") != "float" || row.at("level") != "L1") continue;
            if (row.contains("hits_asked") && row.at("hits_asked") != 10) continue;
            Series& series =
                series_named(chart.series, row.at("isa").get<std::string>() + tag_of(results, i));
            series.line = false;
            series.points.push_back({.x = row.at("operations_per_byte").get<double>(),
                                     .y = kGiga * row.at("operations_per_second").get<double>(),
                                     .label = row.at("kernel").get<std::string>()});
        }
    }
    return chart;
}

}  // namespace

void draw_kernels(const std::vector<Result>& results, Page& page) {
    page.set_title("Kernels alone");
    add_origins(results, page);
    page.chart(roofline_chart(results));
    Table table{.caption = "Every kernel alone",
                .headers = {"kernel", "instruction set", "numbers", "items", "data in", "hits", "ns an item",
                            "GB/s", "G operations/s", "share of the roof (%)", "roof", "times scalar"},
                .rows = {},
                .sortable = true};
    for (std::size_t i = 0; i < results.size(); ++i)
        for (const Json& row : results[i].json.at("rows")) {
            const auto number = [&](const char* key, double scale = 1) {
                return digits(scale * row.at(key).get<double>());
            };
            const auto word = [&](const char* key) { return row.at(key).get<std::string>(); };
            table.rows.push_back({word("kernel") + tag_of(results, i), word("isa"), word("precision"),
                                  row.at("items").dump(), word("level"), number("hits"),
                                  number("ns_per_item"), number("bytes_per_second", kGiga),
                                  number("operations_per_second", kGiga), number("roof_share", 100),
                                  word("roof"), row.contains("times_scalar") ? number("times_scalar") : ""});
        }
    page.table(table);
    Table reasons{
        .caption = "What keeps a kernel from the roof", .headers = {"kernel", "reason"}, .rows = {}};
    for (const auto& [kernel, reason] : results.front().json.at("reasons").items())
        reasons.rows.push_back({kernel, reason.get<std::string>()});
    page.table(reasons);
}

}  // namespace carom::report
