#pragma once

#include <cstdint>
#include <vector>

#include "math/rotation.hpp"
#include "math/vec2_math.hpp"
#include "solvers/substeps/body_records.hpp"

namespace carom {

/// Edges that turn, where they touch shapes: what they do to second order within a step.
///
/// A contact keeps its normal and its arms over a step. An edge that turns by an angle a in it comes nearer
/// by a² / 2 of its distance from the axis, and its normal turns under what slides along it. In a drum of 570
/// m at 2.5 rad/s that is 0.86 m in 1/45 s, more than contacts push back.
template <class Real>
class TurningEdges {
  public:
    void clear() { all_.clear(); }

    /// A contact that faces an edge, at the start of a step.
    struct Contact {
        std::int32_t edge_row, body_row;  ///< in the records; no other contact has the edge's
        Vec2 arm;                         ///< m, from the axis
        Vec2 normal;                      ///< from the body into the edge, of length 1
        double height;                    ///< m, of the body's centre over the axis along the normal
        Vec2 velocity;                    ///< m/s, of the axis
        double spin;                      ///< rad/s, of the edge
    };
    /// @param h  s, of a substep
    void add(const Contact& contact, double h, BodyRecords<Real>& records);

    /// Turns the velocities of edges on by a substep.
    void advance(double h, BodyRecords<Real>& records);

    std::size_t bytes() const { return all_.capacity() * sizeof(Turning); }

  private:
    struct Turning {
        Contact contact;
        Rotation turn;  // in a substep
        Vec2 chord;     // m/s, mean velocity over the substep of the point that touches, about the axis
    };
    static void accelerate(const Contact& contact, Vec2 change, double seconds, BodyRecords<Real>& records);

    std::vector<Turning> all_;
};

extern template class TurningEdges<float>;
extern template class TurningEdges<double>;

}  // namespace carom
