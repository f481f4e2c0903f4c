#pragma once

#include "math/rotation.hpp"
#include "state/world_state.hpp"

// Segments that are put end to end, one by one: what slides over them should feel no more than on a chain.

namespace carom {

/// Joins segments that stand still where their ends coincide, but for a rounding or a small overlap along a
/// line: their edges become neighbours, as those of a chain are. A track, segments joined so, has its edges
/// in the frame of the world. Cost: nothing while no segment comes, goes or is put elsewhere; else O(segments
/// log segments).
/// @return whether tracks may have become others
template <class Real>
bool join_segments(WorldState<Real>& world);

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
