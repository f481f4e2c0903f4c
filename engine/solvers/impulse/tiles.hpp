#pragma once

#include <cstddef>

#include "broadphase/uniform_grid.hpp"
#include "math/vec2_math.hpp"

namespace carom {

// The memory that the impacts of a tile touch, some 40 bytes a body, is to fit into a second-level cache of
// 1 MiB beside what else is in it. The side is in cells of the grid, which hold one to two bodies in a gas.
inline constexpr std::size_t kBodiesOfOneTile = 16384;
inline constexpr std::size_t kTileCells = 80;

/// The plane cut into square blocks of the grid's cells. Where the grid is folded, so that its blocks are no
/// squares, they are numbered on a torus and several share a number.
class Tiles {
  public:
    Tiles() = default;

    /// One tile for a small world.
    template <class Real>
    Tiles(const UniformGrid<Real>& grid, std::size_t bodies) {
        if (bodies <= kBodiesOfOneTile) return;
        const auto blocks = grid.block_counts(kTileCells);
        is_folded_ = blocks.u == 0;
        if (!is_folded_) {
            across_ = blocks.u, up_ = blocks.v;
            return;
        }
        while (across_ * up_ * kTileCells * kTileCells < bodies) ++across_, ++up_;
    }

    std::size_t count() const { return across_ * up_; }

    template <class Real>
    std::size_t tile_of(const UniformGrid<Real>& grid, Vec2 place) const {
        if (count() == 1) return 0;
        const auto block = grid.block_of(place.x, place.y, kTileCells);
        return is_folded_ ? block.v % up_ * across_ + block.u % across_ : block.v * across_ + block.u;
    }

    /// Asks the memory for the cells of a tile, if it is one block; calls fn(rows) for its bodies, in pieces.
    template <class Real, class Fn>
    void prefetch(std::size_t tile, const UniformGrid<Real>& grid, const Fn& fn) const {
        if (!is_folded_) grid.prefetch_block({tile % across_, tile / across_}, kTileCells, fn);
    }

  private:
    std::size_t across_ = 1, up_ = 1;
    bool is_folded_ = false;
};

}  // namespace carom
