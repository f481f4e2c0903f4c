#pragma once

#include <cstdint>
#include <vector>

#include "solvers/joints/joint_step.hpp"
#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "solvers/soft/joints/joined_contacts.hpp"

namespace carom {

/// Finds the groups of joined bodies, solved exactly, that contacts throw.
///
/// A substep begins with the impulses that contacts had in the one before. After a blow these are the blow's
/// once more: joints spread them over all of their group, and contacts, which are solved in turns with them,
/// do not take all of that back. Impulses at which contacts give a group energy are worse than none: started
/// from none, each solve of contacts or of joints only takes energy.
/// docs/decisions/0041-joints-that-are-hit.md.
template <class Real>
class ForeseenBlows {
  public:
    /// @param group_of  by row; -1: none
    void set_groups(const std::vector<std::int32_t>& group_of, std::size_t groups);
    /// To be called when joints are solved for what contacts foresee.
    /// @param joined  those contacts that groups have
    /// @param touches  [groups], not 0 for those that can touch something
    /// @return whether there are such groups
    /// Cost: 2 ns a joined body; 10 ns a contact of these if a group has more energy than free flight gave
    /// it.
    bool find(const JointStep<Real>& step, const StepView<Real>& contacts, const PathSolver<Real>& paths,
              const JoinedContacts& joined, const std::vector<std::uint8_t>& touches);
    bool is_thrown(std::size_t group) const { return is_thrown_[group] != 0; }
    /// Takes back what the contacts of these groups foresaw.
    void take_back(const StepView<Real>& contacts, PathSolver<Real>& paths) const;

    std::size_t bytes() const;

  private:
    bool find_risen(const JointStep<Real>& step, const StepLoops<Real>& loops,
                    const std::vector<std::uint8_t>& touches);

    std::vector<std::size_t> first_;     // of members_, by group, and the end
    std::vector<std::int32_t> members_;  // rows
    std::vector<std::int32_t> group_of_;
    std::vector<std::uint8_t> is_thrown_;     // [groups]
    std::vector<double> least_, work_;        // J, by group: what is a blow, what contacts give
    std::vector<std::uint8_t> is_of_thrown_;  // [rows]
};

extern template class ForeseenBlows<float>;
extern template class ForeseenBlows<double>;

}  // namespace carom
