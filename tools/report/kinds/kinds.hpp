#pragma once

#include <filesystem>
#include <vector>

#include "report/kinds/run_page.hpp"
#include "report/readers/result_error.hpp"

namespace carom::report {

/// A result file that was read: JSON with its kind at the top level, {"kind": "scaling", ...}.
struct Result {
    std::filesystem::path file;
    Json json;
    std::size_t page_bytes;  ///< what a part of the page may take
};

/// How one kind of result is drawn; each is in a file of its own. The table of them is in kinds.cpp.
/// @throws ResultError
void draw_run(const Result& result, Page& page);
void draw_accuracy(const Result& result, Page& page);
void draw_torture(const Result& result, Page& page);

/// Results of measurements of one kind, at least one: several are compared side by side, in one chart.
void draw_scaling(const std::vector<Result>& results, Page& page);
void draw_kernels(const std::vector<Result>& results, Page& page);
void draw_stages(const std::vector<Result>& results, Page& page);
void draw_scenes(const std::vector<Result>& results, Page& page);
void draw_peers(const std::vector<Result>& results, Page& page);
void draw_profile(const std::vector<Result>& results, Page& page);
void draw_prices(const std::vector<Result>& results, Page& page);

/// The page of some result files, in the order of their kinds, each drawn as its kind is. A folder stands for
/// the summary.json in it. No part that can be thinned takes more than `page_bytes`.
/// @throws ResultError, also while the page is written
Page page_of(const std::vector<std::filesystem::path>& files, std::size_t page_bytes = kDefaultPageBytes);

}  // namespace carom::report
