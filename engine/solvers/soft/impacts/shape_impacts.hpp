#pragma once

#include <bit>
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
/// A kernel tells which contacts come fast as the substep begins, and which of them surely do not meet in it.
/// Only the others, and those of bodies that an impact has changed since they were looked at, are looked at:
/// in a round in their order, those that an impact makes due behind it in the same round, those before it in
/// the next one.
///
/// Cost: about 1 ns a contact and substep, 100 ns an impact, and 10 ns a contact of what it struck.
/// docs/decisions/0087-shapes-that-bounce.md.
template <class Real>
class ShapeImpacts {
  public:
    /// To be called when the contacts of a step have been found.
    void begin_step() { is_listed_ = are_of_rows_listed_ = false; }
    /// @param held  impacts of bodies that joints hold
    /// @param gravity_work  J, gravity's work on velocities, to be booked
    /// @return impacts
    std::int64_t carry_out(PathSolver<Real>& paths, const SubstepTerms& terms, const Bodies<Real>& bodies,
                           BodyRecords<Real>& records, const StepLoops<Real>& loops, HeldImpacts<Real>& held,
                           Books& books, double& gravity_work);
    /// Rows of discs that an impact deflected in this substep; some may be named twice.
    const std::vector<std::int32_t>& deflected() const { return deflected_; }

    std::size_t bytes() const;

  private:
    /// A bit for each of them.
    class Set {
      public:
        void clear(std::size_t count) { words_.assign((count + kBits - 1) / kBits, 0); }
        void put(std::size_t i) { words_[i / kBits] |= std::uint64_t{1} << (i % kBits); }
        void take(std::size_t i) { words_[i / kBits] &= ~(std::uint64_t{1} << (i % kBits)); }
        /// Calls fn(i) for each in order, those included that fn puts behind i.
        template <class Fn>
        void for_each(const Fn& fn) {
            for (std::size_t word = 0; word < words_.size(); ++word)
                for (std::uint64_t ahead = ~std::uint64_t{0}; (words_[word] & ahead) != 0;) {
                    const int bit = std::countr_zero(words_[word] & ahead);
                    ahead = ~std::uint64_t{1} << bit;
                    fn(kBits * word + static_cast<std::size_t>(bit));
                }
        }
        std::size_t bytes() const { return words_.capacity() * sizeof(std::uint64_t); }

      private:
        static constexpr std::size_t kBits = 64;
        std::vector<std::uint64_t> words_;
    };

    bool list_fast(PathSolver<Real>& paths, const SubstepTerms& terms, BodyRecords<Real>& records,
                   const StepLoops<Real>& loops);
    void list_bouncing(const PathSolver<Real>& paths, std::size_t links);
    void list_of_rows(std::size_t rows);

    bool is_listed_ = false, are_of_rows_listed_ = false;  // bouncing_; of_row_
    std::vector<PathContact<Real>> bouncing_;              // contacts that have restitution
    std::vector<std::int32_t> at_place_;                   // by PathSolver::place_of: of bouncing_; -1: none
    std::vector<std::uint32_t> first_of_row_, of_row_;     // by row: its contacts, of bouncing_
    Set due_, coming_;                                     // to be looked at; fast, but not near enough yet
    Column<Real> start_;  // [rows][4], m/s, velocities at the start of the substep
    std::vector<std::int32_t> deflected_;
};

extern template class ShapeImpacts<float>;
extern template class ShapeImpacts<double>;

}  // namespace carom
