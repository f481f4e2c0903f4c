#pragma once

#include <carom/errors.hpp>
#include <carom/vec2.hpp>

#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace carom {

/// The item whose value a check looks at, in words and as a JSON pointer. One is built for every body, so it
/// owns nothing.
struct Item {
    std::string_view words;     ///< "the walls have", or the kind of a numbered item: "body"
    std::string_view pointer;   ///< "/walls", "/bodies"
    std::ptrdiff_t index = -1;  ///< of a numbered item
    std::string_view name;      ///< of a numbered item, may be empty

    std::string subject() const;  ///< `body 3 ("ball") has`
    std::string path() const;     ///< `/bodies/3`
};

/// A kind of value with its limits.
struct Quantity {
    std::string_view name;
    std::string_view unit;
    double low;
    double high;
    std::string_view remedy;
};

/// The shortest text that reads back as the same number.
std::string to_text(double value);
/// In quotes, with control characters made visible; cut when long.
std::string quoted(std::string_view text);

/// A problem if the value is not finite or outside the limits of its quantity. `tail`: its place in the item.
std::optional<Problem> check(const Item& item, std::string_view tail, double value, const Quantity& quantity);

void append(std::string& text, std::string_view part);
void append(std::string& text, double part);
void append(std::string& text, Vec2 part);
template <std::integral Integer>
void append(std::string& text, Integer part) {
    text.append(std::to_string(part));
}

template <class... Parts>
std::string join(const Parts&... parts) {
    std::string text;
    (append(text, parts), ...);
    return text;
}

/// A problem of an item, in words that follow its subject.
template <class... Words>
Problem problem(ErrorCode code, const Item& item, std::string_view tail, const Words&... words) {
    return {code, item.path().append(tail), join(item.subject(), " ", words...)};
}

/// @throws Error of that problem.
[[noreturn]] void raise(std::string_view where, const Problem& found);

inline void raise_if(std::string_view where, const std::optional<Problem>& found) {
    if (found) raise(where, *found);
}

}  // namespace carom
