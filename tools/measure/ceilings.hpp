#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "measure/json.hpp"

namespace carom::measure {

/// How fast one core copies when both arrays together have so many bytes.
struct CopyBandwidth {
    std::string level;  ///< where they fit: "L1", "L2", "L3", "memory"
    std::size_t bytes = 0;
    double bytes_per_second = 0;  ///< read and written together
};

/// The most additions and multiplications a second of one core, half of each, no fused ones, as the engine
/// computes.
struct ArithmeticPeak {
    std::string isa;
    double single_per_second = 0;
    double double_per_second = 0;
};

/// What this machine can do at most, on one core: the roof of the roofline.
/// Source: Williams, Waterman & Patterson, "Roofline", CACM 52 (2009).
struct Ceilings {
    std::vector<CopyBandwidth> copy;   // ascending sizes
    std::vector<ArithmeticPeak> peak;  // of the instruction sets this machine runs

    /// Of the smallest level that holds so many bytes.
    const CopyBandwidth& copy_of(std::size_t working_set) const;
    /// The one of that name. @throws std::out_of_range
    const ArithmeticPeak& peak_of(const std::string& isa) const;
};

/// Takes about `seconds` of processor time for each of its ten figures; each is the best of several tries.
Ceilings measure_ceilings(double seconds = 0.05);

Json ceilings_json(const Ceilings& ceilings);

/// What a loop does for one item.
struct Work {
    double bytes = 0;       ///< read and written, each once
    double operations = 0;  ///< additions, multiplications, comparisons, minima on numbers
};

/// What share of the roof a loop reaches: the larger of its bytes a second over the bandwidth and its
/// operations a second over the peak. Which of the two it is.
struct RoofShare {
    double share = 0;
    bool is_memory = false;  ///< the roof above it is bandwidth
};
RoofShare roof_share(const Work& work, double items_per_second, double bandwidth, double peak);

}  // namespace carom::measure
