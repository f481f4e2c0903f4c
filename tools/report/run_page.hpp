#pragma once

#include <cstddef>
#include <filesystem>

#include "report/page.hpp"

namespace carom::report {

inline constexpr std::size_t kDefaultPageBytes = 50'000'000;  // what browsers open without complaint

/// The result files of one run. A path is empty where the run left the file out.
struct RunFiles {
    Json summary;
    std::filesystem::path final_csv, ledger_csv, trajectory_h5;
    std::size_t page_bytes = kDefaultPageBytes;  ///< frames are thinned, then bodies, until the page fits
};

/// Draws a run: warnings, the player, charts, tables. Frames are read while the page is written, one at a
/// time, so the files have to stay until then.
/// @throws ResultError, also while the page is written
void draw_run(const RunFiles& files, Page& page);

}  // namespace carom::report
