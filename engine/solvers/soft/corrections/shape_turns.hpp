#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/contacts/contact_sweeps.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "solvers/substeps/body_masses.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Solves contacts of shapes by turns with all others until little is left.
///
/// A path hands on the load of a heavy body along it whatever the masses; what a light body owes to the other
/// paths through it takes a turn a body. So turns are taken where a heavy body is loaded through light ones:
/// docs/decisions/0064-uneven-masses-in-sweeps.md. So they are in the step after a heavy shape was removed,
/// whose weight others still carry: docs/decisions/0067-weights-taken-off-heaps.md.
template <class Real>
class ShapeTurns {
  public:
    /// To be called when the contacts of shapes of a step are found. Cost: O(contacts of shapes) where masses
    /// are uneven.
    void begin_step(const WorldState<Real>& world, const PathSolver<Real>& paths,
                    const BodyMasses<Real>& masses);
    /// Tells that a body was removed or put elsewhere between steps. @param mass  kg
    void note_lost(double mass) { heaviest_lost_ = std::max(heaviest_lost_, mass); }
    /// Whether contacts of shapes may have to be solved by turns in this step.
    bool may_be_due() const { return most_ > 0; }
    /// Takes turns after all contacts were solved in a substep, until a sweep over them changes little: none
    /// where no two shapes of uneven masses touch, where light ones hardly move the heavy ones, and no heavy
    /// one has gone. Cost: O(contacts), at most `kMostTurns` times that of a substep.
    void settle(const StepView<Real>& step, ContactSweeps<Real>& sweeps, PathSolver<Real>& paths);

    std::size_t bytes() const {
        return uneven_.capacity() * sizeof(Uneven) + before_.bytes() + load_.bytes();
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.heaviest_lost_);
    }

  private:
    /// A contact of a heavy and a light body.
    struct Uneven {
        std::size_t number;  // among all contacts of shapes
        std::int32_t heavy;  // row
    };

    std::size_t count_heavy(std::size_t rows);
    bool is_any_loaded(const StepView<Real>& step, const PathSolver<Real>& paths);

    int most_ = 0, most_of_struck_ = 0;  // turns in a substep, at most
    double heaviest_lost_ = 0;           // kg, of what went where it was since the step before
    double settled_ = 0;                 // turns end at this change, in what gravity adds in a substep
    std::vector<Uneven> uneven_;         // of the step
    Column<Real> before_;                // velocity records before a sweep
    Column<Real> load_;                  // by row: N s that light bodies give a heavy one in a substep
};

extern template class ShapeTurns<float>;
extern template class ShapeTurns<double>;

}  // namespace carom
