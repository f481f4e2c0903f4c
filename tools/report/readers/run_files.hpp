#pragma once

#include <cstddef>
#include <filesystem>

#include "report/page/markup.hpp"

namespace carom::report {

inline constexpr std::size_t kDefaultPageBytes = 50'000'000;  // what browsers open without complaint

/// The result files of one run. A path is empty where the run left the file out.
struct RunFiles {
    Json summary;
    std::filesystem::path final_csv, ledger_csv, trajectory_h5;
    std::size_t page_bytes = kDefaultPageBytes;  ///< frames are thinned, then bodies, until the page fits
};

}  // namespace carom::report
