#pragma once

#include <cstdint>
#include <vector>

#include "solvers/soft/contacts/contact_sweeps.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "state/books.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Contacts that hold, and that impacts of a substep have left closing: the crowd that presses was struck.
///
/// An impact is carried out between two bodies, after the sweeps. What it gives to a body that lies on others
/// goes on to these as impacts without restitution, until they would come less than .01 radii into each other
/// by the next sweeps. In a crowd that collapses that is the rule at every contact in every substep, always
/// inwards, and the crowd is compressed while it builds up. So the contacts around are swept once more behind
/// the impacts, by impulses of their own that only push: they take energy, whatever the velocities.
///
/// A share of these impulses is foreseen, as all forces of contacts are: a crowd that is struck in one
/// substep is struck in the next.
/// Numbers: docs/decisions/0093-crowds-that-bounce.md.
template <class Real>
class StruckContacts {
  public:
    /// After the impacts of a substep.
    /// @param motion  [rows][4] at the start of the step
    /// @param chunks  in which contacts were left closing
    /// Cost: kSweeps sweeps over the contacts of these chunks, and as much as four more.
    void settle(const StepView<Real>& step, const WorldState<Real>& world, ContactSweeps<Real>& sweeps,
                const Column<Real>& motion, const std::vector<std::uint8_t>& chunks, Books& books);

    std::size_t bytes() const {
        return pairs_.bytes() + supports_.bytes() + before_.bytes() + runs_.bytes() + is_swept_.capacity();
    }

  private:
    /// What sweeps read and write in place of the contacts' own columns.
    struct Columns {
        Column<Real> normal_x, normal_y, mass, floor, impulse;

        void resize(std::size_t contacts) {
            for (Column<Real>* column : {&normal_x, &normal_y, &mass, &floor, &impulse})
                column->resize_for_overwrite(contacts);
        }
        void set(std::size_t i, Real nx, Real ny, Real m, Real v) {
            normal_x[i] = nx, normal_y[i] = ny, mass[i] = m, floor[i] = v, impulse[i] = 0;
        }
        SolveContacts<Real> put_in(SolveContacts<Real> k) {
            k.contacts.normal_x = normal_x.data(), k.contacts.normal_y = normal_y.data();
            k.contacts.mass = mass.data(), k.contacts.floor = floor.data();
            k.contacts.normal_impulse = impulse.data();
            return k;
        }
        std::size_t bytes() const {
            return normal_x.bytes() + normal_y.bytes() + mass.bytes() + floor.bytes() + impulse.bytes();
        }
    };
    void begin_pairs(const StepView<Real>& step, const Column<Real>& motion);
    void begin_supports(const StepView<Real>& step);
    void keep_impulses(const StepView<Real>& step, Books& books);
    void keep_velocities(const StepView<Real>& step, const WorldState<Real>& world, Books& books);

    Columns pairs_, supports_;
    Column<Real> before_;                 // [rows][4]: velocity records
    std::vector<std::uint8_t> is_swept_;  // [chunks]
    PairRuns<Real> runs_;                 // of these
};

extern template class StruckContacts<float>;
extern template class StruckContacts<double>;

}  // namespace carom
