#include "sleeping/sleeper_grid.hpp"

#include <cmath>

namespace carom {

template <class Real>
void SleeperGrid<Real>::build(const WorldState<Real>& world, const KernelTable<Real>& kernels,
                              const Executor& executor) {
    if (!is_old_) return;
    const Bodies<Real>& bodies = world.bodies;
    for (Column<Real>* column : {&x_, &y_, &reach_}) column->resize(bodies.asleep);
    ids_.resize(bodies.asleep);
    low_x_ = low_y_ = INFINITY, high_x_ = high_y_ = -INFINITY;
    for (std::size_t i = 0; i < bodies.asleep; ++i) {
        const std::size_t row = bodies.count + i;
        const double reach = (1 + kTouchingShare) * static_cast<double>(bodies.radius[row]);
        const double x = bodies.position_x[row], y = bodies.position_y[row];
        x_[i] = bodies.position_x[row], y_[i] = bodies.position_y[row];
        reach_[i] = static_cast<Real>(reach), ids_[i] = bodies.id[row];
        low_x_ = std::fmin(low_x_, x - reach), high_x_ = std::fmax(high_x_, x + reach);
        low_y_ = std::fmin(low_y_, y - reach), high_y_ = std::fmax(high_y_, y + reach);
    }
    grid_.build({bodies.asleep, x_.data(), y_.data(), reach_.data(), nullptr}, kernels, executor);
    is_old_ = false;
}

template <class Real>
std::span<const std::int32_t> SleeperGrid<Real>::near(const WorldState<Real>& world, Vec2 place,
                                                      double reach) {
    near_.clear();
    if (place.x + reach < low_x_ || place.x - reach > high_x_ || place.y + reach < low_y_ ||
        place.y - reach > high_y_ || ids_.empty())
        return near_;
    const std::size_t found = grid_.find_near(static_cast<Real>(place.x), static_cast<Real>(place.y),
                                              static_cast<Real>(reach), places_);
    for (std::size_t i = 0; i < found; ++i) {
        const BodyId id = ids_[static_cast<std::size_t>(places_[i])];
        if (!world.handles.is_alive(id)) continue;
        const std::uint32_t row = world.handles.row_of_slot(id.index);
        if (row >= world.bodies.count) near_.push_back(static_cast<std::int32_t>(row));
    }
    return near_;
}

template <class Real>
std::size_t SleeperGrid<Real>::bytes() const {
    return grid_.bytes() + x_.bytes() + y_.bytes() + reach_.bytes() + ids_.capacity() * sizeof(BodyId) +
           places_.bytes() + near_.capacity() * sizeof(std::int32_t);
}

template class SleeperGrid<float>;
template class SleeperGrid<double>;

}  // namespace carom
