#pragma once

#include <carom/scene.hpp>
#include <carom/world.hpp>

#include <cstdint>
#include <vector>

namespace carom::bench {

/// What positions and velocities say about how well an engine did: computed by the same code for all.
struct BodyMeasures {
    double kinetic = 0;    ///< J, translation and rotation
    double potential = 0;  ///< J in gravity, 0 at the origin
    double speed_rms = 0;  ///< m/s
    double speed_max = 0;  ///< m/s
    /// Pairs of discs with overlap > 0. In a scene of other shapes: of bodies, and of bodies and walls.
    std::int64_t touching = 0;
    /// Over those, as a fraction of the mean radius of the two discs. In a scene of other shapes: of the
    /// radius of the smaller body, as `OverlapReport` defines it.
    double overlap_mean = 0;
    double overlap_max = 0;
    std::int64_t outside = 0;  ///< centres beyond a closed wall, and positions that are no numbers
};

/// @param bodies  in the order of the scene
/// Cost: O(bodies) while they are not all in one place.
BodyMeasures measure_bodies(const Scene& scene, const std::vector<BodyState>& bodies);

}  // namespace carom::bench
