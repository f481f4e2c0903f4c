#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom {

/// Bodies whose reaches differ by at most this factor share a level of the grid without further thought.
inline constexpr double kLargestRatioInLevel = 3;

/// Other sizes share a level as long as it holds about so many bodies a cell where bodies are packed: looking
/// at them costs less than looking up another level (docs/decisions/0001-broadphase.md).
inline constexpr double kMostBodiesInPackedCell = 16;

/// How sizes are put together.
enum class Grouping : std::uint8_t {
    by_area,   ///< trusts that bodies hardly overlap: large ones leave little room for small ones
    by_ratio,  ///< trusts nothing
};

/// Which bodies go to which level of the grid. Levels are ordered from coarse to fine.
template <class Real>
class SizeClasses {
  public:
    /// Counts the bodies of each power of two of reach.
    /// @param flags  null, or a byte a body; see body_flags.hpp
    void count(const Real* reach, const std::uint8_t* flags, std::size_t count);

    /// Puts them into as few levels as the grouping allows.
    void group(Grouping grouping);

    std::size_t level_count() const { return level_count_; }
    std::size_t bodies(std::size_t level) const { return levels_[level].bodies; }
    Real largest_reach(std::size_t level) const { return levels_[level].largest; }
    /// Whether sizes in the level differ by more than kLargestRatioInLevel.
    bool is_mixed(std::size_t level) const;
    /// reach: of a body that was counted.
    std::size_t level_of(Real reach) const { return level_of_class_[class_of(reach)]; }

    std::size_t bytes() const {
        return (classes_.capacity() + levels_.capacity()) * sizeof(Members) +
               level_of_class_.capacity() * sizeof(std::uint16_t);
    }

  private:
    static constexpr std::size_t kClasses = 512;  // signs and exponents of a float

    struct Members {
        std::size_t bodies = 0;
        Real smallest = 0, largest = 0;  // m
        double area = 0;                 // m², sum of reach²
    };

    /// Sign and exponent: powers of two apart.
    static std::size_t class_of(Real reach) {
        return std::bit_cast<std::uint32_t>(static_cast<float>(reach)) >> 23;
    }
    static bool fits(const Members& level, const Members& finer, Grouping grouping);

    // [kClasses] each; empty as long as all bodies are of one size.
    std::vector<Members> classes_, levels_;
    std::vector<std::uint16_t> level_of_class_;
    std::size_t level_count_ = 0;
};

}  // namespace carom
