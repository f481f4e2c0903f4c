#pragma once

#include <optional>
#include <string>

namespace carom::measure {

/// What is known of a stage when it is asked what limits it.
struct StageFacts {
    double bodies = 0;
    double seconds_per_call = 0;
    double seconds_of_a_reading = 25e-9;  ///< of the clock that it is timed with
    std::optional<double> roof_share{};   ///< of the nearer roof
    bool roof_is_memory = false;
    std::string level{};                   ///< "L1", ..., "memory": what the world fits in
    std::optional<double> times_scalar{};  ///< how much faster than with scalar kernels
};

/// What limits a stage, in words: memory, arithmetic, branching, or too few bodies.
std::string limit_of(const StageFacts& facts);

}  // namespace carom::measure
