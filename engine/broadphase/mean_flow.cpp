#include "broadphase/mean_flow.hpp"

#include <cmath>

namespace carom {
namespace {

/// A cell holds about this many bodies: fewer make the mean noisy, more make it coarse.
constexpr double kBodiesPerCell = 16;
/// The cells reach this many root mean squares of the bodies' distances to each side of their mean; evenly
/// spread bodies end at 1.73.
constexpr double kHalfWidth = 2;

}  // namespace

template <class Real>
void MeanFlow::lay_out(std::size_t count, const Real* x, const Real* y, double smallest_cell) {
    double sum_x = 0, sum_y = 0, squares_x = 0, squares_y = 0;
    const double from_x = x[0], from_y = y[0];
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = static_cast<double>(x[i]) - from_x, dy = static_cast<double>(y[i]) - from_y;
        sum_x += dx, sum_y += dy, squares_x += dx * dx, squares_y += dy * dy;
    }
    const double share = 1 / static_cast<double>(count);
    const double mean_x = share * sum_x, mean_y = share * sum_y;
    const double half_x = kHalfWidth * std::sqrt(std::fmax(share * squares_x - mean_x * mean_x, 0)),
                 half_y = kHalfWidth * std::sqrt(std::fmax(share * squares_y - mean_y * mean_y, 0));
    const double cell = std::fmax(smallest_cell, std::sqrt(kBodiesPerCell * share * 4 * half_x * half_y));
    // A heap of no height is one cell high: then count / kBodiesPerCell cells side by side.
    const double most = std::fmax(2, static_cast<double>(count) / kBodiesPerCell);
    const auto cells_along = [&](double half) {
        return static_cast<std::size_t>(std::fmin(std::fmax(std::ceil(2 * half / cell), 2), most));
    };
    width_ = cells_along(half_x), height_ = cells_along(half_y);
    const double side = std::fmax(
        cell, 2 * std::fmax(half_x / static_cast<double>(width_), half_y / static_cast<double>(height_)));
    per_metre_ = 1 / side;
    last_u_ = static_cast<double>(width_ - 1), last_v_ = static_cast<double>(height_ - 1);
    low_ = {from_x + mean_x - 0.5 * last_u_ * side, from_y + mean_y - 0.5 * last_v_ * side};
}

void MeanFlow::begin() {
    cells_.assign(width_ * height_, {});
}

/// Forth and back over the cells, line by line: one that is empty takes the mean of its neighbours that are
/// not.
void MeanFlow::fill_gaps() {
    const auto fill = [&](std::size_t cell, bool has_beside, std::size_t beside, bool has_line,
                          std::size_t line) {
        if (cells_[cell].count > 0) return;
        const bool takes_beside = has_beside && cells_[beside].count > 0,
                   takes_line = has_line && cells_[line].count > 0;
        if (!takes_beside && !takes_line) return;
        const Cell& first = cells_[takes_beside ? beside : line];
        const Cell& second = cells_[takes_line ? line : beside];
        cells_[cell].jump = 0.5 * (first.jump + second.jump);
        cells_[cell].velocity = 0.5 * (first.velocity + second.velocity);
        cells_[cell].count = 1;
    };
    const std::size_t count = cells_.size();
    for (std::size_t i = 0; i < count; ++i) fill(i, i % width_ > 0, i - 1, i >= width_, i - width_);
    for (std::size_t i = count; i-- > 0;)
        fill(i, i % width_ + 1 < width_, i + 1, i + width_ < count, i + width_);
}

/// Within four centres the derivatives along x lie between those along the two edges, likewise along y. A
/// turn brings no two bodies nearer: only the symmetric part of the gradient does, by no more than its lowest
/// eigenvalue, which is no lower than its lower diagonal element less the other one.
MeanFlow::Change MeanFlow::change_of(Vec2 Cell::*field, std::size_t low) const {
    const std::size_t high = low + width_;
    const auto change = [&](std::size_t from, std::size_t to) {
        return per_metre_ * (cells_[to].*field - cells_[from].*field);
    };
    const Vec2 along_x[] = {change(low, low + 1), change(high, high + 1)};
    const Vec2 along_y[] = {change(low, high), change(low + 1, high + 1)};
    double shear = 0;
    for (const Vec2& x : along_x)
        for (const Vec2& y : along_y) shear = std::max(shear, 0.5 * std::fabs(x.y + y.x));
    const double closing =
        std::max(std::max(-along_x[0].x, -along_x[1].x), std::max(-along_y[0].y, -along_y[1].y));
    return {std::max(closing + shear, 0.0),
            std::sqrt(std::max(length_squared(along_x[0]), length_squared(along_x[1])) +
                      std::max(length_squared(along_y[0]), length_squared(along_y[1])))};
}

void MeanFlow::measure_stretch() {
    for (std::size_t j = 0; j + 1 < height_; ++j)
        for (std::size_t i = 0; i + 1 < width_; ++i) {
            const Change of_jump = change_of(&Cell::jump, j * width_ + i),
                         of_velocity = change_of(&Cell::velocity, j * width_ + i);
            most_.stretch = std::max(most_.stretch, of_jump.closing);
            most_.rate = std::max(most_.rate, of_velocity.closing);
            most_.gradient = std::max(most_.gradient, of_jump.gradient);
            most_.gradient_of_velocity = std::max(most_.gradient_of_velocity, of_velocity.gradient);
            for (std::size_t v = j > 0 ? j - 1 : 0; v < std::min(j + 2, height_); ++v)
                for (std::size_t u = i > 0 ? i - 1 : 0; u < std::min(i + 2, width_); ++u) {
                    Cell& cell = cells_[v * width_ + u];
                    cell.stretch = std::max(cell.stretch, of_jump.closing);
                    cell.rate = std::max(cell.rate, of_velocity.closing);
                }
        }
}

void MeanFlow::finish() {
    most_ = {};
    for (Cell& cell : cells_) {
        if (cell.count == 0) continue;
        const double share = 1 / static_cast<double>(cell.count);
        cell.jump = share * cell.jump, cell.velocity = share * cell.velocity;
        most_.jump = std::max(most_.jump, std::sqrt(length_squared(cell.jump)));
        most_.speed = std::max(most_.speed, std::sqrt(length_squared(cell.velocity)));
    }
    fill_gaps();
    measure_stretch();
}

template void MeanFlow::lay_out(std::size_t, const float*, const float*, double);
template void MeanFlow::lay_out(std::size_t, const double*, const double*, double);

}  // namespace carom
