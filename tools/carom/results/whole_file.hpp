#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace carom::tool {

/// Calls write(temporary), which writes a file of a temporary name beside `path` (`trace.json.part`), then
/// renames that. @throws what `write` throws, or WriteError with the system's reason; nothing is left then.
void write_then_rename(const std::filesystem::path& path,
                       const std::function<void(const std::filesystem::path&)>& write);

/// Writes the text under a temporary name beside its own (`trace.json.part`), then renames it.
/// @throws WriteError with the system's reason; nothing is left then.
void write_whole_file(const std::filesystem::path& path, std::string_view text);

}  // namespace carom::tool
