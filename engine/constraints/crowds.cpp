#include "constraints/crowds.hpp"

#include <algorithm>

#include "math/random.hpp"

namespace carom {
namespace {

/// Candidates a body, all in all and of one body, from which on a heap of bodies in one place is thinned out.
constexpr std::size_t kCrowdedMean = 8;
constexpr std::size_t kCrowded = 128;
/// Bodies that overlap by more than this share of the smaller radius do not merely lie on each other.
constexpr double kDeep = 0.2;
/// Candidates of a body in a crowd that are kept, on average, of those that overlap it deeply.
constexpr std::uint64_t kKept = 48;

}  // namespace

template <class Real>
void Crowds<Real>::find(const Candidates<Real>& candidates, const Bodies<Real>& bodies) {
    clear();
    if (candidates.pair_count() < kCrowdedMean * bodies.moving()) return;
    candidates_of_.assign(bodies.count, 0);
    for (std::size_t p = 0; p < candidates.pair_count(); ++p) {
        const std::int32_t a = candidates.pair_a()[p], b = candidates.pair_b()[p];
        if (!bodies.are_discs(a, b)) continue;
        ++candidates_of_[static_cast<std::size_t>(a)], ++candidates_of_[static_cast<std::size_t>(b)];
    }
    if (*std::max_element(candidates_of_.begin(), candidates_of_.end()) <= kCrowded) clear();
}

template <class Real>
bool Crowds<Real>::leave_out(std::int32_t a, std::int32_t b, const Bodies<Real>& bodies,
                             std::int64_t draw) const {
    const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
    const std::uint64_t crowd = std::min(candidates_of_[i], candidates_of_[k]);
    if (crowd <= kCrowded) return false;
    const Real dx = bodies.position_x[k] - bodies.position_x[i],
               dy = bodies.position_y[k] - bodies.position_y[i];
    const Real of_a = bodies.radius[i], of_b = bodies.radius[k];
    const Real deep = of_a + of_b - static_cast<Real>(kDeep) * std::min(of_a, of_b);
    if (!(dx * dx + dy * dy < deep * deep)) return false;
    const auto name = static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
    return Random(Random(name).next() + static_cast<std::uint64_t>(draw)).next() % crowd >= kKept;
}

template class Crowds<float>;
template class Crowds<double>;

}  // namespace carom
