#include "solvers/paths/path_rolling.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "effects/rolling_resistance.hpp"
#include "math/rotation.hpp"

namespace carom {
namespace {

/// A normal that is that of an edge to so much (cosine) touches its flat side.
constexpr double kFlat = 1 - 1e-5;
/// Contacts that are looked through for one of the same name, from where the last was found.
constexpr std::size_t kSearched = 64;

/// 1/m: 0 where a shape is flat, infinite at a sharp corner.
/// @param normal  outward, in the frame of the body
template <class Real>
double curvature_at(const ConvexShape<Real>& shape, Vec2 normal) {
    for (int i = 0; i < shape.count && shape.count > 1; ++i)
        if (dot(normal, {shape.normal_x[i], shape.normal_y[i]}) > kFlat) return 0;
    return 1 / static_cast<double>(shape.radius);
}

}  // namespace

template <class Real>
void PathRolling<Real>::find(const WorldState<Real>& world, const Manifolds<Real>& manifolds,
                             std::span<const std::int32_t> row_of_far) {
    const Bodies<Real>& bodies = world.bodies;
    std::swap(contacts_, old_);
    contacts_.clear();
    std::size_t next = 0;  // in old_
    const auto moment_of = [&](const ManifoldName& name) {
        for (std::size_t tried = 0; tried < std::min(kSearched, old_.size()); ++tried) {
            const Contact& old = old_[(next + tried) % old_.size()];
            if (old.name == name) return next += tried + 1, old.moment;
        }
        return Real(0);
    };
    const auto live = manifolds.live();
    for (std::size_t n = 0; n < live.size(); ++n) {
        const ManifoldList<Real>& list = manifolds.list_of(live[n]);
        const std::size_t i = Manifolds<Real>::place_of(live[n]);
        if (list.separation2[i] < static_cast<Real>(kNoPoint)) continue;
        const auto a = static_cast<std::size_t>(list.a[i]);
        const Partner partner(list.b[i]);
        const bool is_body = list.b[i] >= 0;
        const auto b = is_body ? static_cast<std::size_t>(list.b[i]) : std::size_t{0};
        const Vec2 n_of_a{list.normal_x[i], list.normal_y[i]};
        const auto curvature = [&](std::size_t row, std::int32_t item, Vec2 normal) {
            const double angle = static_cast<double>(bodies.angle[row]);
            return curvature_at(world.shapes[manifolds.shape_of_item(world, row, item)],
                                rotate_back(rotation_by(angle), normal));
        };
        const auto item = [&](const Column<std::int32_t>& items, std::size_t row) {
            return items.empty() ? static_cast<std::int32_t>(row) : items[i];
        };
        // Walls and edges, and pieces on them, take the body's own material.
        double c = bodies.rolling_resistance[a], bend = 0;
        if (is_body) {
            c = pair_rolling_resistance(c, bodies.rolling_resistance[b]);
            bend = curvature(a, item(list.item_a, a), n_of_a) + curvature(b, item(list.item_b, b), -n_of_a);
        } else {
            if (partner.is_wall()) c = pair_rolling_resistance(c, world.walls->material.rolling_resistance);
            if (partner.is_edge()) {
                const BodyId id = world.edges.body_of(partner.edge_number()).id;
                c = pair_rolling_resistance(c,
                                            bodies.rolling_resistance[world.handles.row_of_slot(id.index)]);
            }
            world.shapes.for_each_piece(
                bodies.shape[a], [&](const ConvexShape<Real>& shape, std::int32_t piece, const StoredPiece*) {
                    if (piece != ManifoldName::piece_of_surface(list.names[i].place)) return;
                    const double angle = static_cast<double>(bodies.angle[a]);
                    bend = curvature_at(shape, rotate_back(rotation_by(angle), n_of_a));
                });
        }
        if (!(c > 0) || !(bend > 0) || !(bend < INFINITY)) continue;
        const bool b_turns = is_body && static_cast<std::size_t>(row_of_far[n]) == b;
        contacts_.push_back({list.names[i], static_cast<std::uint32_t>(n), list.a[i], row_of_far[n],
                             static_cast<Real>(c / bend), 1 / bodies.rim(a),
                             is_body ? 1 / bodies.rim(b) : Real(b_turns ? 1 : 0), moment_of(list.names[i])});
    }
}

/// Rim speeds change by twice the inverse mass times the moment over the rim.
template <class Real>
void PathRolling<Real>::give(const Contact& contact, Real moment, Column<Real>& velocity) {
    Real* of_a = &velocity[4 * static_cast<std::size_t>(contact.a)];
    Real* of_b = &velocity[4 * static_cast<std::size_t>(contact.b)];
    of_a[2] -= 2 * std::max(of_a[3], Real(0)) * contact.per_rim_a * moment;
    of_b[2] += 2 * std::max(of_b[3], Real(0)) * contact.per_rim_b * moment;
}

template <class Real>
void PathRolling<Real>::warm_start(BodyRecords<Real>& records) const {
    for (const Contact& contact : contacts_) give(contact, contact.moment, records.velocity);
}

template <class Real>
void PathRolling<Real>::solve(Contact& contact, BodyRecords<Real>& records, Real normal) {
    const Real* of_a = &records.velocity[4 * static_cast<std::size_t>(contact.a)];
    const Real* of_b = &records.velocity[4 * static_cast<std::size_t>(contact.b)];
    const Real k = 2 * (std::max(of_a[3], Real(0)) * contact.per_rim_a * contact.per_rim_a +
                        std::max(of_b[3], Real(0)) * contact.per_rim_b * contact.per_rim_b);
    if (!(k > 0)) return;
    const Real spin = of_b[2] * contact.per_rim_b - of_a[2] * contact.per_rim_a, most = contact.arm * normal;
    const Real wanted = std::clamp(contact.moment - spin / k, -most, most), change = wanted - contact.moment;
    contact.moment = wanted;
    give(contact, change, records.velocity);
}

template <class Real>
void PathRolling<Real>::book(const BodyRecords<Real>& records, Books& books) const {
    const auto mean_spin = [&](std::int32_t row, Real per_rim) {
        const double end = records.velocity[4 * static_cast<std::size_t>(row) + 2];
        const bool moves = static_cast<std::size_t>(row) < records.count();
        return 0.5 * static_cast<double>(per_rim) * (end + (moves ? records.start_of_substep(row)[2] : end));
    };
    for (const Contact& contact : contacts_) {
        const double moment = contact.moment, of_a = mean_spin(contact.a, contact.per_rim_a),
                     of_b = mean_spin(contact.b, contact.per_rim_b);
        books.friction += moment * (of_b - of_a);
        if (static_cast<std::size_t>(contact.b) >= records.count()) books.drive -= moment * of_b;
    }
}

template class PathRolling<float>;
template class PathRolling<double>;

}  // namespace carom
