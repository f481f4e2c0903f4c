#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "accuracy/case.hpp"

namespace carom::accuracy {

using Json = nlohmann::ordered_json;

/// A number with the ends of its band.
struct Band {
    double value = 0, low = 0, high = 0;
};

/// One setting of one case, measured.
struct Point {
    Setting setting;
    std::vector<Band> errors;  ///< as many as the case has measures; none if it failed
    Band seconds;              ///< of stepping: median, 10 % and 90 % of the runs
    int runs = 0;
    Work work;            ///< mean of the runs
    std::string failure;  ///< empty, or why there is no error
};

struct CaseResult {
    const Case* of = nullptr;
    std::vector<Point> points;
};

Json to_json(const Setting& setting);
Json to_json(const Point& point);
/// @throws nlohmann::json::exception if it is not as `to_json` writes it
Point point_from(const Json& json);

/// "impulse, float, 1/60 s, 4 substeps"
std::string in_words(const Setting& setting);

/// Everything, with what follows from it; docs/accuracy.schema.json describes it.
Json to_json(const std::vector<CaseResult>& results, bool quick);

/// One line a point and error.
std::string to_csv(const std::vector<CaseResult>& results);

}  // namespace carom::accuracy
