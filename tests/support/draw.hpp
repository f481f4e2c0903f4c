#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

namespace carom::test {

/// Random numbers, the same on every machine and with every library.
class Draw {
  public:
    explicit Draw(std::uint32_t seed) : random_(seed) {}
    double operator()(double low, double high) {
        return low + (high - low) * static_cast<double>(random_()) / 4294967295.0;
    }
    /// As likely in each power of ten.
    double size(double low, double high) { return low * std::pow(high / low, (*this)(0, 1)); }
    std::size_t below(std::size_t count) { return random_() % count; }
    bool chance(double share) { return (*this)(0, 1) < share; }

  private:
    std::mt19937 random_;
};

}  // namespace carom::test
