#pragma once

#include "broadphase/grid/size_classes.hpp"
#include "broadphase/grid/sorted_level.hpp"
#include "isa/kernel_table.hpp"
#include "parallel/executor.hpp"
#include "simd/prefetch.hpp"
#include "state/body_flags.hpp"
#include "state/columns/column.hpp"

#include <algorithm>
#include <span>
#include <vector>

namespace carom {

/// The columns that the grid is built from. They are padded and 64-byte aligned.
template <class Real>
struct GridInput {
    std::size_t count = 0;
    const Real* x = nullptr;      // m
    const Real* y = nullptr;      // m
    const Real* reach = nullptr;  // m, >= 0: radius plus the body's own slack
    const std::uint8_t* flags =
        nullptr;                     // null: none; else kImmovable, kNotInGrid. Read until find_candidates
    std::size_t standing = 0;        // the last rows: immovable bodies, in levels of their own
    bool is_standing_known = false;  // they are those of the last build: nothing is done for them
};

/// Pairs of rows; padded with pairs (count of bodies, count of bodies) to a multiple of kRowPadding.
struct CandidatePairs {
    Column<std::int32_t> a, b;  // no shorter than padded(count)
    std::size_t count = 0;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.a, self.b, self.count);
    }
};

/// The broadphase: bodies sorted into square cells, one level of cells for each class of size. Standing
/// bodies have levels of their own, which are sorted once: the others look into them.
///
/// Two bodies are candidates if dx² + dy² < (reach_a + reach_b)², computed in Real. Each such pair is found
/// once, in an order that depends on the input alone: not on threads, not on the instruction set. The world
/// has no edge: memory is O(bodies + pairs) wherever bodies are. Nothing is allocated once sizes have been
/// reached.
template <class Real>
class UniformGrid {
  public:
    /// Sorts the bodies. Cost: O(bodies), but for standing ones that are known, about 5 ns each
    /// (docs/decisions/0001-broadphase.md).
    void build(const GridInput<Real>& input, const KernelTable<Real>& kernels, const Executor& executor);

    /// Finds all candidate pairs of the bodies as they were built. Cost: O(bodies + pairs), but for standing
    /// bodies.
    const CandidatePairs& find_candidates(const Executor& executor);
    const CandidatePairs& candidates() const noexcept { return pairs_; }
    /// Keeps some of the candidate pairs, in their order.
    /// @param keep  keep(a, b, count) leaves these at the beginning of both lists and returns how many
    template <class Keep>
    void keep_pairs(const Keep& keep) {
        pairs_.count = keep(pairs_.a.data(), pairs_.b.data(), pairs_.count);
        pad_pairs();
    }

    /// Finds all bodies of the last build with distance to (x, y) < reach + theirs; not the disabled ones. A
    /// body's own row is among them if it is near. Fixed order.
    /// @param rows  holds what is found in [0, result); it grows as needed and is never made smaller.
    /// @param more  share by which all bodies of a level reach farther, of the largest of them
    std::size_t find_near(Real x, Real y, Real reach, Column<std::int32_t>& rows, Real more = 0) const;

    /// Rows in sorted order, [count]: by level, then by cell; disabled bodies last.
    std::span<const std::int32_t> order() const noexcept { return order_.span(); }

    /// Places of the bodies when the grid was built [m], by row, [padded(count)].
    const Column<Real>& built_x() const noexcept { return built_x_; }
    const Column<Real>& built_y() const noexcept { return built_y_; }

    /// Square blocks of cells of the finest level, counted from its lowest occupied cell, for callers that
    /// work through the plane piece by piece. Positions outside the grid belong to the blocks at its border.
    struct Block {
        std::size_t u, v;
    };
    Block block_of(double x, double y, double cells_a_side) const noexcept;
    /// One beyond the last block in each direction; nothing if the grid is folded, so that a block is no
    /// square.
    Block block_counts(double cells_a_side) const noexcept;
    /// Asks the memory for the cells of a block. Calls fn(rows) for its bodies, in pieces.
    template <class Fn>
    void prefetch_block(Block block, std::size_t cells_a_side, const Fn& fn) const {
        if (moving_.count == 0) return;
        const GridLevel<Real>& level = moving_.finest();
        const auto width = static_cast<std::size_t>(level.width);
        const auto lines = (static_cast<std::size_t>(level.cells) + width - 1) / width;
        const std::size_t left = block.u * cells_a_side, right = std::min(left + cells_a_side, width);
        const std::size_t top = std::min((block.v + 1) * cells_a_side, lines);
        for (std::size_t line = block.v * cells_a_side; line < top && left < right; ++line) {
            const std::int32_t* begin = level.bodies.cell_begin + line * width;
            const auto first = static_cast<std::size_t>(begin[left]),
                       last = static_cast<std::size_t>(begin[right]);
            for (std::size_t u = left; u < right; u += 64 / sizeof(std::int32_t)) prefetch(begin + u);
            fn(std::span<const std::int32_t>(level.bodies.row + first, last - first));
        }
    }

    std::size_t level_count() const noexcept { return moving_.count + standing_.count; }
    /// Coarse to fine, then those of standing bodies, for kernels that look around themselves in the grid.
    const GridLevel<Real>& level(std::size_t i) const noexcept {
        return i < moving_.count ? moving_[i] : standing_[i - moving_.count];
    }
    std::size_t bytes() const noexcept;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.count_, self.has_immovable_, self.moving_.count, self.moving_.levels, self.built_x_,
                self.built_y_);
        archive(self.standing_.count, self.standing_.levels);
        archive(self.order_, self.ordered_, self.pairs_);
    }
    /// To be called after the state was read: what looks around in the grid.
    void use(const KernelTable<Real>& kernels) { kernels_ = &kernels; }

  private:
    /// Levels, from coarse to fine.
    struct Levels {
        SizeClasses<Real> classes;
        std::vector<SortedLevel<Real>> levels;  // more than `count` after a richer scene
        std::size_t count = 0;

        const GridLevel<Real>& operator[](std::size_t i) const noexcept { return levels[i].view(); }
        const GridLevel<Real>& finest() const noexcept { return levels[count - 1].view(); }
    };
    /// Some consecutive rows of the columns.
    struct Rows {
        std::size_t first, count;
        const Real *x, *y, *reach;
        const std::uint8_t* flags;
    };
    static Rows rows_of(const GridInput<Real>& input, std::size_t first, std::size_t last) {
        return {first,           last - first,        input.x + first,
                input.y + first, input.reach + first, input.flags ? input.flags + first : nullptr};
    }

    void keep_positions(const GridInput<Real>& input, const Executor& executor);
    void build_moving(const GridInput<Real>& input, const Executor& executor);
    void build_one_level(const GridInput<Real>& input, const FindBounds<Real>& bounds,
                         const Executor& executor);
    void build_levels(Levels& levels, const Rows& rows, const Executor& executor);
    void sort_levels(Levels& levels, const Rows& rows, const Executor& executor);
    void split_by_level(const Levels& levels, const Rows& rows);
    void list_order(const Levels& levels, const Rows& rows);

    void find_in_level(const GridLevel<Real>& level, const Executor& executor);
    void find_across(const GridLevel<Real>& coarse, const GridLevel<Real>& fine);
    template <class IsFar>
    void look_into(const GridLevel<Real>& level, const GridLevel<Real>& probes,
                   Column<std::int32_t>& probe_rows, Column<std::int32_t>& found_rows, const IsFar& is_far);
    void look_at_standing(const GridLevel<Real>& level, const GridLevel<Real>& probes);
    void drop_immovable_pairs();
    void pad_pairs();

    const KernelTable<Real>* kernels_ = nullptr;
    std::size_t count_ = 0;
    const std::uint8_t* flags_ = nullptr;
    bool has_immovable_ = false;

    Levels moving_, standing_;
    Column<Real> built_x_, built_y_;

    /// Bodies by level, in the order of rows. Each level starts at a multiple of kRowPadding.
    struct {
        Column<Real> x, y, reach;
        Column<std::int32_t> row;
        std::vector<std::size_t> first, next;  // place of each level
    } split_;

    Column<std::int32_t> order_;
    std::size_t ordered_ = 0;

    CandidatePairs pairs_;
    std::vector<CandidatePairs> chunk_pairs_;
    mutable Column<std::int32_t> near_;
};

}  // namespace carom
