#pragma once

#include <cmath>

#include "math/rotation.hpp"
#include "state/world_state.hpp"

// Segments that are put end to end, one by one: what slides over them should feel no more than on a chain.

namespace carom {

/// Joins segments that stand still where their ends coincide, but for a rounding or a small overlap along a
/// line: their edges become neighbours, as those of a chain are. A track, segments joined so, has its edges
/// in the frame of the world. What is joined, and in which sense edges lead, depends on the segments alone,
/// not on the order in which they came to where they are. Puts what is new or elsewhere into
/// EdgeStore::standing. Cost: nothing while no segment comes, goes or is put elsewhere; else O(those that
/// did, what is near them, and the segments of tracks that end there or lead through).
/// @return whether tracks may have become others
template <class Real>
bool join_segments(WorldState<Real>& world);

/// Positions are rounded to Real where the grid sees them.
template <class Real>
constexpr double kRoundingInGrid = sizeof(Real) == sizeof(float) ? 2e-7 : 1e-15;

/// m, by which distances from an edge may be wrong there.
template <class Real>
double rounding_of(Vec2 a, Vec2 b) {
    return kRoundingInGrid<Real> * (std::fabs(a.x) + std::fabs(a.y) + std::fabs(b.x) + std::fabs(b.y));
}

/// Where the frame of a body's edges is.
struct EdgeFrame {
    Vec2 position;  // m
    double angle;   // rad
};
template <class Real>
EdgeFrame frame_of(const WorldState<Real>& world, const EdgeBody& body, std::size_t row) {
    if (body.track >= 0) return {{}, 0};
    const Bodies<Real>& bodies = world.bodies;
    return {{bodies.position_x[row], bodies.position_y[row]},
            bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0};
}

extern template bool join_segments(WorldState<float>&);
extern template bool join_segments(WorldState<double>&);

}  // namespace carom
