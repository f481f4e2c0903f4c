#include "broadphase/slim_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/vec2_math.hpp"

namespace carom {
namespace {

// docs/decisions/0050-slim-bodies.md has the measurements behind these.

/// A slim body reaches so many times as far as it is thick.
constexpr double kSlim = 6;
/// A body may turn as far as it does in so many steps, and by so much more,
constexpr double kTurnSteps = 5, kLeastTurn = 0.02;  // rad
/// and one that may turn by more is the disc around it.
constexpr double kMostTurn = 1;  // rad
/// Share of their thickness up to which bodies at rest are in contact, and some more.
constexpr double kNear = 0.1;
/// Share of a place's distance from the origin by which it may be off through rounding.
template <class Real>
constexpr double kRoundingOfPlaces = 8 * static_cast<double>(std::numeric_limits<Real>::epsilon());

}  // namespace

template <class Real>
void SlimBodies<Real>::read_shapes(const ShapeStore<Real>& shapes) {
    if (revision_ != shapes.revision()) {
        revision_ = shapes.revision();
        frames_.follow(shapes);
        is_slim_.assign(shapes.size(), 0);
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            const auto number = static_cast<std::int32_t>(i);
            is_slim_[i] = shapes.pieces(number).empty() && !shapes.is_piece(number) &&
                          static_cast<double>(shapes[number].extent) >
                              kSlim * static_cast<double>(shapes[number].inradius);
        }
    }
    some_are_slim_ = std::find(is_slim_.begin(), is_slim_.end(), 1) != is_slim_.end();
}

template <class Real>
void SlimBodies<Real>::begin(std::size_t rows, double spread) {
    spread_ = spread;
    pose_.resize(rows), size_.resize(rows);
    for (Column<Real>* column : {&place_x_, &place_y_, &angle_, &turn_}) column->resize(rows);
}

template <class Real>
void SlimBodies<Real>::set(const Bodies<Real>& bodies, std::size_t row, Vec2 place, double margin,
                           double reach, double dt) {
    const std::int32_t shape = bodies.shape[row];
    const double spin =
        bodies.has_rotation ? std::fabs(static_cast<double>(bodies.angular_velocity[row])) : 0;
    const double turn = kTurnSteps * dt * spin + kLeastTurn;
    const bool is_slim = shape >= 0 && !bodies.is_disc(row) && this->is_slim(shape) && turn <= kMostTurn;
    const auto real = [](double value) { return static_cast<Real>(value); };
    const double radius = bodies.radius[row];
    // What stops or turns a body within a step is not foreseen: it and others then come as far as they fly.
    const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]};
    const double way = dt * (std::sqrt(length_squared(v)) + spin * radius);
    const double grows = margin + way + spread_ * reach + kNear * static_cast<double>(bodies.inradius(row)) +
                         kRoundingOfPlaces<Real> * (std::fabs(place.x) + std::fabs(place.y) + radius);
    place_x_[row] = real(place.x), place_y_[row] = real(place.y);
    if (!is_slim) {
        pose_[row] = {real(place.x), real(place.y), 0, 0};
        size_[row] = {0, 0, real(grows + radius), 0};
        turn_[row] = std::numeric_limits<Real>::infinity();
        return;
    }
    const ShapeFrame<Real>& frame = frames_[shape];
    angle_[row] = bodies.has_rotation ? bodies.angle[row] : Real(0), turn_[row] = real(turn);
    const Rotation by = rotation_by(static_cast<double>(angle_[row]));
    const Vec2 centre = place + rotate(by, {frame.x, frame.y});
    pose_[row] = {real(centre.x), real(centre.y), real(by.cos), real(by.sin)};
    size_[row] = {frame.half_x, frame.half_y, real(grows + turn * radius), 0};
}

template <class Real>
void SlimBodies<Real>::follow_rows(const RowNames& names) {
    if (empty()) return;
    for (Column<Record>* column : {&pose_, &size_, &first_pose_, &first_size_})
        names.move(*column, [](std::size_t) { return Record{}; });
    for (Column<Real>* column : {&place_x_, &place_y_, &angle_, &turn_})
        names.move(*column, [](std::size_t) { return Real(0); });
}

template <class Real>
std::size_t SlimBodies<Real>::drop_parted(const KernelTable<Real>& kernels, std::int32_t* a, std::int32_t* b,
                                          std::size_t count) const {
    return kernels.convex->drop_parted({pose_.data()->data(), size_.data()->data(), a, b, count});
}

template <class Real>
void SlimBodies<Real>::add_turned(const Bodies<Real>& bodies, double dt,
                                  std::vector<std::int32_t>& rows) const {
    if (empty() || !bodies.has_rotation) return;
    const auto h = static_cast<Real>(dt);
    const std::size_t before = rows.size();
    for (std::size_t row = 0; row < bodies.moving(); ++row)
        if (!(std::fabs(bodies.angle[row] + h * bodies.angular_velocity[row] - angle_[row]) <= turn_[row]))
            rows.push_back(static_cast<std::int32_t>(row));
    if (rows.size() == before) return;
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
}

template <class Real>
std::size_t SlimBodies<Real>::bytes() const {
    return frames_.bytes() + is_slim_.capacity() + pose_.bytes() + size_.bytes() + first_pose_.bytes() +
           first_size_.bytes() + place_x_.bytes() + place_y_.bytes() + angle_.bytes() + turn_.bytes();
}

template class SlimBodies<float>;
template class SlimBodies<double>;

}  // namespace carom
