#pragma once

#include <span>
#include <string_view>

namespace carom::report {

/// A file of tools/report/web/, or Chart.js, that was made part of the program when it was built.
struct Asset {
    std::string_view name;                     ///< of the file, without its folder
    std::span<const std::string_view> pieces;  ///< of its text, in order
};

/// All of them, in the order in which a page runs them. Defined in a source that embed_assets.cmake writes.
std::span<const Asset> assets();

}  // namespace carom::report
