#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/impulse/impacts/impact_calendar.hpp"

namespace carom {

/// An impact, and the tile that it happens in.
struct PlacedImpact {
    Impact impact;
    std::uint32_t tile;
};

/// Impacts that wait for their tile: those that were foreseen before the first tile begins, and those that
/// are foreseen on the way.
class ImpactLists {
  public:
    /// Counts and places by tile, so that a tile reads its own in one go.
    void begin(std::span<const PlacedImpact> foreseen, std::size_t tiles) {
        crossing_.clear(), first_crossing_.assign(tiles, kNone);
        begin_.assign(tiles + 2, 0);
        for (const PlacedImpact& placed : foreseen) ++begin_[placed.tile + 2];
        for (std::size_t tile = 0; tile + 1 < begin_.size(); ++tile) begin_[tile + 1] += begin_[tile];
        by_tile_.resize(foreseen.size());
        for (const PlacedImpact& placed : foreseen) by_tile_[begin_[placed.tile + 1]++] = placed.impact;
    }
    void add(const PlacedImpact& crossing) {
        crossing_.push_back({crossing.impact, first_crossing_[crossing.tile]});
        first_crossing_[crossing.tile] = static_cast<std::uint32_t>(crossing_.size() - 1);
    }
    /// How many of a tile were foreseen before the first one began.
    std::size_t expected(std::size_t tile) const { return begin_[tile + 1] - begin_[tile]; }
    /// Calls fn(impact) for those of a tile.
    template <class Fn>
    void for_each_of(std::size_t tile, const Fn& fn) const {
        for (std::size_t i = begin_[tile]; i < begin_[tile + 1]; ++i) fn(by_tile_[i]);
        for (std::uint32_t i = first_crossing_[tile]; i != kNone; i = crossing_[i].next)
            fn(crossing_[i].impact);
    }
    std::size_t bytes() const {
        const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
        return of(by_tile_) + of(begin_) + of(crossing_) + of(first_crossing_);
    }

  private:
    static constexpr std::uint32_t kNone = UINT32_MAX;

    struct Crossing {
        Impact impact;
        std::uint32_t next;  // of the same tile
    };

    std::vector<Impact> by_tile_;
    std::vector<std::size_t> begin_;  // of each tile in by_tile_
    std::vector<Crossing> crossing_;
    std::vector<std::uint32_t> first_crossing_;  // by tile
};

}  // namespace carom
