#pragma once

#include <cstdint>
#include <vector>

#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/impacts/held_impacts.hpp"
#include "state/books.hpp"

namespace carom {

/// Carries out the impacts of convex shapes that the bodies, as they fly, would have in the substep. A
/// contact that bounces, is not pressed and is met faster than gravity would make it in two substeps is an
/// impact.
///
/// One impact follows the other, each by Newton's law of both points at once, then by Coulomb's: neither adds
/// energy, and momentum and angular momentum of two bodies that move are kept to round-off. A body's velocity
/// changes at the start and at the end of the substep alike, so that the impulse is not foreseen for the next
/// one; what the change moves it by before the impact is taken from its displacement. What is left after
/// eight rounds over all contacts, and all that comes slower, is solved as contacts, without restitution,
/// about the points of the step's start: their angular momentum is kept to first order of the step. What
/// comes fast but would not yet meet is hidden from the paths: a push out of an overlap may take it to its
/// partner in this substep, where it would be stopped.
///
/// Cost: about 5 ns a contact that bounces and substep, and 100 ns an impact.
/// @param held  impacts of bodies that joints hold
/// @param gravity_work  J, gravity's work on velocities, to be booked
/// @param deflected  out: rows of discs that an impact deflected; some may be named twice
/// @return impacts
template <class Real>
std::int64_t carry_out_impacts(PathSolver<Real>& paths, const SubstepTerms& terms, const Bodies<Real>& bodies,
                               BodyRecords<Real>& records, HeldImpacts<Real>& held, Books& books,
                               double& gravity_work, std::vector<std::int32_t>& deflected);

}  // namespace carom
