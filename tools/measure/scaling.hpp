#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "measure/contest.hpp"
#include "measure/json.hpp"

namespace carom::measure {

inline constexpr std::int64_t kMostNaiveBodies = 10'000;  // a step of the naive loop takes 0.1 s there
inline constexpr std::int64_t kMostPairsBodies = 30'000;  // likewise all pairs with SIMD

/// One method at one size.
struct ScalingRow {
    std::string method;  ///< "naive", "all pairs", "grid scalar", ..., "grid avx2 2 threads"
    std::int64_t bodies = 0;
    std::vector<double> seconds{};  ///< a step, by round; the same rounds for all methods of a size
    double pairs_per_body = 0;      ///< candidate pairs that are looked at in a step
    double contacts_per_body = 0;   ///< overlaps or impacts in a step
    double bytes_per_body = 0;      ///< all memory the method holds
};

struct ScalingOptions {
    std::int64_t max_bodies = 1'000'000;
    ContestOptions contest{};
    /// Told before each size.
    std::function<void(std::int64_t bodies)> progress = [](std::int64_t) {};
    std::function<bool()> is_interrupted = [] { return false; };
};

/// 10, 30, 100, ... up to `max`, which is the last one.
std::vector<std::int64_t> scaling_sizes(std::int64_t max);

/// Time of a step of the gas against the number of bodies: the naive loop, all pairs with SIMD, the engine
/// with each instruction set on one thread and with the best one on two. All methods of a size start from the
/// same state and take turns.
std::vector<ScalingRow> run_scaling(const ScalingOptions& options);

/// The rows, for each method how time grows with the number of bodies, and from which number of bodies the
/// engine is faster than the other two. @return a result file of the kind "scaling"
Json scaling_json(const std::vector<ScalingRow>& rows);

/// A table of the same for a terminal.
std::string scaling_text(const Json& scaling);

}  // namespace carom::measure
