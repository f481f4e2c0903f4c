#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/grid/uniform_grid.hpp"
#include "math/vec2_math.hpp"

namespace carom {

// The memory that the impacts of a tile touch, some 40 bytes a body, is to fit into a second-level cache of
// 1 MiB beside what else is in it. A world of no more bodies than the first is one tile.
inline constexpr std::size_t kBodiesOfOneTile = 16384;
inline constexpr double kMeanBodiesOfTile = 12000;
// Lines of the grid's cells in a tile: fewer, and many impacts are at a border; and threads that work on two
// tiles beside one are to stay out of each other's way.
inline constexpr std::int64_t kFewestLines = 12;
inline constexpr std::int64_t kMostLines = 24;

/// The lines of the grid that the work on a tile may touch while others are worked on: its own, and half of
/// the tiles beside it, but for some lines between it and the reach of the next. Lines are counted around:
/// the first follows the last.
class TileReach {
  public:
    bool is_unbounded() const { return is_unbounded_; }
    /// Whether bodies of a line may be moved.
    bool owns(std::int64_t line) const { return is_unbounded_ || beyond(line) < lines_; }
    /// Whether a kernel may look around in lines bottom ... top: it may begin and end in lines beside them.
    bool may_look(std::int64_t bottom, std::int64_t top) const {
        return is_unbounded_ ||
               beyond(bottom - kLinesBeside) + (top - bottom) + 1 + 2 * kLinesBeside <= lines_to_look_at_;
    }

  private:
    friend class Tiles;
    /// A body's line may be off by one through rounding, and the cell beside the first of a line is the last
    /// of the line before.
    static constexpr std::int64_t kLinesBeside = 2;

    /// How far a line is beyond the first; of one before it the way around.
    std::int64_t beyond(std::int64_t line) const {
        const std::int64_t lines = line - first_;
        return lines < 0 ? lines + all_ : lines;
    }

    bool is_unbounded_ = true;
    std::int64_t first_ = 0, lines_ = 0, lines_to_look_at_ = 0, all_ = 0;
};

/// The plane cut into tiles, each some lines of the grid's cells, and the phases in which they are worked
/// through: first every second tile, side by side, then the others. Where the grid is folded or has several
/// levels a phase has one tile, as what is near a tile is not near it in the grid.
class Tiles {
  public:
    template <class Real>
    void begin(const UniformGrid<Real>& grid, std::size_t bodies) {
        count_ = 1, is_folded_ = is_side_by_side_ = false;
        if (bodies <= kBodiesOfOneTile) return;
        const GridLevel<Real>* level = grid.level_count() > 0 ? &grid.level(0) : nullptr;
        cut(level ? &level->numbering : nullptr, bodies, grid.level_count() == 1);
        if (is_side_by_side_) find_reaches(level->bodies.cell_begin);
    }

    std::size_t count() const { return count_; }
    std::size_t tile_of(Vec2 place) const {
        if (count_ == 1) return 0;
        const std::int64_t line = line_of(place.y);
        if (is_folded_) return static_cast<std::size_t>(line / kMostLines) % count_;
        return tile_of_line_[static_cast<std::size_t>(line)];
    }
    std::int64_t line_of(double y) const {
        return static_cast<std::int64_t>(std::clamp(y * inverse_size_, low_, high_) - low_);
    }

    std::size_t phases() const { return is_side_by_side_ ? 2 : count_; }
    std::size_t phase_of(std::size_t tile) const { return is_side_by_side_ ? tile % 2 : tile; }
    std::size_t tiles_of(std::size_t phase) const { return is_side_by_side_ ? (count_ + 1 - phase) / 2 : 1; }
    /// The nth tile of a phase.
    std::size_t tile(std::size_t phase, std::size_t n) const {
        return is_side_by_side_ ? phase + 2 * n : phase;
    }
    /// The lines that the work on a tile may touch; known where a world has several tiles.
    const TileReach& reach(std::size_t tile) const { return reaches_[tile]; }

    /// The rows of the bodies of a tile, if it is a piece of the plane; in the order of the cells.
    template <class Real>
    std::span<const std::int32_t> rows(std::size_t tile, const UniformGrid<Real>& grid) const {
        if (is_folded_ || count_ == 1) return {};
        const GridLevel<Real>& level = grid.level(0);
        const auto place = [&](std::size_t line) {
            const std::int64_t cell = static_cast<std::int64_t>(line) * level.width;
            return static_cast<std::size_t>(
                level.bodies.cell_begin[std::min<std::int64_t>(cell, level.cells)]);
        };
        const std::size_t first = place(first_line_[tile]), last = place(first_line_[tile + 1]);
        return {level.bodies.row + first, last - first};
    }

    std::size_t bytes() const {
        return tile_of_line_.capacity() * sizeof(std::uint32_t) +
               first_line_.capacity() * sizeof(std::size_t) + reaches_.capacity() * sizeof(TileReach);
    }

  private:
    void cut(const CellNumbering* cells, std::size_t bodies, bool may_be_side_by_side);
    /// @param cell_begin  the first place of each cell
    void find_reaches(const std::int32_t* cell_begin);

    std::size_t count_ = 1;
    bool is_folded_ = false, is_side_by_side_ = false;
    double inverse_size_ = 0, low_ = 0, high_ = 0;  // 1/m; lines
    std::int64_t width_ = 0, lines_ = 0;            // cells of a line
    std::vector<std::uint32_t> tile_of_line_;
    std::vector<std::size_t> first_line_;  // of each tile, and the end
    std::vector<TileReach> reaches_;       // by tile
};

}  // namespace carom
