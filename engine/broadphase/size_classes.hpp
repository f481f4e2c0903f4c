#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace carom {

/// Bodies of one level of the grid differ in reach by at most this factor: a level costs every finer body a
/// look-up of 3 x 3 cells, a mixed level a few more bodies in each cell.
inline constexpr double kLargestRatioInLevel = 3;

inline constexpr std::uint8_t kNoLevel = 255;

/// Which bodies go to which level of the grid. Levels are ordered from coarse to fine.
template <class Real>
class SizeClasses {
  public:
    /// Sorts the reaches of all bodies that take part into as few levels as the ratio allows.
    /// @param flags  null, or a byte a body; see broadphase_flags.hpp
    void find(const Real* reach, const std::uint8_t* flags, std::size_t count);

    std::size_t level_count() const { return level_count_; }
    std::size_t bodies(std::size_t level) const { return bodies_[level]; }
    Real largest_reach(std::size_t level) const { return largest_[level]; }
    /// reach: of a body given to `find`, not disabled.
    std::uint8_t level_of(Real reach) const { return level_of_class_[class_of(reach)]; }

  private:
    static constexpr std::size_t kClasses = 512;

    /// Sign and exponent: powers of two apart.
    static std::size_t class_of(Real reach) {
        return std::bit_cast<std::uint32_t>(static_cast<float>(reach)) >> 23;
    }

    std::array<std::uint8_t, kClasses> level_of_class_{};
    std::array<std::size_t, kClasses> bodies_{};
    std::array<Real, kClasses> largest_{};
    std::size_t level_count_ = 0;
};

}  // namespace carom
