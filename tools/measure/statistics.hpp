#pragma once

#include <span>
#include <vector>

namespace carom::measure {

/// The middle of some measurements, and how far they lie apart.
struct Spread {
    double median = 0;
    double low = 0;   ///< lower end: a quartile, or of a confidence interval
    double high = 0;  ///< upper end
};

/// The value below which a fraction of the values lies, interpolated between neighbours.
/// @param values    at least one, in any order
/// @param fraction  0 ... 1
double quantile(std::span<const double> values, double fraction);

/// Median and quartiles. @param values  at least one
Spread quartiles(std::span<const double> values);

/// The median of `values` with its 95 % confidence interval: percentile bootstrap, so nothing is assumed of
/// how they are distributed. The same values give the same interval.
/// @param values  at least one; fewer than six make an interval that is too narrow
/// Source: Efron & Tibshirani, "An Introduction to the Bootstrap" (1993), chapter 13.
Spread median_interval(std::span<const double> values);

/// a[i] / b[i]: the ratio of two contestants, round by round. Drift of the machine between rounds cancels.
/// @param a, b  of equal length, b not zero
std::vector<double> ratios(std::span<const double> a, std::span<const double> b);

/// Draws whole numbers; the same on every machine.
class Resampler {
  public:
    /// A number in [0, count).
    std::size_t draw(std::size_t count);

  private:
    unsigned long long state_ = 0x9e3779b97f4a7c15ULL;
};

}  // namespace carom::measure
