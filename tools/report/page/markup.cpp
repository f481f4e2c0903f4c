#include "report/page/markup.hpp"

#include <limits>

namespace carom::report {
namespace {

/// Valid UTF-8: what was not is U+FFFD. By way of JSON, whose library checks it.
std::string as_utf8(std::string_view text) {
    return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

}  // namespace

std::string as_html(std::string_view text) {
    std::string html;
    for (const char c : as_utf8(text)) switch (c) {
            case '&':
                html += "&amp;";
                break;
            case '<':
                html += "&lt;";
                break;
            case '>':
                html += "&gt;";
                break;
            case '"':
                html += "&quot;";
                break;
            case '\'':
                html += "&#39;";
                break;
            case '\0':
                break;
            default:
                html += c;
        }
    return html;
}

std::string as_script_data(const Json& json) {
    std::string data;
    // Characters that mean something to HTML stand in JSON inside of strings only, where an escape says the
    // same.
    for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace)) switch (c) {
            case '<':
                data += "\\u003c";
                break;
            case '>':
                data += "\\u003e";
                break;
            case '&':
                data += "\\u0026";
                break;
            default:
                data += c;
        }
    return data;
}

double number_of(const Json& json) {
    return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

std::string plain(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace carom::report
