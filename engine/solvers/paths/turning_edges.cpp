#include "solvers/paths/turning_edges.hpp"

#include <cmath>

namespace carom {
namespace {

/// Edges that turn farther in a step [rad] are taken to move straight on: of what is next to them then the
/// start of the step tells nothing.
constexpr double kMostTurn = 0.5;
/// A body faces an edge whose direction is along its normal by no more than this, a cosine, and a side whose
/// normal is opposite to it but for so much.
constexpr double kFacing = 1e-3;

}  // namespace

template <class Real>
void TurningEdges<Real>::add_edge(const ManifoldList<Real>& list, std::size_t i, std::int32_t edge_row,
                                  const Edge& edge, const EdgePose& pose, const SubstepTerms& terms,
                                  BodyRecords<Real>& records) {
    const Vec2 normal{list.normal_x[i], list.normal_y[i]}, along = rotate(pose.turn, edge.b - edge.a);
    if (std::fabs(dot(along, normal)) > kFacing * std::sqrt(length_squared(along))) return;
    add(list, i, edge_row, (1 / terms.dt) * (pose.end_position - pose.position),
        (pose.end_angle - pose.angle) / terms.dt, terms, records);
}

template <class Real>
void TurningEdges<Real>::add_side(const ManifoldList<Real>& list, std::size_t i, std::int32_t edge_row,
                                  const Bodies<Real>& bodies, const ConvexShape<Real>& shape,
                                  const SubstepTerms& terms, BodyRecords<Real>& records) {
    const auto row = static_cast<std::size_t>(list.b[i]);
    if (!bodies.has_rotation || bodies.angular_velocity[row] == Real(0)) return;
    const Rotation turn = rotation_by(static_cast<double>(bodies.angle[row]));
    const Vec2 normal = rotate_back(turn, {list.normal_x[i], list.normal_y[i]});
    bool is_faced = false;
    for (int side = 0; side < shape.count; ++side)
        is_faced = is_faced || dot(normal, {shape.normal_x[side], shape.normal_y[side]}) < kFacing - 1;
    if (!is_faced) return;
    add(list, i, edge_row, {bodies.velocity_x[row], bodies.velocity_y[row]},
        static_cast<double>(bodies.angular_velocity[row]), terms, records);
}

template <class Real>
void TurningEdges<Real>::add(const ManifoldList<Real>& list, std::size_t i, std::int32_t edge_row,
                             Vec2 velocity, double spin, const SubstepTerms& terms,
                             BodyRecords<Real>& records) {
    if (spin == 0 || std::fabs(spin * terms.dt) > kMostTurn) return;
    const Vec2 normal{list.normal_x[i], list.normal_y[i]};
    const bool is_one = !(list.separation2[i] < static_cast<Real>(kNoPoint));
    const double lever = is_one ? static_cast<double>(list.lever_b1[i])
                                : 0.5 * static_cast<double>(list.lever_b1[i] + list.lever_b2[i]),
                 lever_t = list.lever_b_t[i], h = terms.substep_dt;
    const Contact contact{.edge_row = edge_row,
                          .body_row = list.a[i],
                          .arm = lever_t * normal + lever * Vec2{normal.y, -normal.x},
                          .normal = normal,
                          .height = lever_t - static_cast<double>(list.lever_a_t[i]),
                          .velocity = velocity,
                          .spin = spin};
    const Rotation turn = rotation_by(spin * h);
    const Vec2 chord = (1 / h) * (rotate(turn, contact.arm) - contact.arm),
               tangent = spin * Vec2{-contact.arm.y, contact.arm.x};
    all_.push_back({contact, turn, chord});
    accelerate(contact, chord - tangent, 0.5 * h, records);
}

template <class Real>
void TurningEdges<Real>::advance(double h, BodyRecords<Real>& records) {
    for (Turning& edge : all_) {
        const Vec2 next = rotate(edge.turn, edge.chord);
        accelerate(edge.contact, next - edge.chord, h, records);
        edge.chord = next;
    }
}

/// Changes the velocity of an edge by what its point turns aside, and by what its normal turns under a body
/// whose centre moves along it with speed u, as seen from the edge: 2 spin u a second. A body's own spin
/// takes other points of it there, no farther on.
template <class Real>
void TurningEdges<Real>::accelerate(const Contact& contact, Vec2 change, double seconds,
                                    BodyRecords<Real>& records) {
    Real* edge = &records.velocity[4 * static_cast<std::size_t>(contact.edge_row)];
    const Real* body = &records.velocity[4 * static_cast<std::size_t>(contact.body_row)];
    const Vec2 n = contact.normal, along{-n.y, n.x};
    const double u = dot(Vec2{body[0], body[1]} - contact.velocity, along) - contact.spin * contact.height;
    const Vec2 gain = change - 2 * contact.spin * u * seconds * n;
    edge[0] += static_cast<Real>(gain.x), edge[1] += static_cast<Real>(gain.y);
}

template class TurningEdges<float>;
template class TurningEdges<double>;

}  // namespace carom
