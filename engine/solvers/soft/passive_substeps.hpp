#pragma once

#include <cstdint>
#include <vector>

#include "sleeping/islands.hpp"
#include "solvers/soft/solved_substep.hpp"

namespace carom {

/// Keeps joints and contacts from making energy.
///
/// A substep begins with the impulses of the one before. After a blow these are the blow's once more, and
/// sweeps and passes along paths do not take all of that back: bodies that hang together come apart with more
/// energy than free flight left them, and more than motors, springs and surfaces that move have given. Each
/// visit of a contact or a joint only takes energy, so that a start from less is what helps. Of an island of
/// bodies that has gained, the impulses of those groups of bodies that have risen are multiplied by the share
/// at which the island has the least energy; then joints and contacts are solved once more.
/// docs/decisions/0062-passive-substeps.md.
template <class Real>
class PassiveSubsteps {
  public:
    /// To be called when all velocities of the substep are solved.
    /// @param is_last  whether no round follows: then all bodies of an island that has gained very much count
    /// as risen, so that it ends with no more than it had
    /// @return what islands had gained [J], where that is too much; else 0
    /// Cost: 0.5 ns a body; where the world has more energy than free flight left it and than it was given,
    /// 10 ns a body and contact.
    double bound(const SolvedSubstep<Real>& solved, bool is_last);

    /// Whether the last call scaled impulses.
    bool has_scaled() const { return has_scaled_; }

    std::size_t bytes() const;

  private:
    /// A body, a group that joints connect, or an island.
    struct Gain {
        double mass = 0, before = 0;  // kg, J: energy after free flight
        double gain = 0;              // J: what impulses added
    };
    struct Island : Gain {
        double work = 0, effort = 0;  // J, of what may give energy: sum, sum of sizes
        double along = 0;          // J, momentum now times the velocities that impulses of risen bodies gave
        double square = 0;         // J, twice the energy of these velocities alone
        double work_of_risen = 0;  // J, the part of `work` that those impulses did
        // J, likewise of what joints on bent paths gave; beyond a bound it is not in the above.
        double bend = 0, effort_of_bend = 0, bend_of_risen = 0;
        bool has_gained = false;
        double share = 1;
    };

    void make_room(std::size_t rows);
    bool world_gains(const SolvedSubstep<Real>& solved) const;
    bool find_risen(const SolvedSubstep<Real>& solved);
    void find_islands(const SolvedSubstep<Real>& solved);
    double find_gains(const SolvedSubstep<Real>& solved);
    void find_velocities_without(const SolvedSubstep<Real>& solved);
    bool find_shares(const SolvedSubstep<Real>& solved);
    void scale(const SolvedSubstep<Real>& solved);
    Island& island_of(std::size_t row) {
        return islands_[static_cast<std::size_t>(rows_.island_of(static_cast<std::int32_t>(row)))];
    }

    bool has_scaled_ = false;
    std::vector<Gain> groups_;             // [rows], of groups by their smallest row
    std::vector<Island> islands_;          // likewise
    std::vector<std::uint8_t> has_risen_;  // [rows of records]
    Islands rows_;
    Column<Real> without_;       // [rows of records][4], velocities without what is scaled
    std::vector<double> share_;  // [rows of records]
};

extern template class PassiveSubsteps<float>;
extern template class PassiveSubsteps<double>;

}  // namespace carom
