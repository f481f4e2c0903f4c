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
/// Cost: about 5 ns a contact that bounces and substep, 100 ns an impact, and as much a contact of what it
/// struck.
template <class Real>
class ShapeImpacts {
  public:
    /// @param held  impacts of bodies that joints hold
    /// @param gravity_work  J, gravity's work on velocities, to be booked
    /// @return impacts
    std::int64_t carry_out(PathSolver<Real>& paths, const SubstepTerms& terms, const Bodies<Real>& bodies,
                           BodyRecords<Real>& records, HeldImpacts<Real>& held, Books& books,
                           double& gravity_work);
    /// Rows of discs that an impact deflected in this substep; some may be named twice.
    const std::vector<std::int32_t>& deflected() const { return deflected_; }

    std::size_t bytes() const {
        return bouncing_.capacity() * sizeof(Bouncing) + changed_.capacity() * sizeof(std::uint32_t) +
               deflected_.capacity() * sizeof(std::int32_t);
    }

  private:
    /// A contact that has restitution.
    struct Bouncing {
        std::size_t number;        // among all contacts of the step
        std::int32_t near, far;    // rows in the records
        std::uint32_t looked = 0;  // number of the look at it, among all of the substep
        bool comes = false;        // as that look found: fast, but not near enough yet
    };

    std::vector<Bouncing> bouncing_;
    std::vector<std::uint32_t> changed_;  // by row: number of the look that changed its velocity last
    std::vector<std::int32_t> deflected_;
};

extern template class ShapeImpacts<float>;
extern template class ShapeImpacts<double>;

}  // namespace carom
