#include "decay.hpp"

#include <cmath>

namespace carom {
namespace {

constexpr double kLargestExponent = 708;  // exp(-708) is just above the smallest normal number
// ln 2 in two parts; the first has 32 bits, so that its product with a count of halvings is exact.
constexpr double kLog2High = 0x1.62e42feep-1, kLog2Low = 0x1.a39ef35793c76p-33;
constexpr int kTerms = 14;  // (ln 2 / 2)^15 / 15! < 2^-60

}  // namespace

double decay(double exponent) {
    if (exponent > kLargestExponent) return 0;
    const double halvings = std::floor(exponent / (kLog2High + kLog2Low) + 0.5);
    const double rest = (halvings * kLog2High - exponent) + halvings * kLog2Low;  // within ln 2 / 2 of zero
    double sum = 1;  // Taylor's series from its far end
    for (int term = kTerms; term >= 1; --term) sum = 1 + rest / term * sum;
    return std::ldexp(sum, -static_cast<int>(halvings));
}

}  // namespace carom
