#pragma once

#include <filesystem>

#include "report/page/page.hpp"

namespace carom::tool {

/// Writes the page under a temporary name beside its own (`report.html.part`), then renames it.
/// @throws WriteError with the system's reason; nothing is left then.
void write_page(const std::filesystem::path& path, const report::Page& page);

/// The same without a temporary name: for a folder whose files are renamed together.
void write_page_to(const std::filesystem::path& path, const report::Page& page);

}  // namespace carom::tool
