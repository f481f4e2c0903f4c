#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>

#include "shapes/walls.hpp"

namespace carom {

/// The other side of a contact: a body's row, a wall, or an edge of a segment or chain. Columns keep it as
/// one number, `stored`; only this type knows what the number means.
class Partner {
  public:
    static constexpr Partner body(std::int32_t row) { return Partner(row); }
    static constexpr Partner wall(std::int32_t side) { return Partner(side); }
    static constexpr Partner edge(std::int32_t number) { return Partner(kFirstEdge - number); }
    /// What is no longer there.
    static constexpr Partner gone() { return Partner(kGone); }

    constexpr explicit Partner(std::int32_t stored) : stored_(stored) {}
    constexpr std::int32_t stored() const { return stored_; }

    /// A row of a body, awake or asleep, or of padding.
    constexpr bool is_body() const { return stored_ >= 0; }
    /// @param awake  bodies, whose rows come before those of sleepers
    constexpr bool is_sleeper(std::size_t awake) const {
        return is_body() && static_cast<std::size_t>(stored_) >= awake;
    }
    constexpr bool is_wall() const { return stored_ < 0 && stored_ > kFirstEdge; }
    constexpr bool is_edge() const { return stored_ <= kFirstEdge && stored_ != kGone; }
    constexpr bool is_gone() const { return stored_ == kGone; }

    constexpr std::int32_t row() const { return assert(is_body()), stored_; }
    /// A WallSide.
    constexpr std::int32_t side() const { return assert(is_wall()), stored_; }
    /// Number in EdgeStore::edges.
    constexpr std::int32_t edge_number() const { return assert(is_edge()), kFirstEdge - stored_; }

    friend constexpr bool operator==(Partner, Partner) = default;

  private:
    static constexpr std::int32_t kFirstEdge = -5;  // walls are -1 ... -4 (WallSide)
    static constexpr std::int32_t kGone = INT32_MIN;

    std::int32_t stored_;
};
static_assert(kTop == -4 && Partner::wall(kTop).is_wall() && Partner::edge(0).is_edge());

}  // namespace carom
