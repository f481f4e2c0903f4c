#pragma once

#include <filesystem>
#include <string_view>

namespace carom::tool {

/// Writes the text under a temporary name beside its own (`trace.json.part`), then renames it.
/// @throws WriteError with the system's reason; nothing is left then.
void write_whole_file(const std::filesystem::path& path, std::string_view text);

}  // namespace carom::tool
