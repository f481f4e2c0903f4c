#include "solvers/manifolds/meetings/held_flights.hpp"

#include <algorithm>
#include <cmath>

#include "constraints/partner.hpp"
#include "math/rotation.hpp"
#include "solvers/manifolds/meetings/meeting.hpp"

namespace carom {
namespace {

/// Times that what the planes hold is taken from a body's velocity: a second plane gives back some of what
/// the first one took, where they are not at right angles.
constexpr int kTurns = 3;
/// Share of kPassing below which a body comes in a step by any way: less than 1, for rounding.
constexpr double kSlow = 0.99;
/// A normal is that of a face if it is off by no more than this [rad].
constexpr double kOff = 0.01;

/// Whether a shape has a face that a normal of any sign is across.
template <class Real>
bool has_face_along(const ConvexShape<Real>& shape, double angle, Vec2 normal) {
    const Vec2 n = rotate_back(rotation_by(angle), normal);
    for (int i = 0; i < shape.count; ++i) {
        const double along = shape.normal_x[i] * n.x + shape.normal_y[i] * n.y;
        if (along * along >= 1 - kOff * kOff) return true;
    }
    return false;
}

}  // namespace

template <class Real>
bool HeldFlights<Real>::comes_into(Vec2 velocity, Vec2 normal, double gap, double thickness, double dt) {
    return dt * dot(velocity, normal) - std::fmax(gap, 0) > kPassing * thickness;
}

/// The plane of a corner on a corner is a face of neither body, and holds for one step alone.
template <class Real>
void HeldFlights<Real>::hold_what_pressed(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                                          const PieceItems<Real>& items, const PoseWatch<Real>& poses,
                                          double dt, const ManifoldList<Real>& pairs,
                                          const ManifoldList<Real>& surfaces) {
    const Bodies<Real>& bodies = world.bodies;
    const auto presses = [&](std::size_t row, Vec2 normal) {
        return comes_into({bodies.velocity_x[row], bodies.velocity_y[row]}, normal, 0, bodies.inradius(row),
                          dt);
    };
    const auto has_face = [&](std::size_t row, std::int32_t shape, Vec2 normal) {
        return has_face_along(world.shapes[shape],
                              bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0, normal);
    };
    const std::size_t with_bodies = world.immovable_rows.empty() ? 0 : pairs.count();
    for (std::size_t i = 0; i < with_bodies; ++i) {
        const auto a = static_cast<std::size_t>(pairs.a[i]), b = static_cast<std::size_t>(pairs.b[i]);
        if (!bodies.stands(b)) continue;
        // Most bodies of a heap are too slow, whatever they press on.
        if (!(static_cast<double>(poses.way(a)) > kSlow * kPassing * bodies.inradius(a))) continue;
        const ManifoldMemory<Real>& memory = pairs.memory[i];
        const Vec2 normal{memory.normal_x, memory.normal_y};
        if (!memory.is_loaded() || !presses(a, normal)) continue;
        const auto shape_of = [&](std::int32_t row, const Column<std::int32_t>& item) {
            return items.shape_of(world, row, items.empty() ? row : item[i]);
        };
        if (has_face(a, shape_of(pairs.a[i], pairs.item_a), normal) ||
            has_face(b, shape_of(pairs.b[i], pairs.item_b), normal))
            hold(a, normal, 0);
    }
    for (std::size_t i = 0; i < surfaces.count(); ++i) {
        const ManifoldName& name = surfaces.names[i];
        // Contacts of bodies that have just woken are no edges yet: all that is known of them is their
        // memory.
        if (!Partner(surfaces.b[i]).is_edge() || !world.handles.is_alive(name.a)) continue;
        const std::size_t row = world.handles.row_of_slot(name.a.index);
        const Vec2 normal{surfaces.normal_x[i], surfaces.normal_y[i]};
        // What was stopped early in a step does not press at its end.
        const auto touching = static_cast<Real>(kPassing * static_cast<double>(surfaces.thickness[i]));
        const bool touched = std::min(surfaces.separation1[i], surfaces.separation2[i]) <= touching;
        if (!(touched || surfaces.memory[i].is_loaded()) || !presses(row, normal)) continue;
        // Edges may have changed since then; one of a body that moves by itself holds nothing.
        const std::int32_t number = Partner(surfaces.b[i]).edge_number();
        if (!world.handles.is_alive(name.b) || !bodies.stands(world.handles.row_of_slot(name.b.index)) ||
            static_cast<std::size_t>(number) >= world.edges.edges.size())
            continue;
        const Edge& edge = world.edges[number];
        const Vec2 along = rotate(edges.pose_of(edge).turn, edge.b - edge.a);
        const double off = dot(along, normal);
        if (off * off > kOff * kOff * length_squared(along)) continue;
        hold(row, normal, 0);
    }
}

template <class Real>
void HeldFlights<Real>::settle(const Bodies<Real>& bodies, double dt) {
    const auto by_row = [](const Face& left, const Face& right) { return left.row < right.row; };
    held_.clear();
    std::stable_sort(faces_.begin(), faces_.end(), by_row);
    for (std::size_t first = 0, last = 0; first < faces_.size(); first = last) {
        const std::int32_t row = faces_[first].row;
        while (last < faces_.size() && faces_[last].row == row) ++last;
        const auto at = static_cast<std::size_t>(row);
        Vec2 velocity{bodies.velocity_x[at], bodies.velocity_y[at]};
        for (int turn = 0; turn < kTurns; ++turn)
            for (std::size_t i = first; i < last; ++i) {
                const Face& face = faces_[i];
                const double most = std::fmax(face.gap, 0) / dt;
                velocity -= std::fmax(0, dot(velocity, face.normal) - most) * face.normal;
            }
        held_.push_back({row, velocity});
    }
}

template <class Real>
Vec2 HeldFlights<Real>::velocity(const Bodies<Real>& bodies, std::size_t row) const {
    const auto of_row = [](const Held& held, std::size_t number) {
        return static_cast<std::size_t>(held.row) < number;
    };
    const auto found = std::lower_bound(held_.begin(), held_.end(), row, of_row);
    if (found != held_.end() && static_cast<std::size_t>(found->row) == row) return found->velocity;
    return {bodies.velocity_x[row], bodies.velocity_y[row]};
}

template class HeldFlights<float>;
template class HeldFlights<double>;

}  // namespace carom
