#include "scene_file/node.hpp"

#include "scene_file/nearest_name.hpp"
#include "scene_file/printable.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace carom::tool {
namespace {

constexpr std::size_t kLongestValue = 60;  // bytes shown of a value
constexpr std::size_t kMostElements = 4;   // of an array that is shown

std::string dumped(const nlohmann::json& value) {
    return shortened(value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), kLongestValue);
}

std::string_view type_words(const nlohmann::json& value) {
    if (value.is_string()) return "a string";
    if (value.is_number()) return "a number";
    if (value.is_boolean()) return "a boolean";
    if (value.is_array()) return "an array";
    return value.is_object() ? "an object" : "null";
}

std::string counted(std::size_t count, std::string_view what) {
    return std::to_string(count).append(" ").append(what).append(count == 1 ? "" : "s");
}

bool spells_number(const std::string& text) {
    std::string small(text.substr(0, 16));
    std::transform(small.begin(), small.end(), small.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return small.find("nan") != std::string::npos || small.find("inf") != std::string::npos;
}

}  // namespace

std::string short_text(const nlohmann::json& value) {
    if (value.is_object()) return "an object of " + counted(value.size(), "key");
    if (!value.is_array()) return dumped(value);
    const bool is_short =
        value.size() <= kMostElements &&
        std::all_of(value.begin(), value.end(), [](const auto& e) { return e.is_primitive(); });
    return is_short ? dumped(value) : "an array of " + counted(value.size(), "element");
}

std::string Node::pointer() const {
    if (parent_ == nullptr) return {};
    const std::string token = key_.data() == nullptr ? std::to_string(index_) : pointer_token(key_);
    return parent_->pointer().append("/").append(token);
}

void Node::fail(ErrorCode code, const std::string& statement) const {
    throw SceneFileError(code, std::string(file_), pointer(), statement);
}

void Node::fail_at(std::string_view to, ErrorCode code, const std::string& statement) const {
    if (to.empty()) fail(code, statement);
    const std::size_t end = std::min(to.find('/', 1), to.size());
    const std::string_view token = to.substr(1, end - 1);
    const std::string_view rest = to.substr(end);
    if (const auto member = find(token)) member->fail_at(rest, code, statement);
    std::size_t index = 0;
    const auto digits = std::from_chars(token.data(), token.data() + token.size(), index);
    if (value_.is_array() && digits.ec == std::errc() && index < size())
        (*this)[index].fail_at(rest, code, statement);
    fail(code, statement);
}

void Node::fail_type(std::string_view expected) const {
    std::string words = short_text(value_);
    if (value_.is_string() || value_.is_boolean()) words.append(" is ").append(type_words(value_));
    words.append("; expected ").append(expected).append(".");
    if (value_.is_string() && expected.find("number") != std::string_view::npos)
        words.append(spells_number(value_.get_ref<const std::string&>())
                         ? " JSON has no NaN and no infinity; give a finite number."
                         : " Numbers are written without quotes.");
    fail(ErrorCode::wrong_type, words);
}

double Node::number() const {
    if (!value_.is_number()) fail_type("a number");
    const auto number = value_.get<double>();
    if (!std::isfinite(number))
        fail(ErrorCode::not_finite, short_text(value_) + "; expected a finite number.");
    return number;
}

std::int64_t Node::integer() const {
    constexpr double kTwoTo63 = 9223372036854775808.0;
    if (value_.is_number_unsigned()) {
        const auto number = value_.get<std::uint64_t>();
        if (number <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
            return static_cast<std::int64_t>(number);
    } else if (value_.is_number_integer()) {
        return value_.get<std::int64_t>();
    } else if (!value_.is_number() || std::trunc(number()) != number()) {
        fail_type("a whole number");
    } else if (std::abs(number()) < kTwoTo63) {
        return static_cast<std::int64_t>(number());  // 500.0 and 5e2 are whole numbers too
    }
    fail(ErrorCode::out_of_range, short_text(value_) + " is too large; expected a whole number below 2^63.");
}

std::uint64_t Node::seed() const {
    constexpr double kTwoTo64 = 18446744073709551616.0;
    if (value_.is_number_unsigned()) return value_.get<std::uint64_t>();
    if (!value_.is_number() || std::trunc(number()) != number()) fail_type("a whole number");
    if (number() < 0 || number() >= kTwoTo64)
        fail(ErrorCode::out_of_range, short_text(value_) + "; expected a whole number from 0 to 2^64 - 1.");
    return static_cast<std::uint64_t>(number());
}

bool Node::boolean() const {
    if (!value_.is_boolean()) fail_type("true or false");
    return value_.get<bool>();
}

const std::string& Node::text() const {
    if (!value_.is_string()) fail_type("a string");
    return value_.get_ref<const std::string&>();
}

Vec2 Node::vec2() const {
    if (!value_.is_array()) fail_type("two numbers, [x, y]");
    if (value_.size() != 2)
        fail(ErrorCode::wrong_type, short_text(value_) + "; expected two numbers, [x, y].");
    return {(*this)[0].number(), (*this)[1].number()};
}

std::size_t Node::one_of(Names known, std::string_view kind) const {
    const auto found = std::find(known.begin(), known.end(), text());
    if (found == known.end()) {
        std::string words = short_text(value_);
        words.append(" is not a known ")
            .append(kind)
            .append("; ")
            .append(known_names(text(), known))
            .append(".");
        fail(ErrorCode::unknown_name, words);
    }
    return static_cast<std::size_t>(found - known.begin());
}

void Node::fail_unknown_key(std::string_view key, Names known) const {
    const Node member(value_.find(key).value(), *this, key);
    member.fail(ErrorCode::unknown_name, "the key \"" + shortened(key, kLongestValue) +
                                             "\" is not known here; " + known_names(key, known) + ".");
}

void Node::expect_keys(Names known) const {
    if (!value_.is_object()) fail_type("an object, {...}");
    for (const auto& [key, value] : value_.get_ref<const Json::object_t&>())
        if (std::find(known.begin(), known.end(), key) == known.end()) fail_unknown_key(key, known);
}

std::optional<Node> Node::find(std::string_view key) const {
    const auto found = value_.find(key);
    if (found == value_.end()) return std::nullopt;
    return Node(*found, *this, key);
}

Node Node::at(std::string_view key) const {
    const auto found = value_.find(key);
    if (found == value_.end())
        fail(ErrorCode::missing, "the key \"" + std::string(key) + "\" is missing; it is required here.");
    return Node(*found, *this, key);
}

Node Node::only_member(Names known, std::string_view kind) const {
    expect_keys(known);
    if (value_.size() != 1)
        fail(ErrorCode::missing, short_text(value_) + "; expected one key that says the " +
                                     std::string(kind) + ", e.g. {\"" + std::string(known.front()) +
                                     "\": {...}}.");
    const std::string_view key = value_.get_ref<const Json::object_t&>().begin()->first;
    return Node(value_.begin().value(), *this, key);
}

void Node::expect_array(std::string_view of_what) const {
    if (!value_.is_array()) fail_type("an array of " + std::string(of_what));
}

Node Node::operator[](std::size_t index) const {
    return Node(value_[index], *this, index);
}

void Node::read(std::string_view key, double& into) const {
    if (const auto member = find(key)) into = member->number();
}

void Node::read(std::string_view key, std::int64_t& into) const {
    if (const auto member = find(key)) into = member->integer();
}

void Node::read(std::string_view key, bool& into) const {
    if (const auto member = find(key)) into = member->boolean();
}

void Node::read(std::string_view key, std::string& into) const {
    if (const auto member = find(key)) into = member->text();
}

void Node::read(std::string_view key, Vec2& into) const {
    if (const auto member = find(key)) into = member->vec2();
}

void Node::read(std::string_view key, std::optional<bool>& into) const {
    if (const auto member = find(key)) into = member->boolean();
}

}  // namespace carom::tool
