#include "measure/complexity.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace carom::measure {
namespace {

constexpr int kFitResamples = 1000;

struct Candidate {
    std::string_view name;
    double (*work)(double size);
};

constexpr std::array kCandidates{
    Candidate{"O(N)", [](double n) { return n; }},
    Candidate{"O(N log N)", [](double n) { return n * std::log2(n + 1); }},
    Candidate{"O(N^1.5)", [](double n) { return n * std::sqrt(n); }},
    Candidate{"O(N^2)", [](double n) { return n * n; }},
};

/// Root mean square of log(seconds / (c work)), with the c that makes it smallest.
double deviation_from(std::span<const Cost> costs, double (*work)(double)) {
    double mean = 0, square = 0;
    for (const Cost& cost : costs) mean += std::log(cost.seconds / work(cost.size));
    mean /= static_cast<double>(costs.size());
    for (const Cost& cost : costs) {
        const double off = std::log(cost.seconds / work(cost.size)) - mean;
        square += off * off;
    }
    return std::sqrt(square / static_cast<double>(costs.size()));
}

/// Where the logarithm of first / second goes from negative to positive for good; nothing if it does not.
std::optional<double> crossing(std::span<const Duel> duels, std::span<const double> log_ratio) {
    for (std::size_t i = duels.size() - 1; i > 0; --i) {
        if (log_ratio[i] <= 0) return std::nullopt;
        if (log_ratio[i - 1] > 0) continue;
        const double a = std::log(duels[i - 1].size), b = std::log(duels[i].size);
        return std::exp(a + (b - a) * -log_ratio[i - 1] / (log_ratio[i] - log_ratio[i - 1]));
    }
    return std::nullopt;
}

std::vector<double> median_log_ratios(std::span<const Duel> duels) {
    std::vector<double> result;
    for (const Duel& duel : duels) result.push_back(std::log(quantile(ratios(duel.first, duel.second), 0.5)));
    return result;
}

std::vector<double> resampled_log_ratios(std::span<const Duel> duels, Resampler& random) {
    std::vector<double> result;
    for (const Duel& duel : duels) {
        std::vector<double> sample(duel.first.size());
        for (double& value : sample) {
            const std::size_t round = random.draw(duel.first.size());
            value = duel.first[round] / duel.second[round];
        }
        result.push_back(std::log(quantile(sample, 0.5)));
    }
    return result;
}

}  // namespace

PowerLaw fit_power_law(std::span<const Cost> costs) {
    assert(costs.size() >= 2);
    const auto count = static_cast<double>(costs.size());
    double mean_x = 0, mean_y = 0;
    for (const Cost& cost : costs) {
        mean_x += std::log(cost.size) / count;
        mean_y += std::log(cost.seconds) / count;
    }
    double xx = 0, xy = 0;
    for (const Cost& cost : costs) {
        const double x = std::log(cost.size) - mean_x;
        xx += x * x;
        xy += x * (std::log(cost.seconds) - mean_y);
    }
    const double exponent = xy / xx;
    double residual = 0;
    for (const Cost& cost : costs) {
        const double off = std::log(cost.seconds) - mean_y - exponent * (std::log(cost.size) - mean_x);
        residual += off * off;
    }
    const double error =
        costs.size() > 2 ? std::sqrt(residual / (count - 2) / xx) : std::numeric_limits<double>::infinity();
    return {exponent, error, std::exp(mean_y - exponent * mean_x)};
}

Complexity nearest_complexity(std::span<const Cost> costs) {
    Complexity nearest{"", std::numeric_limits<double>::infinity()};
    for (const Candidate& candidate : kCandidates)
        if (const double off = deviation_from(costs, candidate.work); off < nearest.deviation)
            nearest = {candidate.name, off};
    return nearest;
}

Crossover find_crossover(std::span<const Duel> duels) {
    const std::vector<double> middle = median_log_ratios(duels);
    const std::optional<double> size = crossing(duels, middle);
    if (!size) {
        const bool second_wins = !middle.empty() && middle.back() > 0;
        return {second_wins ? Crossover::Kind::always : Crossover::Kind::never, {}};
    }
    Resampler random;
    std::vector<double> sizes;
    for (int i = 0; i < kFitResamples; ++i)
        if (const auto at = crossing(duels, resampled_log_ratios(duels, random))) sizes.push_back(*at);
    if (sizes.empty()) sizes.push_back(*size);
    return {Crossover::Kind::crosses, {*size, quantile(sizes, 0.025), quantile(sizes, 0.975)}};
}

}  // namespace carom::measure
