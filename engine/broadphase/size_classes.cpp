#include "broadphase/size_classes.hpp"

#include "state/body_flags.hpp"

#include <algorithm>
#include <limits>

namespace carom {

template <class Real>
void SizeClasses<Real>::find(const Real* reach, const std::uint8_t* flags, std::size_t count) {
    std::array<std::size_t, kClasses> members{};
    std::array<Real, kClasses> smallest, largest;
    smallest.fill(std::numeric_limits<Real>::infinity());
    largest.fill(0);
    for (std::size_t row = 0; row < count; ++row) {
        if (flags && (flags[row] & kDisabled)) continue;
        const std::size_t c = class_of(reach[row]);
        ++members[c];
        smallest[c] = std::min(smallest[c], reach[row]);
        largest[c] = std::max(largest[c], reach[row]);
    }

    level_count_ = 0;
    for (std::size_t c = kClasses; c-- > 0;) {
        if (members[c] == 0) continue;
        const bool fits = level_count_ > 0 && static_cast<double>(smallest[c]) * kLargestRatioInLevel >=
                                                  static_cast<double>(largest_[level_count_ - 1]);
        if (!fits) {
            largest_[level_count_] = largest[c];
            bodies_[level_count_] = 0;
            ++level_count_;
        }
        level_of_class_[c] = static_cast<std::uint8_t>(level_count_ - 1);
        bodies_[level_count_ - 1] += members[c];
    }
}

template class SizeClasses<float>;
template class SizeClasses<double>;

}  // namespace carom
