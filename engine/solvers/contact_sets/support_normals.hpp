#pragma once

#include <carom/vec2.hpp>

#include <span>

namespace carom {

/// 1 - cosine² of normals along which two supports push at once, at least: beyond, a squeeze has no solution,
/// or one of 64 times its speed (docs/decisions/0040-squeezes.md).
inline constexpr double kLeastOfWedge = 1.0 / (64 * 64);

/// What a surface that nothing moves does to a body along its normal.
struct SupportNormal {
    Vec2 normal;         ///< from the body to the surface
    double most;         ///< m/s, velocity of the body along the normal, at most
    double impulse = 0;  ///< N s, that pushes the body away, >= 0
};

/// The normal impulses of all supports of one body at once: a complementarity problem in the plane of its
/// velocities, in which at most two supports push.
/// @param velocity  m/s, with the impulses that the supports have; out: with the new ones
/// @param inverse_mass  1/kg, > 0
/// @param tolerance  m/s, that velocities along supports which do not push may be off by
/// @return false, and nothing has changed, if no impulses keep all laws, as where surfaces close on a body
/// that are as good as parallel. Cost: O(supports³)
bool solve_support_normals(Vec2& velocity, double inverse_mass, std::span<SupportNormal> supports,
                           double tolerance);

}  // namespace carom
