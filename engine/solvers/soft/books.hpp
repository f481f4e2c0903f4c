#pragma once

#include <carom/ledger.hpp>

#include <vector>

#include "solvers/paths/path_books.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "state/world_state.hpp"

namespace carom {

/// The ledger of solver `soft`: work and momentum by cause, from impulses and velocities, in double
/// precision.
///
/// In a substep a body's velocity goes from v0 to v1 by the sum of all impulses on it, so its kinetic energy
/// grows by exactly (sum of impulses) · (v0 + v1) / 2, and each impulse's share is its own product with that
/// mean. The mean velocity of the surfaces of a contact splits its share into what the contact takes, by its
/// normal and by its tangential impulse, and what a moving support drives.
template <class Real>
class SubstepBooks {
  public:
    double gravity_work = 0;    ///< J, of this step, on velocities
    double work_of_joints = 0;  ///< J, of this substep, as booked

    /// Books what the impulses of this substep and free flight did; only the walls' impulses if the ledger is
    /// closed.
    void book_substep(const StepView<Real>& step, const WorldState<Real>& world, Books& books);
    /// Books the same of contacts of shapes.
    void book_paths(const PathSolver<Real>& paths, const BodyRecords<Real>& records, Books& books,
                    const Executor& executor) {
        carom::book_paths(paths, records, books, parts_of_paths_, executor);
    }
    /// Books what the displacements of this step did against gravity.
    /// @param rows  bodies that took part in it
    void book_displacements(std::size_t rows, const WorldState<Real>& world, const Column<Real>& motion,
                            Books& books);
    /// Books what the overlaps are worth that this step found (solvers/shared/check_energy.hpp), by the
    /// forces of the last substep.
    static void book_overlaps(const StepView<Real>& step, const PathSolver<Real>& paths,
                              const WorldState<Real>& world, Books& books);

    std::size_t bytes() const {
        return mean_.bytes() + flights_.capacity() * sizeof(Flights) + works_.capacity() * sizeof(Work) +
               parts_of_paths_.capacity() * sizeof(Books);
    }

  private:
    void book_free_flight(const StepView<Real>& step, const WorldState<Real>& world, Books& books);
    void book_contacts(const StepView<Real>& step, Books& books);

    /// Sums over bodies: FlightSums.
    struct Flights {
        Vec2 mean, start;           // kg m/s
        double path = 0, turn = 0;  // J
    };
    /// WorkSums of a group of contacts.
    struct Work {
        double normal, tangent;  // J
    };

    Column<Real> mean_;                  // [rows][4]: velocities over the substep
    std::vector<Flights> flights_;       // of a chunk of bodies each
    std::vector<Work> works_;            // of the groups of pairs, then of supports
    std::vector<Books> parts_of_paths_;  // of some contacts each
};

extern template class SubstepBooks<float>;
extern template class SubstepBooks<double>;

}  // namespace carom
