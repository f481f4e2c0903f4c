#include "state/radii.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace carom {
namespace {

/// Bins of an octave: the exponent of a positive float. Where no disc is much smaller than most, the usual
/// radius is then the smallest.
constexpr int kBitsBelowBin = 23;
constexpr std::size_t kBins = std::size_t{1} << (31 - kBitsBelowBin);

template <class Real>
std::size_t bin_of(Real radius) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(radius)) >> kBitsBelowBin;
}

/// The smallest radius of the first bin at which more discs have been counted than may be left out.
template <class Real>
double find_usual(const Bodies<Real>& bodies) {
    std::array<std::uint32_t, kBins> discs{};
    std::size_t count = 0;
    const Property<Real>& radii = bodies.inradius();
    for (std::size_t row = 0; row < bodies.count; ++row)
        if (!bodies.is_immovable(row)) ++discs[bin_of(radii[row])], ++count;
    if (count == 0) return 0;
    std::size_t bin = 0;
    for (std::size_t left_out = 0; (left_out += discs[bin]) * kUsualShare <= count;) ++bin;
    double usual = 0;
    for (std::size_t row = 0; row < bodies.count; ++row) {
        const Real radius = radii[row];
        if (bin_of(radius) != bin || bodies.is_immovable(row)) continue;
        usual = usual > 0 ? std::fmin(usual, radius) : static_cast<double>(radius);
    }
    return usual;
}

}  // namespace

template <class Real>
Radii measure_radii(const Bodies<Real>& bodies) {
    Radii radii;
    bool any = false;
    for (std::size_t row = 0; row < bodies.count; ++row) {
        if (bodies.flags_of(row) & (kEdges | kSensor)) continue;
        if (!bodies.is_disc(row) && bodies.is_immovable(row)) continue;
        const double radius = bodies.radius[row], inradius = bodies.inradius(row);
        radii.smallest = any ? std::fmin(radii.smallest, inradius) : inradius;
        radii.largest = std::fmax(radii.largest, radius);
        any = true;
        if (bodies.radius.is_uniform() && bodies.inradius().is_uniform()) break;
    }
    if (!bodies.inradius().is_uniform()) radii.usual = find_usual(bodies);
    if (!(radii.usual > 0)) radii.usual = radii.smallest;
    return radii;
}

template Radii measure_radii(const Bodies<float>&);
template Radii measure_radii(const Bodies<double>&);

}  // namespace carom
