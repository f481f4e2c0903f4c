#include "report/readers/json_text.hpp"

#include <istream>
#include <string>

namespace carom::report {
namespace {

/// Looks at each value as it is read.
bool check_depth(int depth, Json::parse_event_t, Json&) {
    if (depth <= kDeepestJson) return true;
    throw Json::out_of_range::create(416, "it is nested more than " + std::to_string(kDeepestJson) + " deep",
                                     nullptr);
}

}  // namespace

Json parse_json(std::istream& text) {
    return Json::parse(text, check_depth);
}

Json parse_json(std::string_view text) {
    return Json::parse(text, check_depth);
}

}  // namespace carom::report
