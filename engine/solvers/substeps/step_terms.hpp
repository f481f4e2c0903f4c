#pragma once

#include <cmath>
#include <cstddef>

#include "broadphase/candidates.hpp"
#include "broadphase/edge_candidates.hpp"
#include "isa/kernel_table.hpp"
#include "math/vec2_math.hpp"
#include "parallel/executor.hpp"
#include "state/columns/column.hpp"

// What the parts of solver `soft` are told of a step: how its loops run, what a substep does to a body that
// touches nothing, and where the bodies began the step.

namespace carom {

/// How the loops of a step run.
template <class Real>
struct StepLoops {
    const KernelTable<Real>* kernels = nullptr;
    const ContactKernels<Real>* contacts = nullptr;  ///< of *kernels, for the effects that are on
    const Executor* executor = nullptr;
    /// Loops over bodies are cut so that a thread gets those that it has in its cache from the sweeps.
    std::size_t rows_per_task = 1;
};

/// Time, and what free flight does to every body in a substep.
struct SubstepTerms {
    double dt = 0;                     ///< s, of the step
    double substep_dt = 0;             ///< s
    double elapsed = 0;                ///< s, from the start of the step to that of the substep
    double behind = 0;                 ///< s, of the step of which this is a part, behind it
    Vec2 gravity_change;               ///< m/s, what gravity adds in a substep
    double decay = 1, spin_decay = 1;  ///< share of velocity and spin that drag leaves in a substep

    /// To where limits that move in the step come to rest [s].
    double until_end() const { return dt - elapsed + behind; }
    /// Speed that gravity adds in a substep [m/s].
    double fall_speed() const { return std::sqrt(length_squared(gravity_change)); }
};

/// Where bodies began the step, and what the broadphase knows of what they may meet in it.
template <class Real>
struct StepFlight {
    const Column<Real>& motion;  ///< [rows][4]: x, y [m], vx, vy [m/s] at the start of the step
    const Candidates<Real>& candidates;
    const EdgeCandidates<Real>& edges;
    double dt;       ///< s
    double fastest;  ///< m/s, of all bodies at the start

    Vec2 start_of(std::size_t row) const { return {motion[4 * row], motion[4 * row + 1]}; }
    Vec2 start_velocity_of(std::size_t row) const { return {motion[4 * row + 2], motion[4 * row + 3]}; }
};

}  // namespace carom
