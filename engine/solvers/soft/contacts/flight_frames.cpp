#include "solvers/soft/contacts/flight_frames.hpp"

namespace carom {

template <class Real>
void FlightFrames<Real>::find(const ContactGraph<Real>& graph, const Bodies<Real>& bodies,
                              const Column<Real>& motion) {
    const std::size_t rows = bodies.moving();
    islands_.reset(rows);
    graph.pairs.for_each([&](std::size_t i) { islands_.join(graph.pairs.a[i], graph.pairs.b[i]); });
    group_.assign(rows, {});
    const auto group_of = [&](std::size_t row) -> Group& {
        return group_[static_cast<std::size_t>(islands_.island_of(static_cast<std::int32_t>(row)))];
    };
    for (std::size_t row = 0; row < rows; ++row) {
        Group& group = group_of(row);
        group.x += static_cast<double>(motion[4 * row + 2]);
        group.y += static_cast<double>(motion[4 * row + 3]);
        ++group.count;
        if (!bodies.is_moving_disc(row)) group.is_held = true;
    }
    graph.supports.for_each(
        [&](std::size_t i) { group_of(static_cast<std::size_t>(graph.supports.a[i])).is_held = true; });
    velocity_.resize_for_overwrite(2 * rows);
    for (std::size_t row = 0; row < rows; ++row) {
        const Group& group = group_of(row);
        velocity_[2 * row] = group.is_held ? Real(0) : static_cast<Real>(group.x / group.count);
        velocity_[2 * row + 1] = group.is_held ? Real(0) : static_cast<Real>(group.y / group.count);
    }
}

template class FlightFrames<float>;
template class FlightFrames<double>;

}  // namespace carom
