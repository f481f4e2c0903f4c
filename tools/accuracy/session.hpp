#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "accuracy/results.hpp"

namespace carom::accuracy {

struct Request {
    std::vector<const Case*> cases;
    bool quick = false;
    std::filesystem::path folder;  ///< where points are kept until all are measured
};

struct Progress {
    std::int64_t done = 0, total = 0;  ///< points
};

/// Measures every point of every case. Points go into `points.jsonl` in the folder as they are measured; what
/// an earlier run of this version with the same settings left there is not measured again.
/// @param stop  asked between runs; then what there is so far is returned
/// @throws tool::WriteError
struct Measured {
    std::vector<CaseResult> results;
    bool is_complete = false;
};
Measured measure_all(const Request& request, const std::function<void(const Progress&)>& report,
                     const std::function<bool()>& stop);

/// Removes the points kept for resuming.
void forget_points(const std::filesystem::path& folder);

}  // namespace carom::accuracy
