#pragma once

#include "solvers/shared/simulation.hpp"

// The stages of a step, each a sentence in step.cpp and a file here: they hand columns to kernels and take
// lists back.

namespace carom {

/// Sorts the rows by place in the plane, now and then.   reads pose; writes rows of everything
template <class Real>
void sort_rows(Simulation<Real>& sim);

/// Packs every body's motion and lists bodies near walls, out of their margin, or out of the limits.
/// reads pose, velocity; writes motion
template <class Real>
void begin_flight(Simulation<Real>& sim);

/// Builds the candidate pairs anew if bodies have left the margins of the old ones.   reads pose; writes
/// pairs
template <class Real>
void update_candidates(Simulation<Real>& sim);

/// Wakes islands that something is about to hit; lists sleepers near those awake as supports.
/// reads pose, velocity, pairs; writes rows, supports
template <class Real>
void wake_sleepers(Simulation<Real>& sim);

/// Wakes islands that something presses on, puts islands to sleep that have been still for long enough.
/// reads velocity, spin, graph; writes rows of everything, velocity, spin, books
template <class Real>
void put_to_sleep(Simulation<Real>& sim);

/// Lists the few meetings that can happen in this substep.   reads motion, pairs; writes meetings
template <class Real>
void find_impacts(Simulation<Real>& sim);

/// Pushes overlaps apart and holds contacts at rest.   reads meetings; writes motion
template <class Real>
void settle_contacts(Simulation<Real>& sim);

/// Carries out every impact at its time.   reads meetings, pairs; writes motion
template <class Real>
void resolve_impacts(Simulation<Real>& sim);

/// Writes positions and velocities back.   reads motion; writes pose, velocity
template <class Real>
void end_flight(Simulation<Real>& sim);

/// Solver `event`: goes from impact to impact to the end of the step.   reads everything; writes pose,
/// velocity, angle, spin, books
template <class Real>
void run_events(Simulation<Real>& sim);

/// Hands the bodies to solver `event` if they have changed outside of a step.
/// @throws Error (inconsistent) if two of them, or one and a wall, overlap; `where` opens the message
template <class Real>
void load_events(Simulation<Real>& sim, std::string_view where);

// Solver `soft`.

/// Velocity records of all bodies.   reads motion, spin; writes records
template <class Real>
void begin_substeps(Simulation<Real>& sim);

/// Colours the candidate pairs if they are new; contacts keep their impulses.   reads pairs; writes graph
template <class Real>
void update_contacts(Simulation<Real>& sim);

/// Contacts that can touch in this step; warm start.   reads motion, graph; writes contacts, records
template <class Real>
void find_contacts(Simulation<Real>& sim);

/// Two sweeps over the contacts.   reads contacts; writes contacts, records
template <class Real>
void solve_contacts(Simulation<Real>& sim);

/// Moves bodies through a substep.   reads records; writes records
template <class Real>
void advance_bodies(Simulation<Real>& sim);

/// Work and momentum of a substep by cause.   reads contacts, records; writes books
template <class Real>
void book_substep(Simulation<Real>& sim);

/// Work of displacements that no velocity accounts for.   reads motion, pose; writes
/// books
template <class Real>
void book_displacements(Simulation<Real>& sim);

/// Restitution; keeps the impulses for the next step.   reads contacts; writes records, graph
template <class Real>
void end_contacts(Simulation<Real>& sim);

/// Writes positions and velocities back.   reads records; writes pose, velocity, angle, spin
template <class Real>
void end_substeps(Simulation<Real>& sim);

/// Puts back what was thrown through a wall within the step; a part of end_substeps.   reads motion; writes
/// pose, velocity, books
template <class Real>
void clamp_to_walls(Simulation<Real>& sim);

/// Turns bodies.   reads and writes angle, spin
template <class Real>
void advance_rotation(Simulation<Real>& sim);

/// Writes what gravity and drag did into the books.   reads motion; writes books
template <class Real>
void keep_books(Simulation<Real>& sim);

}  // namespace carom
