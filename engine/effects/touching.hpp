#pragma once

// Lengths and speeds in fractions of a radius, so that they scale with the scene: when surfaces count as
// touching, and how fast an overlap may be pushed apart.

namespace carom {

/// Overlap left uncorrected, and the distance within which surfaces count as touching: fractions of the
/// smaller radius. Above float's resolution at 1,000 m for radii near 1 m.
inline constexpr double kSlopFraction = 0.002;
inline constexpr double kTouchFraction = 0.001;

/// Bodies that start a step in each other are pushed apart at most this fast: radii of the smaller a second,
/// so that the cap scales with the scene (3 m/s for discs of half a metre).
inline constexpr double kPushRadiiPerSecond = 6;

}  // namespace carom
