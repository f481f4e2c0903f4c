#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <span>

namespace carom::torture {

/// Random numbers that are the same on every machine: the bits of std::mt19937_64 are fixed by the standard,
/// those of its distributions are not.
class Random {
  public:
    Random(std::uint64_t seed, std::uint64_t index) {
        std::seed_seq both{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                           static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32)};
        bits_.seed(both);
    }

    /// In [low, high).
    double uniform(double low = 0, double high = 1) {
        return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
    }
    /// In [low, high), every octave as likely.
    double log_uniform(double low, double high) { return low * std::exp(uniform() * std::log(high / low)); }
    /// In [low, high), every octave there, the lower ones the more often the higher the `power` (1: as
    /// often).
    double skewed(double low, double high, double power) {
        return low * std::pow(high / low, std::pow(uniform(), power));
    }
    bool chance(double probability) { return uniform() < probability; }
    std::size_t below(std::size_t count) {
        return static_cast<std::size_t>(uniform() * static_cast<double>(count));
    }
    template <class Value>
    Value one_of(std::span<const Value> values) {
        return values[below(values.size())];
    }
    /// Mean 0, variance 1: a sum of twelve uniforms.
    double normal() {
        double sum = -6;
        for (int i = 0; i < 12; ++i) sum += uniform();
        return sum;
    }

  private:
    std::mt19937_64 bits_;
};

}  // namespace carom::torture
