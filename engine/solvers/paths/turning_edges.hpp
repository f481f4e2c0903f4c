#pragma once

#include <cstdint>
#include <vector>

#include "broadphase/edge_candidates.hpp"
#include "math/rotation.hpp"
#include "math/vec2_math.hpp"
#include "shapes/convex_shape.hpp"
#include "shapes/edges.hpp"
#include "solvers/manifolds/list/manifold_list.hpp"
#include "solvers/substeps/body_records.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/bodies.hpp"

namespace carom {

/// Edges that turn, and sides of kinematic shapes, where they touch shapes: what they do to second order
/// within a step.
///
/// A contact keeps its normal and its arms over a step. An edge that turns by an angle a in it comes nearer
/// by a² / 2 of its distance from the axis, and its normal turns under what slides along it. In a drum of 570
/// m at 2.5 rad/s that is 0.86 m in 1/45 s, more than contacts push back.
template <class Real>
class TurningEdges {
  public:
    void clear() { all_.clear(); }

    /// Adds contact `i` of a list with an edge, or with a side of a kinematic shape, where the body faces it:
    /// where it lies across a corner its own normal counts.
    /// @param edge_row  in the records; no other contact has it
    void add_edge(const ManifoldList<Real>& list, std::size_t i, std::int32_t edge_row, const Edge& edge,
                  const EdgePose& pose, const SubstepTerms& terms, BodyRecords<Real>& records);
    /// @param shape  of the kinematic body, or of the piece of it
    void add_side(const ManifoldList<Real>& list, std::size_t i, std::int32_t edge_row,
                  const Bodies<Real>& bodies, const ConvexShape<Real>& shape, const SubstepTerms& terms,
                  BodyRecords<Real>& records);

    /// Turns the velocities of edges on by a substep.
    void advance(double h, BodyRecords<Real>& records);

    std::size_t bytes() const { return all_.capacity() * sizeof(Turning); }

  private:
    /// A contact that faces an edge, at the start of a step.
    struct Contact {
        std::int32_t edge_row, body_row;  // in the records
        Vec2 arm;                         // m, from the axis
        Vec2 normal;                      // from the body into the edge, of length 1
        double height;                    // m, of the body's centre over the axis along the normal
        Vec2 velocity;                    // m/s, of the axis
        double spin;                      // rad/s, of the edge
    };
    struct Turning {
        Contact contact;
        Rotation turn;  // in a substep
        Vec2 chord;     // m/s, mean velocity over the substep of the point that touches, about the axis
    };
    /// @param velocity  m/s, of the axis  @param spin  rad/s
    void add(const ManifoldList<Real>& list, std::size_t i, std::int32_t edge_row, Vec2 velocity, double spin,
             const SubstepTerms& terms, BodyRecords<Real>& records);
    static void accelerate(const Contact& contact, Vec2 change, double seconds, BodyRecords<Real>& records);

    std::vector<Turning> all_;
};

extern template class TurningEdges<float>;
extern template class TurningEdges<double>;

}  // namespace carom
