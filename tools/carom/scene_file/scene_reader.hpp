#pragma once

#include <carom/carom.hpp>

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace carom::tool {

/// A scene file that cannot be read or says something wrong. `what()` names the file, the JSON pointer
/// (`/bodies/3/shape/disc/radius`), the value, what was expected and, for names, the nearest known one.
class SceneFileError : public Error {
  public:
    SceneFileError(ErrorCode code, std::string file, std::string pointer, const std::string& statement);

    const std::string& file() const noexcept { return file_; }
    /// Empty where the file as a whole is meant.
    const std::string& pointer() const noexcept { return pointer_; }

  private:
    std::string file_;
    std::string pointer_;
};

/// What a scene file may ask of the machine that reads it.
struct SceneFileLimits {
    std::size_t file_bytes = std::size_t{256} << 20;
    std::size_t depth = 64;                         ///< of nested arrays and objects
    std::size_t values = std::size_t{1} << 25;      ///< numbers, strings, arrays, objects ... of the file
    std::size_t body_bytes = std::size_t{4} << 30;  ///< of all bodies together, sizeof(Body) each
};

/// Reads and validates a scene file, format version 1 (docs/scene-format.md). Bodies of generators are made.
/// @throws SceneFileError
Scene read_scene(const std::filesystem::path& path, const SceneFileLimits& limits = {});

/// The same of a text in memory; `source_name` stands for the file's name in messages.
/// @throws SceneFileError
Scene parse_scene(std::string_view text, std::string_view source_name, const SceneFileLimits& limits = {});

}  // namespace carom::tool
