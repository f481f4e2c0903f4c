#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "constraints/contact_rows.hpp"
#include "kernels/contacts/contact_arguments.hpp"
#include "solvers/contact_sets/light_groups.hpp"
#include "solvers/contact_sets/local_contact.hpp"

namespace carom {

/// Contacts of bodies of very different masses, and those around the lighter ones, solved to convergence.
///
/// A sweep takes from a heavy body what its light neighbours can stop: their share of its mass. Between a
/// floor and a body a million times heavier it would take a million sweeps. So the contacts of a body that is
/// squeezed by one more than kUneven times as heavy are solved on their own after the sweeps, as a small
/// system in double precision, by sweeps that a conjugate gradient makes faster: many contacts under one
/// heavy body behave nearly alike, and all that is alike takes one step. Scenes of like masses have none of
/// it. Numbers: docs/decisions/0014-mass-ratios.md. Source: nonsmooth nonlinear conjugate gradients
/// (Silcowitz-Hansen, Niebe & Erleben 2010).
template <class Real>
class LocalSolve {
  public:
    static constexpr double kUneven = 10;  // ratio of masses

    /// Looks for them among all pairs, when these are new.
    /// @param inverse_mass  of each row, with any sign
    /// Cost: O(pairs), a few times if there are any.
    void find(const ContactRows<Real>& pairs, const Column<Real>& inverse_mass, std::size_t rows);
    void clear() { pairs_.clear(); }
    /// Those that were found, as places among all pairs.
    std::span<const std::uint32_t> found() const { return pairs_; }
    /// Whether there are too many for all to be solved to their end.
    bool has_many() const;

    /// Those that can touch in this step. Cost: O(supports + what was found).
    void begin_step(const ContactRows<Real>& pairs, const ContactRows<Real>& supports);
    /// Leaves all to others in this step.
    void leave_step() { rows_.clear(), contacts_.clear(); }
    /// After the sweeps of a substep: relaxes groups of few light bodies.
    /// @param k  of pairs and of supports
    /// @param fall  m/s, what gravity adds in a substep
    /// @return how many contacts are left to be solved
    std::size_t begin(const SolveContacts<Real>& of_pairs, const SolveContacts<Real>& of_supports,
                      double fall);
    /// Solves what is left, and stores all.
    /// @return m/s, the largest change of the last sweep over contacts
    double solve(const SolveContacts<Real>& of_pairs, const SolveContacts<Real>& of_supports, double fall);

    std::size_t bytes() const;

  private:
    using Contact = LocalContact;

    std::int32_t body_of(std::int32_t row);
    void load(const SolveContacts<Real>& of_pairs, const SolveContacts<Real>& of_supports);
    void store(const SolveContacts<Real>& of_pairs, const SolveContacts<Real>& of_supports) const;
    template <unsigned kVariant>
    double sweep();
    double change() const;
    void conjugate_step(double share);
    template <int kSize>
    std::size_t relax(LightGroups<kSize>& groups, double fall);

    std::vector<std::uint32_t> pairs_;     // that may touch until the pairs change
    std::vector<std::uint8_t> is_near_;    // by row: how many contacts from a heavy body, at least 1
    std::vector<std::int32_t> number_of_;  // by row, in rows_
    std::vector<std::int32_t> rows_;       // of the bodies of this step
    std::vector<double> records_;          // [bodies][4], as in the velocity records
    std::vector<Contact> contacts_;        // of this step: pairs, then supports
    std::size_t pair_count_ = 0;
    LightGroups<2> smooth_;
    LightGroups<3> rough_;
    std::vector<std::uint32_t> swept_;   // those of contacts_ that are left to sweeps
    std::vector<double> first_records_;  // after the first sweep
    std::vector<Contact> first_contacts_;
};

extern template class LocalSolve<float>;
extern template class LocalSolve<double>;

}  // namespace carom
