#include "broadphase/grid/size_classes.hpp"

#include "state/body_flags.hpp"

#include <algorithm>
#include <numbers>

namespace carom {
namespace {

constexpr double kPackedFraction = 0.9;  // share of the plane that discs of mixed sizes fill at most

template <class Real>
bool is_within_ratio(Real smallest, Real largest) {
    return static_cast<double>(smallest) * kLargestRatioInLevel >= static_cast<double>(largest);
}

}  // namespace

template <class Real>
void SizeClasses<Real>::count(const Real* reach, const std::uint8_t* flags, std::size_t count) {
    classes_.assign(kClasses, {});
    levels_.resize(kClasses), level_of_class_.resize(kClasses);
    for (std::size_t row = 0; row < count; ++row) {
        if (flags && (flags[row] & kNotInGrid)) continue;
        Members& members = classes_[class_of(reach[row])];
        members.smallest = members.bodies == 0 ? reach[row] : std::min(members.smallest, reach[row]);
        members.largest = std::max(members.largest, reach[row]);
        members.area += static_cast<double>(reach[row]) * static_cast<double>(reach[row]);
        ++members.bodies;
    }
}

template <class Real>
bool SizeClasses<Real>::fits(const Members& level, const Members& finer, Grouping grouping) {
    if (is_within_ratio(finer.smallest, level.largest)) return true;
    if (grouping == Grouping::by_ratio) return false;
    const double side = 2 * static_cast<double>(level.largest);
    const double area_a_body =
        std::numbers::pi * (level.area + finer.area) / static_cast<double>(level.bodies + finer.bodies);
    return kPackedFraction * side * side <= kMostBodiesInPackedCell * area_a_body;
}

template <class Real>
void SizeClasses<Real>::group(Grouping grouping) {
    level_count_ = 0;
    for (std::size_t c = kClasses; c-- > 0;) {
        const Members& finer = classes_[c];
        if (finer.bodies == 0) continue;
        if (level_count_ == 0 || !fits(levels_[level_count_ - 1], finer, grouping))
            levels_[level_count_++] = finer;
        else {
            Members& level = levels_[level_count_ - 1];
            level.bodies += finer.bodies;
            level.smallest = finer.smallest;
            level.area += finer.area;
        }
        level_of_class_[c] = static_cast<std::uint16_t>(level_count_ - 1);
    }
}

template <class Real>
bool SizeClasses<Real>::is_mixed(std::size_t level) const {
    return !is_within_ratio(levels_[level].smallest, levels_[level].largest);
}

template class SizeClasses<float>;
template class SizeClasses<double>;

}  // namespace carom
