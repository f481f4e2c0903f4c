#pragma once

#include <array>
#include <cstdint>

#include "math/vec2_math.hpp"
#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "solvers/soft/joints/joined_contacts.hpp"

namespace carom {

/// A contact in whichever store, with what a unit impulse along each of its directions does: along its normal
/// at the first and at the second point, and along its tangent. Rolling resistance has none.
struct HeldContact {
    static constexpr std::size_t kDirections = 3, kPoints = 2, kTangent = kPoints;
    static constexpr std::int32_t kNothing = -1;
    using Values = std::array<double, kDirections>;  // by direction
    enum class Store : std::uint8_t { path, pair, support };

    Store store;
    std::size_t number;                   // in its store
    std::array<std::int32_t, 2> row;      // of its bodies; kNothing: no impulse moves it
    std::array<std::int32_t, 2> record;   // likewise; of a path also where the velocity of nothing is
    std::array<Vec2, kDirections> along;  // N s, on the second body, minus that on the first
    std::array<Values, 2> at_rim;         // N s, what both rims are given: effects/contact_law.hpp
    std::array<bool, kDirections> acts;   // whether there is such a direction
    double friction;                      // Coulomb coefficient

    /// What an impulse along a direction gives the first (0) or the second body (1).
    Vec2 impulse_on(std::size_t side, std::size_t direction) const {
        return side == 0 ? -along[direction] : along[direction];
    }
    /// The part of a motion of one side along a direction: m/s, or m.
    /// @param rim  of its rim
    double part_of(std::size_t side, std::size_t direction, Vec2 motion, double rim) const {
        return dot(impulse_on(side, direction), motion) + at_rim[side][direction] * rim;
    }
};

/// The contacts of a step in all stores, as HeldContact.
template <class Real>
class HeldContacts {
  public:
    HeldContacts(const StepView<Real>& step, PathSolver<Real>& paths) : step_(step), paths_(paths) {}

    /// Calls fn(contact) for each of some, in an order that rows alone decide.
    template <class Fn>
    void for_each(const JoinedContacts& some, const Bodies<Real>& bodies, const Fn& fn) const {
        some.for_each_path(paths_, [&](const PathContact<Real>& contact, std::size_t number) {
            fn(of_path(contact, number, bodies));
        });
        for (const std::size_t i : some.pairs) fn(of_discs(step_.graph.pairs, i, HeldContact::Store::pair));
        for (const std::size_t i : some.supports)
            fn(of_discs(step_.supports, i, HeldContact::Store::support));
    }
    /// Separation of a point by what the bodies have come in this step [m].
    double separation(const HeldContact& contact, std::size_t point) const;
    /// By how much the velocity along each direction is below what it has to be [m/s]: a floor at points,
    /// zero along the tangent.
    HeldContact::Values lack(const HeldContact& contact) const;
    /// The velocity along each direction [m/s]: of the second body less that of the first, surfaces apart.
    HeldContact::Values parting(const HeldContact& contact) const;
    HeldContact::Values impulses(const HeldContact& contact) const;  ///< N s
    /// Adds to the impulses; velocities stay as they are.
    void add(const HeldContact& contact, const HeldContact::Values& more) const;

  private:
    static HeldContact of_path(const PathContact<Real>& contact, std::size_t number,
                               const Bodies<Real>& bodies);
    HeldContact of_discs(const ContactRows<Real>& rows, std::size_t i, HeldContact::Store store) const;
    ContactRows<Real>& rows_of(const HeldContact& contact) const {
        return contact.store == HeldContact::Store::pair ? step_.graph.pairs : step_.supports;
    }

    StepView<Real> step_;
    PathSolver<Real>& paths_;
};

extern template class HeldContacts<float>;
extern template class HeldContacts<double>;

}  // namespace carom
