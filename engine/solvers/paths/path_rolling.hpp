#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "constraints/partner.hpp"
#include "solvers/manifolds/manifolds.hpp"
#include "solvers/substeps/body_records.hpp"
#include "state/books.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Rolling resistance where shapes touch with a round part: a disc on a box, the cap of a capsule, the round
/// corner of a polygon (effects/rolling_resistance.hpp has the law). A moment against the relative spin, at
/// most c R times the normal impulse, where R is the reduced radius of both surfaces at the contact; none at
/// a sharp corner, none where two points touch.
///
/// It is solved in turns with the contacts. Cost: 20 ns a contact and turn; nothing without the effect.
template <class Real>
class PathRolling {
  public:
    /// Lists the contacts of the step that resist. Those that did before keep their moments.
    /// @param row_of_far  rows in the records of b of each live contact
    void find(const WorldState<Real>& world, const Manifolds<Real>& manifolds,
              std::span<const std::int32_t> row_of_far);
    bool empty() const { return contacts_.empty(); }
    void clear() { contacts_.clear(); }

    void warm_start(BodyRecords<Real>& records) const;
    /// @param normal_of  normal_of(n): the normal impulse of live contact n in this substep [N s]
    template <class NormalOf>
    void solve(BodyRecords<Real>& records, const NormalOf& normal_of) {
        for (Contact& contact : contacts_) solve(contact, records, normal_of(contact.number));
    }
    /// Work of the moments of a substep.
    void book(const BodyRecords<Real>& records, Books& books) const;
    /// To be called when impulses are those of substeps of another length, by this factor.
    void rescale(Real factor) {
        for (Contact& contact : contacts_) contact.moment *= factor;
    }

    /// Calls fn(row, work) for each contact with a surface that nothing moves: what the surface gives to the
    /// body in that row, by its own motion [J].
    template <class Fn>
    void for_each_drive(const BodyRecords<Real>& records, const Fn& fn) const {
        for (const Contact& contact : contacts_) {
            const auto b = static_cast<std::size_t>(contact.b);
            if (b >= records.count())
                fn(contact.a, -static_cast<double>(contact.moment) * static_cast<double>(contact.per_rim_b) *
                                  static_cast<double>(records.velocity[4 * b + 2]));
        }
    }
    /// Takes the moments that contacts of some bodies have from velocities; contacts keep theirs.
    /// @param is_of  [rows], not 0 for these bodies  @param velocity  [rows][4], as records have them
    void take_from(const std::vector<std::uint8_t>& is_of, Column<Real>& velocity) const {
        for (const Contact& contact : contacts_)
            if ((is_of[static_cast<std::size_t>(contact.a)] | is_of[static_cast<std::size_t>(contact.b)]) !=
                0)
                give(contact, -contact.moment, velocity);
    }
    /// Multiplies the moment of each contact by share_of(row, row).
    template <class ShareOf>
    void scale(const ShareOf& share_of) {
        for (Contact& contact : contacts_)
            contact.moment *= static_cast<Real>(share_of(contact.a, contact.b));
    }

    std::size_t bytes() const { return (contacts_.capacity() + old_.capacity()) * sizeof(Contact); }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.contacts_);
    }

  private:
    struct Contact {
        ManifoldName name;
        std::uint32_t number;       // of the live contact
        std::int32_t a, b;          // rows of the records
        Real arm;                   // m, c R
        Real per_rim_a, per_rim_b;  // 1/m; of what is no body zero: it does not turn
        Real moment;                // N m s, of b
    };
    void solve(Contact& contact, BodyRecords<Real>& records, Real normal);
    static void give(const Contact& contact, Real moment, Column<Real>& velocity);

    std::vector<Contact> contacts_, old_;
};

extern template class PathRolling<float>;
extern template class PathRolling<double>;

}  // namespace carom
