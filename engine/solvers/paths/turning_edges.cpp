#include "solvers/paths/turning_edges.hpp"

namespace carom {

template <class Real>
void TurningEdges<Real>::add(const Contact& contact, double h, BodyRecords<Real>& records) {
    const Rotation turn = rotation_by(contact.spin * h);
    const Vec2 chord = (1 / h) * (rotate(turn, contact.arm) - contact.arm),
               tangent = contact.spin * Vec2{-contact.arm.y, contact.arm.x};
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
