#include "solvers/impulse/impacts/tiles.hpp"

namespace carom {
namespace {

/// Places that kernels read beyond the last cell they look at.
constexpr std::size_t kPlacesOfBatch = 16;

}  // namespace

void Tiles::cut(const CellNumbering* cells, std::size_t bodies, bool may_be_side_by_side) {
    reaches_.assign(1, {});
    if (!cells) return;
    inverse_size_ = cells->inverse_size, low_ = cells->low_v, high_ = cells->high_v;
    is_folded_ = cells->wraps;
    if (is_folded_) {
        count_ = bodies / (kBodiesOfOneTile / 2) + 1;
        reaches_.assign(count_, {});
        return;
    }
    width_ = static_cast<std::int64_t>(cells->width);
    lines_ = static_cast<std::int64_t>(cells->high_v - cells->low_v) + 1;
    const double lines_of_tile =
        static_cast<double>(lines_) * kMeanBodiesOfTile / static_cast<double>(bodies);
    const auto height = static_cast<std::int64_t>(std::clamp<double>(
        lines_of_tile, may_be_side_by_side ? kFewestLines : 1, static_cast<double>(kMostLines)));
    // An even number: the last is beside the first, as lines are counted around.
    count_ = std::max<std::size_t>(1, 2 * static_cast<std::size_t>(lines_ / (2 * height)));
    reaches_.assign(count_, {});
    tile_of_line_.resize(static_cast<std::size_t>(lines_));
    first_line_.assign(count_ + 1, 0);
    const auto lines = static_cast<std::size_t>(lines_);
    for (std::size_t tile = 0; tile <= count_; ++tile) first_line_[tile] = tile * lines / count_;
    for (std::size_t tile = 0; tile < count_; ++tile)
        for (std::size_t line = first_line_[tile]; line < first_line_[tile + 1]; ++line)
            tile_of_line_[line] = static_cast<std::uint32_t>(tile);
    is_side_by_side_ = may_be_side_by_side && count_ >= 4;
}

void Tiles::find_reaches(const std::int32_t* cell_begin) {
    const auto middle = [&](std::size_t tile) {
        return static_cast<std::int64_t>((first_line_[tile] + first_line_[tile + 1]) / 2);
    };
    const auto first_place = [&](std::int64_t line) {
        return static_cast<std::size_t>(cell_begin[std::min(line, lines_) * width_]);
    };
    for (std::size_t tile = 0; tile < count_; ++tile) {
        TileReach& reach = reaches_[tile];
        const std::int64_t below = middle((tile + count_ - 1) % count_) - (tile == 0 ? lines_ : 0),
                           above = middle((tile + 1) % count_) + (tile + 1 == count_ ? lines_ : 0);
        reach.is_unbounded_ = false, reach.all_ = lines_;
        const std::int64_t first = below + TileReach::kLinesBeside, last = above - TileReach::kLinesBeside;
        reach.first_ = first < 0 ? first + lines_ : first;
        reach.lines_ = last - first;
        // A kernel that looks at a line reads a batch of places beyond it, which may be of lines that follow.
        // Beyond the last place of all it reads the last row again.
        std::int64_t top = last;  // lines below it may be looked at
        const auto ends_within = [&](std::int64_t line) {
            if (line <= 0 || (line <= lines_ && above >= lines_)) return true;
            const std::int64_t around = line > lines_ ? lines_ : 0;
            return first_place(line - around) + kPlacesOfBatch <= first_place(above - around);
        };
        while (top > first && !ends_within(top)) --top;
        reach.lines_to_look_at_ = top - first;
    }
}

}  // namespace carom
