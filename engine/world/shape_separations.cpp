#include "world/shape_separations.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/manifolds/manifold_arguments.hpp"
#include "math/vec2_math.hpp"
#include "shapes/convex_geometry.hpp"

namespace carom {

template <class Real>
ShapeSeparations<Real>::ShapeSeparations(const WorldState<Real>& world)
    : store_(&world.shapes), rows_(world.bodies.rows()), shape_(world.bodies.shape) {
    shapes_.resize(world.shapes.size());
    std::copy_n(world.shapes.data(), world.shapes.size(), shapes_.data());
    for (std::size_t row = 0; row < rows_; ++row) {
        const double angle = world.bodies.has_rotation ? static_cast<double>(world.bodies.angle[row]) : 0;
        add_pose({world.bodies.position_x[row], world.bodies.position_y[row]}, rotation_by(angle));
    }
    if (world.shapes.has_compounds())
        for (std::size_t row = 0; row < rows_; ++row) {
            first_piece_.push_back(static_cast<std::int32_t>(shape_.size()));
            if (world.bodies.shape[row] < 0) continue;
            for (const StoredPiece& piece : world.shapes.pieces(world.bodies.shape[row])) {
                shape_.push_back(piece.number);
                for (std::size_t k = 0; k < 4; ++k) pose_.push_back(pose_[4 * row + k]);
            }
        }
    first_edge_ = shape_.size();
}

template <class Real>
template <class Fn>
void ShapeSeparations<Real>::for_each_piece(std::int32_t row, const Fn& fn) const {
    const auto i = static_cast<std::size_t>(row);
    const std::size_t pieces = store_->pieces(shape_[i]).size();
    if (pieces == 0) fn(row);
    for (std::size_t n = 0; n < pieces; ++n) fn(first_piece_[i] + static_cast<std::int32_t>(n));
}

template <class Real>
void ShapeSeparations<Real>::add_pose(Vec2 place, Rotation turn) {
    for (const double value : {place.x, place.y, turn.cos, turn.sin})
        pose_.push_back(static_cast<Real>(value));
}

template <class Real>
void ShapeSeparations<Real>::add(std::int32_t a, std::int32_t b) {
    begin_.push_back(a_.size());
    for_each_piece(a, [&](std::int32_t item_a) {
        for_each_piece(b, [&](std::int32_t item_b) { a_.push_back(item_a), b_.push_back(item_b); });
    });
}

/// The edge is a capsule without a radius whose body is the edge alone.
template <class Real>
void ShapeSeparations<Real>::add(std::int32_t row, const Edge& edge, const EdgePose& pose) {
    const Vec2 along = edge.b - edge.a;
    const double length = std::sqrt(length_squared(along));
    const Vec2 direction = rotate(pose.turn, (1 / length) * along);
    ConvexShape<Real> shape = convex_shape_of<Real>(Capsule{length, 0});
    shape.inradius = static_cast<Real>(kNoPoint);  // the body's is the smaller one
    const auto number = static_cast<std::int32_t>(shape_.size());
    begin_.push_back(a_.size());
    for_each_piece(row, [&](std::int32_t item) { a_.push_back(item), b_.push_back(number); });
    shape_.push_back(static_cast<std::int32_t>(shapes_.size())), shapes_.push_back(shape);
    add_pose(pose.position + rotate(pose.turn, 0.5 * (edge.a + edge.b)), {direction.x, direction.y});
}

template <class Real>
void ShapeSeparations<Real>::find(const KernelTable<Real>& kernels) {
    const std::size_t pairs = a_.size();
    if (pairs == 0) return;
    // Padding names bodies that have a shape: that of row 0 may be edges.
    std::fill(a_.end(), a_.data() + padded(pairs), a_[0]),
        std::fill(b_.end(), b_.data() + padded(pairs), b_[0]);
    const Column<Real> margin(pairs);    // zero
    std::array<Column<Real>, 8> others;  // normals and levers, which are not asked for
    for (Column<Real>& column : others) column.resize(pairs);
    separation1_.resize(pairs), separation2_.resize(pairs);
    const ManifoldColumns<Real> out{
        others[0].data(), others[1].data(), others[2].data(), others[3].data(),    others[4].data(),
        others[5].data(), others[6].data(), others[7].data(), separation1_.data(), separation2_.data()};
    kernels.convex->find_manifolds(
        {pose_.data(), nullptr, shape_.data(), shapes_.data(), a_.data(), b_.data(), margin.data(), out}, 0,
        padded(pairs));
}

template class ShapeSeparations<float>;
template class ShapeSeparations<double>;

}  // namespace carom
