#include "solvers/substeps/body_masses.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/contact_sets/local_solve.hpp"

namespace carom {
namespace {

/// Ratios of masses beyond which sweeps do not do, with room for rounded ones.
constexpr double kVeryUneven = 1010;
constexpr double kVeryUnevenSmooth = 303;  // without friction
/// Heavy and light bodies are mixed if there is one of either in so many bodies.
constexpr std::size_t kMixed = 64;

}  // namespace

template <class Real>
bool BodyMasses<Real>::derive(const Bodies<Real>& bodies, bool has_friction, bool discs_may_turn) {
    if (are_known_) return false;
    vary_ = !bodies.mass.is_uniform() || bodies.has_flags;
    some_are_fixed_ = false;
    if (vary_) inverse_.resize(bodies.count);
    double lightest = 0, heaviest = 0;  // inverse
    for (std::size_t row = 0; row < bodies.moving() && vary_; ++row) {
        const bool may_turn = discs_may_turn || !bodies.is_disc(row);
        const bool is_fixed = may_turn && (bodies.flags_of(row) & kFixedAngle) != 0;
        const double inverse = bodies.inverse_mass(row);
        inverse_[row] = static_cast<Real>(is_fixed ? -inverse : inverse);
        some_are_fixed_ = some_are_fixed_ || is_fixed;
        if (!(inverse > 0)) continue;
        lightest = std::fmax(lightest, inverse);
        heaviest = heaviest > 0 ? std::fmin(heaviest, inverse) : inverse;
    }
    if (vary_) std::fill(inverse_.begin() + bodies.moving(), inverse_.end(), Real(0));
    ratio_ = heaviest > 0 ? lightest / heaviest : 1;
    are_uneven_ = lightest > LocalSolve<Real>::kUneven * heaviest;
    const double very_uneven = has_friction ? kVeryUneven : kVeryUnevenSmooth;
    are_very_uneven_ = lightest > very_uneven * heaviest;
    std::size_t light = 0, heavy = 0;
    for (std::size_t row = 0; row < bodies.count && are_very_uneven_; ++row) {
        const double inverse = bodies.inverse_mass(row);
        if (!(inverse > 0)) continue;
        light += inverse > very_uneven * heaviest ? 1 : 0;
        heavy += lightest > very_uneven * inverse ? 1 : 0;
    }
    are_mixed_ = kMixed * std::min(light, heavy) >= std::max<std::size_t>(bodies.count, 1);
    return are_known_ = true;
}

template class BodyMasses<float>;
template class BodyMasses<double>;

}  // namespace carom
