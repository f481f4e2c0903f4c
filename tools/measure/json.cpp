#include "measure/json.hpp"

namespace carom::measure {
namespace {

std::string one_line(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string result_text(const Json& result) {
    std::string text = "{";
    const char* comma = "\n";
    for (const auto& [key, value] : result.items()) {
        text.append(comma).append(one_line(Json(key))).append(": ");
        comma = ",\n";
        if (!value.is_array() || value.empty() || !value.front().is_object()) {
            text += one_line(value);
            continue;
        }
        const char* between = "[\n  ";
        for (const Json& element : value) {
            text.append(between).append(one_line(element));
            between = ",\n  ";
        }
        text += "]";
    }
    return text.append("\n}\n");
}

}  // namespace carom::measure
