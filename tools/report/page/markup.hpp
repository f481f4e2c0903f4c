#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace carom::report {

using Json = nlohmann::ordered_json;

/// The text as HTML shows it: whatever it holds, it is never markup, inside or outside of attributes. Bytes
/// that are not UTF-8 are replaced.
std::string as_html(std::string_view text);

/// JSON that may stand inside a <script> element: nothing in it ends the element or starts a comment.
std::string as_script_data(const Json& json);

/// The number, or NaN where the file has null: JSON knows no other way to write what is not finite.
double number_of(const Json& json);

/// JSON as a person writes it: texts without quotes.
std::string plain(const Json& value);

}  // namespace carom::report
