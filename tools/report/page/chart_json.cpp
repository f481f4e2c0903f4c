#include "report/page/page.hpp"

namespace carom::report {
namespace {

bool has_error_bars(const Series& series) {
    for (const Point& point : series.points)
        if (point.low == point.low || point.high == point.high) return true;
    return false;
}

bool has_labels(const Series& series) {
    for (const Point& point : series.points)
        if (!point.label.empty()) return true;
    return false;
}

/// One property of all points; what is not finite becomes null.
template <class Value>
Json column(const Series& series, Value Point::*member) {
    Json values = Json::array();
    for (const Point& point : series.points) values.push_back(point.*member);
    return values;
}

Json series_json(const Series& series) {
    Json json{{"name", series.name},
              {"line", series.line},
              {"area", series.area},
              {"stack", series.stack},
              {"colour", series.colour},
              {"in_legend", series.in_legend},
              {"x", column(series, &Point::x)},
              {"y", column(series, &Point::y)}};
    if (has_error_bars(series)) {
        json["low"] = column(series, &Point::low);
        json["high"] = column(series, &Point::high);
    }
    if (has_labels(series)) json["label"] = column(series, &Point::label);
    return json;
}

}  // namespace

Json chart_json(const Chart& chart) {
    Json json{{"id", chart.id},
              {"title", chart.title},
              {"x_label", chart.x_label},
              {"y_label", chart.y_label},
              {"log_x", chart.log_x},
              {"log_y", chart.log_y},
              {"bars", chart.bars},
              {"follows_time", chart.follows_time},
              {"marks", {{"name", chart.marks.name}, {"x", chart.marks.x}}},
              {"series", Json::array()},
              {"slopes", Json::array()}};
    for (const Series& series : chart.series) json["series"].push_back(series_json(series));
    for (const SlopeGuide& guide : chart.slopes)
        json["slopes"].push_back({{"name", guide.name}, {"slope", guide.slope}});
    return json;
}

}  // namespace carom::report
