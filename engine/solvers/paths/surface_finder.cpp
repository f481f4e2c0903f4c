#include "solvers/paths/surface_finder.hpp"

#include <algorithm>
#include <cmath>

#include "constraints/partner.hpp"
#include "effects/friction.hpp"
#include "effects/restitution.hpp"
#include "kernels/manifold_arguments.hpp"
#include "math/rotation.hpp"
#include "shapes/walls.hpp"

namespace carom {
namespace {

/// How far a body can come in a step [m].
template <class Real>
double reach_in_step(const Bodies<Real>& bodies, std::size_t row, double dt) {
    const double turns = bodies.has_rotation ? std::fabs(bodies.angular_velocity[row]) : 0;
    return dt * (std::fabs(bodies.velocity_x[row]) + std::fabs(bodies.velocity_y[row]) +
                 turns * static_cast<double>(bodies.radius[row]));
}

template <class Real>
PlacedConvex placed_row(const WorldState<Real>& world, std::size_t row) {
    const Bodies<Real>& bodies = world.bodies;
    return placed(world.shapes[bodies.shape[row]], {bodies.position_x[row], bodies.position_y[row]},
                  rotation_by(bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0));
}

/// A manifold of a frame that is turned, and whose origin is the body b's.
Manifold<double> turned(Manifold<double> m, const Rotation& turn) {
    const Vec2 n = rotate(turn, {m.normal_x, m.normal_y});
    m.normal_x = n.x, m.normal_y = n.y;
    return m;
}

}  // namespace

template <class Real>
void SurfaceFinder<Real>::take_over(const WorldState<Real>& world, std::span<const EdgePair> pairs) {
    const Bodies<Real>& bodies = world.bodies;
    for (const EdgePair& pair : pairs) {
        const auto row = static_cast<std::size_t>(pair.row);
        if (!bodies.is_disc(row) && bodies.shape[row] >= 0 && !bodies.is_immovable(row))
            pairs_.push_back({pair.row, world.edges[pair.edge].body, pair.edge});
    }
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
}

template <class Real>
void SurfaceFinder<Real>::renew(const WorldState<Real>& world, const EdgeCandidates<Real>& edges) {
    pairs_.clear();
    if (world.bodies.has_shapes) take_over(world, edges.pairs());
}

template <class Real>
void SurfaceFinder<Real>::add(const WorldState<Real>& world, const EdgeCandidates<Real>& edges) {
    if (world.bodies.has_shapes && !edges.new_pairs().empty()) take_over(world, edges.new_pairs());
}

template <class Real>
void SurfaceFinder<Real>::find(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                               const SubstepTerms& terms, const ContactDistance& near,
                               ManifoldList<Real>& list) {
    list.clear(), manifolds_.clear();
    if (world.walls) find_walls(world, terms, near, list);
    find_edges(world, edges, terms, near, list);
    list.fit();
    const Bodies<Real>& bodies = world.bodies;
    const auto real = [](double value) { return static_cast<Real>(value); };
    for (std::size_t i = 0; i < list.count(); ++i) {
        const Manifold<double>& m = manifolds_[i];
        const auto row = static_cast<std::size_t>(list.a[i]);
        list.normal_x[i] = real(m.normal_x), list.normal_y[i] = real(m.normal_y);
        list.lever_a1[i] = real(m.lever_a1), list.lever_a2[i] = real(m.lever_a2);
        list.lever_b1[i] = real(m.lever_b1), list.lever_b2[i] = real(m.lever_b2);
        list.lever_a_t[i] = real(m.lever_a_t), list.lever_b_t[i] = real(m.lever_b_t);
        list.separation1[i] = real(m.separation1), list.separation2[i] = real(m.separation2);
        list.thickness[i] = bodies.inradius(row);
        const Partner support(list.b[i]);
        double friction = 0, restitution = 0;
        if (support.is_wall()) {
            friction = world.walls->material.friction, restitution = world.walls->material.restitution;
        } else {
            const std::size_t other = edges.pose_of(world.edges[support.edge_number()]).row;
            friction = bodies.friction[other], restitution = bodies.restitution[other];
        }
        list.friction[i] = real(pair_friction(bodies.friction[row], friction));
        list.restitution[i] = real(pair_restitution(bodies.restitution[row], restitution));
    }
}

/// A wall is a wall everywhere: it is kept one thickness farther than others, as a crowd may yet throw a body
/// there within the step.
template <class Real>
void SurfaceFinder<Real>::find_walls(const WorldState<Real>& world, const SubstepTerms& terms,
                                     const ContactDistance& near, ManifoldList<Real>& list) {
    const Bodies<Real>& bodies = world.bodies;
    const Walls& walls = *world.walls;
    for (std::size_t row = 0; row < bodies.count; ++row) {
        if (bodies.is_disc(row) || bodies.shape[row] < 0 || bodies.is_immovable(row)) continue;
        const double thickness = bodies.inradius(row);
        const double margin = near(thickness) + thickness + reach_in_step(bodies, row, terms.dt);
        const Vec2 centre{bodies.position_x[row], bodies.position_y[row]};
        for (const std::int32_t side : kWallSides) {
            if (!has_wall(walls, side)) continue;
            const Vec2 n = wall_normal(side), corner = wall_corner(walls, side);
            if (dot(corner - centre, n) - static_cast<double>(bodies.radius[row]) > margin) continue;
            const Manifold<double> m = manifold_on_plane(placed_row(world, row), n, corner);
            if (m.separation1 > margin && m.separation2 > margin) continue;
            list.add(static_cast<std::int32_t>(row), Partner::wall(side).stored(),
                     {bodies.id[row], BodyId{}, side});
            manifolds_.push_back(m);
        }
    }
}

template <class Real>
void SurfaceFinder<Real>::find_edges(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                                     const SubstepTerms& terms, const ContactDistance& near,
                                     ManifoldList<Real>& list) {
    const Bodies<Real>& bodies = world.bodies;
    for (std::size_t first = 0, last = 0; first < pairs_.size(); first = last) {
        near_edges_.clear();
        for (; last < pairs_.size() && pairs_[last].row == pairs_[first].row &&
               pairs_[last].body == pairs_[first].body;
             ++last)
            near_edges_.push_back(pairs_[last].edge);
        const auto row = static_cast<std::size_t>(pairs_[first].row);
        const EdgePose& pose = edges.pose_of(world.edges[near_edges_[0]]);
        if (!pose.takes_part) continue;
        const double thickness = bodies.inradius(row);
        const double margin =
            near(thickness) + reach_in_step(bodies, row, terms.dt) +
            std::sqrt(length_squared(pose.end_position - pose.position)) +
            std::fabs(pose.end_angle - pose.angle) * world.edges.body_of(near_edges_[0]).reach;
        PlacedConvex body = placed_row(world, row);
        body.centre = rotate_back(pose.turn, body.centre - pose.position);
        body.turn = {body.turn.cos * pose.turn.cos + body.turn.sin * pose.turn.sin,
                     body.turn.sin * pose.turn.cos - body.turn.cos * pose.turn.sin};
        found_.clear();
        find_chain_manifolds(body, world.edges.edges, near_edges_, margin, found_);
        for (const ChainManifold& found : found_) {
            list.add(pairs_[first].row, Partner::edge(found.edge).stored(),
                     {bodies.id[row], bodies.id[pose.row], 0});
            manifolds_.push_back(turned(found.manifold, pose.turn));
        }
    }
}

template <class Real>
std::size_t SurfaceFinder<Real>::bytes() const {
    return pairs_.capacity() * sizeof(Near) + near_edges_.capacity() * sizeof(std::int32_t) +
           found_.capacity() * sizeof(ChainManifold) + manifolds_.capacity() * sizeof(Manifold<double>);
}

template class SurfaceFinder<float>;
template class SurfaceFinder<double>;

}  // namespace carom
