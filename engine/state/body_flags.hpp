#pragma once

#include <cstdint>

namespace carom {

/// Bits of the flags column: how the stages treat a row. The column exists only if some row has a bit set.
enum BodyFlag : std::uint8_t {
    kImmovable =
        1,  ///< static or kinematic: nothing changes its velocity; pairs of two such are no candidates
    kDisabled = 2,    ///< quarantined: takes no part any more, no candidates at all
    kKinematic = 4,   ///< immovable, but moves at its velocity
    kFixedAngle = 8,  ///< impulses do not turn it
    kEdges = 16,      ///< a segment or chain: its edges are in shapes/edges.hpp, its radius means nothing
    kNotDisc = 32,    ///< a box, capsule or polygon: convex, but no disc
    kSensor = 64,     ///< tells what overlaps it, and touches nothing
};

/// Rows with one of these are no discs to the broadphase.
inline constexpr std::uint8_t kNotInGrid = kDisabled | kEdges | kSensor;

}  // namespace carom
