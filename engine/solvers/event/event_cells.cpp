#include "solvers/event/event_cells.hpp"

#include <algorithm>
#include <bit>

namespace carom {
namespace {

/// A disc goes on by this share of a cell's size beyond it before it is registered anew.
constexpr double kMargin = 0.01;
constexpr std::size_t kFewestCells = 4;     // cells along a side, so that three neighbours are three lists
constexpr std::size_t kListsADisc = 4;      // lists a disc at most: memory is O(discs) wherever they are
constexpr double kOutermostCell = 1 << 30;  // the cells there have no outer edge, so numbers stay 32-bit

}  // namespace

void EventCells::reset(double largest_radius, double least_size, Vec2 box, std::size_t discs) {
    // Two discs that are not neighbours are a whole cell apart, less the margin of both.
    size_ = std::max(2 * largest_radius / (1 - 2 * kMargin), least_size) * (1 + 1e-9);
    margin_ = kMargin * size_;
    const std::size_t most = std::max<std::size_t>(64, kListsADisc * discs);
    const auto cells_along = [&](double length) {
        const double cells = std::min(length / size_ + 1, static_cast<double>(most));
        return std::max(kFewestCells, std::bit_ceil(static_cast<std::size_t>(cells)));
    };
    std::size_t x = cells_along(box.x), y = cells_along(box.y);
    while (x * y > most && std::max(x, y) > kFewestCells) (x > y ? x : y) /= 2;
    mask_x_ = x - 1, mask_y_ = y - 1;
    shift_x_ = static_cast<unsigned>(std::countr_zero(x));
    first_.assign(x * y, -1);
}

std::int32_t EventCells::cell_at(double coordinate) const {
    return static_cast<std::int32_t>(
        std::clamp(std::floor(coordinate / size_), -kOutermostCell, kOutermostCell));
}

void EventCells::insert(std::span<EventMover> movers, std::int32_t disc, Vec2 position) {
    EventMover& mover = movers[static_cast<std::size_t>(disc)];
    mover.cell_x = cell_at(position.x), mover.cell_y = cell_at(position.y);
    link(movers, disc);
}

void EventCells::move(std::span<EventMover> movers, std::int32_t disc, std::uint8_t side) {
    unlink(movers, disc);
    EventMover& mover = movers[static_cast<std::size_t>(disc)];
    const Step step = step_to(side);
    mover.cell_x += step.x, mover.cell_y += step.y;
    link(movers, disc);
}

void EventCells::link(std::span<EventMover> movers, std::int32_t disc) {
    EventMover& mover = movers[static_cast<std::size_t>(disc)];
    std::int32_t& first = first_[list_of(mover.cell_x, mover.cell_y)];
    mover.next = first, mover.previous = -1;
    if (first >= 0) movers[static_cast<std::size_t>(first)].previous = disc;
    first = disc;
}

void EventCells::unlink(std::span<EventMover> movers, std::int32_t disc) {
    const EventMover& mover = movers[static_cast<std::size_t>(disc)];
    if (mover.next >= 0) movers[static_cast<std::size_t>(mover.next)].previous = mover.previous;
    (mover.previous >= 0 ? movers[static_cast<std::size_t>(mover.previous)].next
                         : first_[list_of(mover.cell_x, mover.cell_y)]) = mover.next;
}

EventCells::Exit EventCells::find_exit(const EventMover& disc, Vec2 position, Vec2 velocity,
                                       Vec2 gravity) const {
    Exit exit{kNever, 0};
    const auto look = [&](std::uint8_t side, std::int32_t cell, double x, double v, double a) {
        const bool is_upper = (side & 1) != 0;
        const double edge = is_upper ? (cell + 1.0) * size_ + margin_ : cell * size_ - margin_;
        if ((is_upper ? cell : -cell) >= static_cast<std::int32_t>(kOutermostCell)) return;
        const double after = is_upper ? fall_time(edge - x, -v, -a) : fall_time(x - edge, v, a);
        if (after < exit.after) exit = {after, side};
    };
    for (std::uint8_t side = 0; side < 2; ++side) look(side, disc.cell_x, position.x, velocity.x, gravity.x);
    for (std::uint8_t side = 2; side < 4; ++side) look(side, disc.cell_y, position.y, velocity.y, gravity.y);
    return exit;
}

}  // namespace carom
