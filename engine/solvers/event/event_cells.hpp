#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/event/event_disc.hpp"

namespace carom {

/// Lists of the discs in each square cell of a grid without edges: the plane is folded onto a bounded number
/// of lists. Discs of far cells that share a list are looked at in vain, never missed.
///
/// A disc is registered in a cell until it has left that by kMargin of the cell's size; so it never goes to
/// and fro between two cells at one instant, and round-off in its position does not matter. Discs whose
/// radius is at most `largest_radius()` can touch only if their cells are the same or neighbours.
class EventCells {
  public:
    /// Cells for discs of at most this radius in a box of about this size, at least `least_size` wide.
    void reset(double largest_radius, double least_size, Vec2 box, std::size_t discs);

    double size() const { return size_; }

    void insert(std::span<EventMover> movers, std::int32_t disc, Vec2 position);
    /// Moves a disc to the next cell on a side: left, right, bottom, top.
    void move(std::span<EventMover> movers, std::int32_t disc, std::uint8_t side);

    /// Calls visit(disc) for every disc that is registered in a cell or in one of the eight around it.
    template <class Visit>
    void for_each_around(std::span<const EventMover> movers, std::int32_t x, std::int32_t y,
                         const Visit& visit) const {
        for (std::int32_t dy = -1; dy <= 1; ++dy)
            for (std::int32_t dx = -1; dx <= 1; ++dx) visit_list(movers, x + dx, y + dy, visit);
    }

    /// The same for the three cells that come into reach when a disc has moved to a cell from the opposite of
    /// `side`.
    template <class Visit>
    void for_each_ahead(std::span<const EventMover> movers, const EventMover& disc, std::uint8_t side,
                        const Visit& visit) const {
        const Step step = step_to(side);
        for (std::int32_t i = -1; i <= 1; ++i)
            visit_list(movers, disc.cell_x + (step.x != 0 ? step.x : i),
                       disc.cell_y + (step.y != 0 ? step.y : i), visit);
    }

    /// When a disc at `position` with `velocity` leaves its cell: time from now [s], and on which side.
    struct Exit {
        double after;
        std::uint8_t side;
    };
    Exit find_exit(const EventMover& disc, Vec2 position, Vec2 velocity, Vec2 gravity) const;

    std::size_t list_at(Vec2 position) const { return list_of(cell_at(position.x), cell_at(position.y)); }
    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.size_, self.margin_, self.mask_x_, self.mask_y_, self.shift_x_, self.first_);
    }

    std::size_t bytes() const { return first_.capacity() * sizeof(std::int32_t); }

  private:
    struct Step {
        std::int32_t x, y;
    };
    static Step step_to(std::uint8_t side) {
        return side < 2 ? Step{side == 0 ? -1 : 1, 0} : Step{0, side == 2 ? -1 : 1};
    }
    std::size_t list_of(std::int32_t x, std::int32_t y) const {
        return (static_cast<std::size_t>(y) & mask_y_) << shift_x_ | (static_cast<std::size_t>(x) & mask_x_);
    }
    std::int32_t cell_at(double coordinate) const;
    void link(std::span<EventMover> movers, std::int32_t disc);
    void unlink(std::span<EventMover> movers, std::int32_t disc);

    template <class Visit>
    void visit_list(std::span<const EventMover> movers, std::int32_t x, std::int32_t y,
                    const Visit& visit) const {
        for (std::int32_t disc = first_[list_of(x, y)]; disc >= 0;
             disc = movers[static_cast<std::size_t>(disc)].next)
            visit(disc);
    }

    double size_ = 1;    // m
    double margin_ = 0;  // m
    std::size_t mask_x_ = 0, mask_y_ = 0;
    unsigned shift_x_ = 0;
    std::vector<std::int32_t> first_;  // disc of each list, or -1
};

/// First time from now at which c + v t + a t²/2 falls to zero; 0 if it is there and falling. c below zero is
/// round-off and counts as zero.
inline double fall_time(double c, double v, double a) {
    if (c < 0) c = 0;
    if (a == 0) return v < 0 ? c / -v : kNever;
    if (a > 0 && v >= 0) return kNever;
    const double discriminant = v * v - 2 * a * c;
    if (discriminant < 0) return kNever;
    const double root = std::sqrt(discriminant);
    return v < 0 ? 2 * c / (root - v) : (v + root) / -a;
}

}  // namespace carom
