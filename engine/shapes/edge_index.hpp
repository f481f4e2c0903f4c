#pragma once

#include <algorithm>
#include <carom/vec2.hpp>
#include <cstddef>
#include <cstdint>
#include <vector>

// Where what stands still is in the plane, so that what looks around itself pays for what is near alone.

namespace carom {

/// A box along the axes.
struct EdgeBox {
    Vec2 low, high;  // m

    double distance_squared(Vec2 p) const {
        const double x = std::max({low.x - p.x, p.x - high.x, 0.0}),
                     y = std::max({low.y - p.y, p.y - high.y, 0.0});
        return x * x + y * y;
    }
    void include(Vec2 p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
};

/// The box around a circle, somewhat larger: places that are computed in other ways differ by a rounding.
inline EdgeBox box_around(Vec2 place, double reach) {
    constexpr double kRounding = 1e-12;  // of coordinates, some thousand times that of double precision
    const double half = reach + kRounding * (std::max({place.x, -place.x, place.y, -place.y}) + reach);
    return {{place.x - half, place.y - half}, {place.x + half, place.y + half}};
}

/// Numbered boxes that come and go one by one. Each is in a cell of a grid as fine as its size: the cell of
/// its lower left corner. Cells are folded onto a table with about one place for each box.
class EdgeIndex {
  public:
    /// Cost: O(1), on average.
    void insert(std::int32_t number, const EdgeBox& box);
    /// Nothing if it is not there. Cost: O(1), on average.
    void remove(std::int32_t number);

    /// The numbers of all boxes that touch a box, ascending.
    /// Cost: O(sizes of boxes + what is found), where these are not much smaller than the one asked for;
    /// never more than O(boxes).
    void find(const EdgeBox& box, std::vector<std::int32_t>& found) const;

    std::size_t count() const { return count_; }
    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.members_, self.table_, self.levels_, self.count_);
    }

  private:
    static constexpr std::int32_t kNone = -1;
    struct Member {
        EdgeBox box;
        std::int32_t level = kNone;                                     // of levels_; kNone: not there
        std::int32_t previous = kNone, next = kNone;                    // at its place of the table
        std::int32_t previous_of_level = kNone, next_of_level = kNone;  // among those of its size
        std::uint32_t cell = 0;                                         // hash of it
    };
    struct Level {
        double size = 0;  // m, of a cell, a power of two: no box is larger
        std::int32_t first = kNone;
        std::int32_t count = 0;
    };

    Member& at(std::int32_t number) { return members_[static_cast<std::size_t>(number)]; }
    const Member& at(std::int32_t number) const { return members_[static_cast<std::size_t>(number)]; }
    std::size_t place_of(std::uint32_t cell) const { return cell & (table_.size() - 1); }
    std::int32_t level_of(const EdgeBox& box);
    void link(std::int32_t number);
    void grow();

    std::vector<Member> members_;      // by number
    std::vector<std::int32_t> table_;  // first box of each place; their number is a power of two
    std::vector<Level> levels_;
    std::size_t count_ = 0;
};

}  // namespace carom
