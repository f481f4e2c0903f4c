#pragma once

#include "solvers/soft/soft_simulation.hpp"

// The stages of solver `soft`: step/soft_step.cpp has their order and what they touch,
// and calls the simpler ones itself.

namespace carom {

/// Sorts the rows by place in the plane, now and then.
template <class Real>
void sort_rows(SoftSimulation<Real>& sim);

/// Packs every body's motion and lists bodies that leave their margins or the limits.
template <class Real>
void begin_flight(SoftSimulation<Real>& sim);

/// Builds the candidate pairs anew if too many bodies have left their margins, else adds what those reach.
template <class Real>
void update_candidates(SoftSimulation<Real>& sim);

/// Wakes islands that something is about to hit; lists sleepers near those awake as supports.
template <class Real>
void wake_sleepers(SoftSimulation<Real>& sim);

/// Colours the candidate pairs if they are new; contacts keep their impulses.
template <class Real>
void update_contacts(SoftSimulation<Real>& sim);

/// Wakes the islands that are marked. @return whether there were any
template <class Real>
bool wake_marked(SoftSimulation<Real>& sim);

/// Brings velocities of groups of joints to whole times; removes joints that break.
template <class Real>
void end_joints(SoftSimulation<Real>& sim);

/// Puts back what has passed an edge, or a shape that nothing moves, within the step.
template <class Real>
void undo_tunnelling(SoftSimulation<Real>& sim);

/// Puts back what was thrown through a wall within the step.
template <class Real>
void clamp_to_walls(SoftSimulation<Real>& sim);

/// Takes out of the simulation what has left the limits.
template <class Real>
void quarantine_bodies(SoftSimulation<Real>& sim);

/// Finds what overlaps the sensors, and tells what has changed.
template <class Real>
void sense(SoftSimulation<Real>& sim);

/// Wakes islands that something presses on, puts islands to sleep that have been still for long enough.
template <class Real>
void put_to_sleep(SoftSimulation<Real>& sim);

}  // namespace carom
