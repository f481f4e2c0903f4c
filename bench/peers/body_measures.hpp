#pragma once

#include <carom/scene.hpp>
#include <carom/world.hpp>

#include <cstdint>
#include <vector>

namespace carom::bench {

/// What positions and velocities say about how well an engine did: computed by the same code for all.
struct BodyMeasures {
    double kinetic = 0;         ///< J, translation and rotation
    double potential = 0;       ///< J in gravity, 0 at the origin
    double speed_rms = 0;       ///< m/s
    double speed_max = 0;       ///< m/s
    std::int64_t touching = 0;  ///< pairs of discs with overlap > 0
    double overlap_mean = 0;    ///< over those, as a fraction of the mean radius of the two
    double overlap_max = 0;
    std::int64_t outside = 0;  ///< centres beyond a closed wall, and positions that are no numbers
};

/// @param bodies  in the order of the scene
/// Cost: O(bodies) while they are not all in one place.
BodyMeasures measure_bodies(const Scene& scene, const std::vector<BodyState>& bodies);

}  // namespace carom::bench
