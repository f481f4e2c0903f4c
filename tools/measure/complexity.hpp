#pragma once

#include <span>
#include <string_view>

#include "measure/statistics.hpp"

namespace carom::measure {

/// What something cost at one size.
struct Cost {
    double size = 0;     ///< bodies, > 0
    double seconds = 0;  ///< > 0
};

/// seconds ~ coefficient * size^exponent, fitted to the logarithms by least squares.
struct PowerLaw {
    double exponent = 0;
    double exponent_error = 0;  ///< standard error; infinite with two points
    double coefficient = 0;     ///< s
};

/// @param costs  two at least, of different sizes
PowerLaw fit_power_law(std::span<const Cost> costs);

/// Which of O(N), O(N log N), O(N^1.5), O(N²) is nearest the costs, and how near: the root mean square of
/// log(seconds / fit), so that 0.1 means about 10 %.
struct Complexity {
    std::string_view name;
    double deviation = 0;
};

/// @param costs  one at least
Complexity nearest_complexity(std::span<const Cost> costs);

/// Two contestants at one size: seconds of each round, the same rounds for both.
struct Duel {
    double size = 0;
    std::span<const double> first, second;
};

/// The size at which `second` becomes faster than `first`: where the ratio of their times crosses 1,
/// interpolated in logarithms. low and high: 95 % of what resampled rounds give.
struct Crossover {
    enum class Kind { crosses, always, never } kind = Kind::never;
    Spread size{};  ///< without meaning unless it crosses
};

/// @param duels  ascending sizes, each with as many rounds of both, one at least
Crossover find_crossover(std::span<const Duel> duels);

}  // namespace carom::measure
