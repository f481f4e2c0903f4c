#include "measure/statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace carom::measure {
namespace {

constexpr int kResamples = 2000;
constexpr double kTail = 0.025;  // of 95 %

}  // namespace

double quantile(std::span<const double> values, double fraction) {
    assert(!values.empty());
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    const double place = fraction * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    const double weight = place - static_cast<double>(below);
    return sorted[below] + weight * (sorted[above] - sorted[below]);
}

Spread quartiles(std::span<const double> values) {
    return {quantile(values, 0.5), quantile(values, 0.25), quantile(values, 0.75)};
}

Spread median_interval(std::span<const double> values) {
    Resampler random;
    std::vector<double> sample(values.size()), medians;
    medians.reserve(kResamples);
    for (int i = 0; i < kResamples; ++i) {
        for (double& value : sample) value = values[random.draw(values.size())];
        medians.push_back(quantile(sample, 0.5));
    }
    return {quantile(values, 0.5), quantile(medians, kTail), quantile(medians, 1 - kTail)};
}

std::vector<double> ratios(std::span<const double> a, std::span<const double> b) {
    assert(a.size() == b.size());
    std::vector<double> result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] / b[i];
    return result;
}

std::size_t Resampler::draw(std::size_t count) {
    state_ ^= state_ << 13;  // xorshift64 (Marsaglia 2003)
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<std::size_t>((state_ >> 11) % count);
}

}  // namespace carom::measure
