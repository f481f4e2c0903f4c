#pragma once

#include <cstdint>
#include <random>

namespace carom::test {

/// Numbers at random, the same on every machine.
class Draw {
  public:
    explicit Draw(std::uint32_t seed) : random_(seed) {}
    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
    }
    bool chance(double share) { return between(0, 1) < share; }

  private:
    std::mt19937 random_;
};

}  // namespace carom::test
