#pragma once

#include <algorithm>
#include <cstddef>

#include "constraints/contact_rows.hpp"
#include "isa/kernel_table.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Bodies as near as this, in radii of the smaller one, are solved together even if they hardly move: what
/// pushes one of them in the middle of a step is felt by the other.
inline constexpr double kNearFraction = 0.04;

// Sweeps a substep unless asked for.
inline constexpr int kDefaultIterations = 2;       // docs/decisions/0004-soft-solver.md
inline constexpr int kIterationsOfSmoothHeap = 5;  // docs/decisions/0023-frictionless-heaps.md

/// What comes by this share of the smaller radius in a step, and meets another body where nothing bounces,
/// hits it: that one is looked at as if it flew as fast itself. docs/decisions/0089-discs-that-are-hit.md.
inline constexpr double kStrike = 0.5;

/// What is the same for all contacts of a step of solver `soft`: the effects that are on, coefficients that
/// need no column, and the lengths that contacts are judged by.
///
/// Those lengths are in metres, given the smaller radius of the two bodies. Where all radii are the same the
/// kernels are given metres as well, else shares of the smaller radius, which is `radius` = 1.
struct ContactSettings {
    ContactEffects effects;
    bool has_rotation = false;
    bool is_smooth_heap = false;     ///< gravity, and no friction: nothing but more sweeps brings it to rest
    bool heaves_if_slender = false;  ///< few bodies heave, too, where they are a slender pile
    int iterations = kDefaultIterations;  ///< sweeps a substep, >= 1
    bool has_uneven_sweeps = false;       ///< contacts of uneven masses get more of them
    /// Some body is so much lighter than another that this one may throw it from anywhere to a wall in a
    /// step.
    bool masses_are_uneven = false;
    /// Sweeps go on where bodies are hit: nothing bounces, for what bounces is an impact, which looks around
    /// itself; masses are alike, for sweeps would undo what corrections of uneven ones do; and all bodies
    /// move and turn: docs/decisions/0089-discs-that-are-hit.md.
    bool sweeps_hits = false;
    double friction = 0, rolling = 0;  ///< coefficients, of contacts that have none of their own
    double radius = 1;                 ///< m, of all bodies; 1 where radii vary
    double fall = 0;                   ///< m, by which gravity brings two bodies nearer in a step
    double largest_correction = 0;     ///< m, or a share of the smaller radius: by an overlap, in a substep
    /// Sweeps behind the first one of a substep. In long substeps loads turn a pile's contacts farther than
    /// one sweep holds them: docs/decisions/0095-piles-under-any-step.md.
    int next_sweeps = 1;
    /// Shares of a gap and of an overlap that are taken away in a substep, over those in substeps of the
    /// usual length: in short ones as much in the same time, in as many substeps more. Decision 0095, too.
    double pace = 1;

    /// Separation up to which bodies at rest are in contact [m].
    double contact_distance(double smaller_radius) const { return kNearFraction * smaller_radius + fall; }
    /// Overlap that the sweeps do not take away soon enough [m].
    static double deep_overlap(double smaller_radius);
    /// The smaller radius of the two bodies of a pair [m].
    template <class Real>
    double smaller_radius(const ContactRows<Real>& pairs, std::size_t pair) const {
        return effects.radius_varies ? static_cast<double>(pairs.smaller[pair]) : radius;
    }

    /// The lengths that depend on the time, and what follows from that of a substep.
    /// @param longest_substep  s, that gravity allows; 0: any
    void set_lengths(const SubstepTerms& terms, double longest_substep);

    /// Whether next sweeps may leave out what is calm: a scene that asks for more wants contacts solved
    /// better, and long substeps need them all.
    bool may_leave_out_calm() const { return iterations == kDefaultIterations && next_sweeps == 1; }

    /// The kernels that have these effects compiled in.
    /// @param some_are_fixed  whether some bodies do not turn
    template <class Real>
    const ContactKernels<Real>& kernels_of(const KernelTable<Real>& kernels, bool some_are_fixed) const {
        if (!effects.friction || is_smooth_heap) return kernels.contacts[some_are_fixed ? 5 : 0];
        return kernels.contacts[(effects.rolling ? 3u : 1u) + (some_are_fixed ? 1u : 0u)];
    }
};

/// Fewer bodies rest with the sweeps that all worlds have, and without keeping an overlap: decision 0023.
inline constexpr std::size_t kSmallestSmoothHeap = 64;

/// Whether so many bodies can heap up that nothing but more sweeps brings them to rest: there is gravity, and
/// no friction between bodies, whether or not the effect is on.
template <class Real>
bool is_smooth_heap(const WorldState<Real>& world) {
    const Bodies<Real>& bodies = world.bodies;
    const auto is_zero = [](const auto& column) {
        return column.is_uniform() && column.uniform_value() == 0;
    };
    return bodies.count >= kSmallestSmoothHeap && length_squared(world.gravity) > 0 &&
           is_zero(bodies.friction) && is_zero(bodies.rolling_resistance);
}

/// Whether few bodies heave, too, where they are a slender pile. Rough discs stop by themselves there, and a
/// correction of loads may let them slip: docs/decisions/0047-columns-of-discs.md, 0058-large-heaps.md.
template <class Real>
bool heaves_if_slender(const WorldState<Real>& world) {
    return world.bodies.has_shapes || is_smooth_heap(world);
}

/// Reads effects, coefficients and the radius from the world.
template <class Real>
void read_effects(const WorldState<Real>& world, ContactSettings& settings);

}  // namespace carom
