#include "scene_file/json_text.hpp"

#include "scene_file/printable.hpp"
#include "scene_file/syntax_hint.hpp"

#include <nlohmann/json.hpp>

#include <utility>
#include <vector>

namespace carom::tool {
namespace {

using nlohmann::json;

/// Builds the document from the parser's events and stops at the first thing that is wrong.
class DocumentBuilder : public json::json_sax_t {
  public:
    DocumentBuilder(std::string_view text, std::string_view file, const SceneFileLimits& limits)
        : text_(text), file_(file), limits_(limits) {}

    json take() { return std::move(root_); }

    bool null() override { return place(nullptr) != nullptr; }
    bool boolean(bool value) override { return place(value) != nullptr; }
    bool number_integer(number_integer_t value) override { return place(value) != nullptr; }
    bool number_unsigned(number_unsigned_t value) override { return place(value) != nullptr; }
    bool number_float(number_float_t value, const string_t&) override { return place(value) != nullptr; }
    bool string(string_t& value) override { return place(std::move(value)) != nullptr; }
    bool binary(binary_t&) override { return false; }  // not in a text

    bool start_object(std::size_t) override { return open(json::value_t::object); }
    bool start_array(std::size_t) override { return open(json::value_t::array); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override {
        auto [position, is_new] = open_.back().container->get_ref<json::object_t&>().emplace(name, nullptr);
        open_.back().key = &position->first;
        open_.back().slot = &position->second;
        if (!is_new)
            fail(ErrorCode::duplicate_name, "the key is there twice; expected each key once. Take one away.");
        return true;
    }

    bool parse_error(std::size_t position, const std::string& token,
                     const nlohmann::detail::exception& error) override {
        const SyntaxHint hint = explain_syntax_error(text_, position, token, error.what(), error.id);
        fail(hint.code, hint.statement);
    }

  private:
    struct Level {
        json* container;
        const std::string* key = nullptr;  // the last one, if an object
        json* slot = nullptr;              // where its value goes
    };

    [[noreturn]] void fail(ErrorCode code, const std::string& statement) const {
        throw SceneFileError(code, std::string(file_), pointer(), statement);
    }

    /// Where the next value goes, or the last one went if it was an object's.
    std::string pointer() const {
        std::string out;
        for (std::size_t i = 0; i < open_.size(); ++i) {
            const Level& level = open_[i];
            if (level.container->is_object()) {
                if (level.key != nullptr) out.append("/").append(pointer_token(*level.key));
            } else {
                const bool inside = i + 1 < open_.size();
                out.append("/").append(std::to_string(level.container->size() - (inside ? 1 : 0)));
            }
        }
        return out;
    }

    json* place(json value) {
        if (++values_ > limits_.values)
            fail(ErrorCode::too_large,
                 "the file has more than " + std::to_string(limits_.values) +
                     " values; expected at most that many. Let \"generate\" make the bodies.");
        if (open_.empty()) {
            root_ = std::move(value);
            return &root_;
        }
        Level& level = open_.back();
        if (level.container->is_object()) {
            *level.slot = std::move(value);
            return level.slot;
        }
        auto& elements = level.container->get_ref<json::array_t&>();
        elements.push_back(std::move(value));
        return &elements.back();
    }

    bool open(json::value_t type) {
        if (open_.size() >= limits_.depth)
            fail(ErrorCode::too_large, "arrays and objects are nested more than " +
                                           std::to_string(limits_.depth) +
                                           " deep; expected a scene, which needs less than 10.");
        json* container = place(json(type));
        open_.push_back({container, nullptr, nullptr});
        return true;
    }

    bool close() {
        open_.pop_back();
        return true;
    }

    std::string_view text_;
    std::string_view file_;
    const SceneFileLimits& limits_;
    json root_;
    std::vector<Level> open_;
    std::size_t values_ = 0;
};

}  // namespace

json parse_json(std::string_view text, std::string_view file, const SceneFileLimits& limits) {
    DocumentBuilder builder(text, file, limits);
    json::sax_parse(text.begin(), text.end(), &builder);  // throws where it would return false
    return builder.take();
}

}  // namespace carom::tool
