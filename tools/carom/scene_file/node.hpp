#pragma once

#include <carom/carom.hpp>
#include "scene_file/scene_reader.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace carom::tool {

/// A value of the document that knows where it stands, so that every complaint can say it. Refers to its
/// parent, which has to live on.
class Node {
  public:
    using Json = nlohmann::json;
    using Names = std::span<const std::string_view>;

    Node(const Json& value, std::string_view file) : value_(value), file_(file) {}

    const Json& json() const { return value_; }
    std::string_view file() const { return file_; }
    std::string pointer() const;  ///< "/bodies/3/shape"

    /// @throws SceneFileError about this value.
    [[noreturn]] void fail(ErrorCode code, const std::string& statement) const;
    /// About the value at a pointer from here, or as far on the way there as the document goes.
    [[noreturn]] void fail_at(std::string_view pointer, ErrorCode code, const std::string& statement) const;
    /// "<value> is a string; expected <what>"
    [[noreturn]] void fail_type(std::string_view expected) const;

    // Each of these throws unless the value is of that type.
    double number() const;
    std::int64_t integer() const;
    std::uint64_t seed() const;  ///< 0 ... 2^64 - 1
    bool boolean() const;
    const std::string& text() const;
    Vec2 vec2() const;
    /// The position in `known` of a text that is one of them. `kind`: what they are, for the message.
    std::size_t one_of(Names known, std::string_view kind) const;

    /// Checks that this is an object without keys that are not in `known`.
    void expect_keys(Names known) const;
    std::optional<Node> find(std::string_view key) const;
    Node at(std::string_view key) const;  ///< throws if it is not there
    /// The only member of an object with one member, whose key says what it is. `kind`: "shape".
    Node only_member(Names known, std::string_view kind) const;
    std::string_view key() const { return key_; }

    void expect_array(std::string_view of_what) const;
    std::size_t size() const { return value_.size(); }
    Node operator[](std::size_t index) const;

    // The value of a member if it is there, else what was before.
    void read(std::string_view key, double& into) const;
    void read(std::string_view key, std::int64_t& into) const;
    void read(std::string_view key, bool& into) const;
    void read(std::string_view key, std::string& into) const;
    void read(std::string_view key, Vec2& into) const;
    void read(std::string_view key, std::optional<bool>& into) const;

  private:
    Node(const Json& value, const Node& parent, std::string_view key)
        : value_(value), file_(parent.file_), parent_(&parent), key_(key) {}
    Node(const Json& value, const Node& parent, std::size_t index)
        : value_(value), file_(parent.file_), parent_(&parent), index_(index) {}

    [[noreturn]] void fail_unknown_key(std::string_view key, Names known) const;

    const Json& value_;
    std::string_view file_;
    const Node* parent_ = nullptr;
    std::string_view key_;   // of a member
    std::size_t index_ = 0;  // of an element
};

/// The value as a message shows it: short and in one line.
std::string short_text(const nlohmann::json& value);

}  // namespace carom::tool
