#pragma once

#include <memory>
#include <string>
#include <vector>

#include "constraints/contact_graph.hpp"
#include "solvers/joints/direct_joints.hpp"
#include "solvers/joints/swept_joints.hpp"
#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "solvers/soft/joints/foreseen_blows.hpp"
#include "solvers/soft/joints/joined_contacts.hpp"
#include "solvers/substeps/step_flights.hpp"

namespace carom {

/// The joints of a world under solver `soft`. Bodies that joints connect are a group. A group that is a tree,
/// or nearly one, is solved exactly (direct_joints.hpp); one with many loops, a net, is swept
/// (swept_joints.hpp), but for its joints that the kernels do not know, which are solved exactly beside the
/// sweeps. A crowd of small groups of bodies of like masses, a heap of ragdolls or a wood of ropes, is swept,
/// too.
template <class Real>
class SoftJoints {
  public:
    /// Solver `rattle`: joints alone, each group solved exactly, to round-off, whatever its size.
    bool is_rattle = false;

    /// Rows, masses or joints have changed: what was derived from them is made anew.
    void forget() { is_known_ = false; }
    /// Finds the groups if they are not known. Cost: O(bodies + joints) then.
    void find_groups(const WorldState<Real>& world);
    /// Rows beyond the bodies that joints name.
    std::size_t rows_beyond() const { return swept_.rows_beyond(); }

    /// @param contacts  of this step: groups that touch something are told from those that fly freely
    /// @param paths  the contacts of shapes
    /// @param flights  of which the present one begins
    void begin_step(const JointStep<Real>& step, const StepView<Real>& contacts,
                    const PathSolver<Real>& paths, const StepFlights& flights);
    void solve(const JointStep<Real>& step, const StepLoops<Real>& loops, int substep);
    /// Takes back what contacts foresaw where that gives a group energy, after `solve`.
    void forget_blows(const JointStep<Real>& step, const StepView<Real>& contacts, PathSolver<Real>& paths);
    /// Once more, after contacts have changed velocities.
    /// @return by how much that changed the velocity of a centre or a rim, at most [m/s]; infinity where
    /// joints are swept
    double solve_again(const JointStep<Real>& step, const StepLoops<Real>& loops);
    /// Asks for turns of contacts near bodies of groups that this has changed by more than `settled` [m/s].
    /// @return whether joints change no others, as sweeps do
    bool ask_turns(double settled, TurnRows& turns) const;
    /// Groups that are solved exactly, and the number of a body's group among them; -1: it is in none.
    std::size_t exact_groups() const { return first_beside_; }
    std::int32_t exact_group_of(std::int32_t row) const {
        return static_cast<std::size_t>(row) < group_of_.size() ? group_of_[static_cast<std::size_t>(row)]
                                                                : -1;
    }
    DirectJoints<Real>& exact_group(std::int32_t number) { return direct_[static_cast<std::size_t>(number)]; }
    /// The contacts of the step that these groups have.
    const JoinedContacts& contacts() const { return contacts_; }
    /// The group of a body if it has few joints, else null.
    DirectJoints<Real>* small_group_of(std::int32_t row);
    /// Whether contacts and joints are to be solved in turns in this step.
    bool touches() const { return touches_ || crowd_groups_ > 0; }
    /// Whether there are so many small groups that they are swept.
    bool has_crowd() const { return crowd_groups_ > 0; }
    /// Whether there are, and none of them hangs: nothing that lies on them has its weight from them alone.
    bool has_free_crowd() const { return has_crowd() && !crowd_hangs_; }
    /// Whether a group that is solved exactly touches something.
    bool touches_exactly() const { return touches_; }
    /// Whether hinges of a good part of a crowd were open at the end of the last step: it falls on a heap, or
    /// is squeezed in one.
    bool are_torn() const;
    void end_substep(const JointStep<Real>& step, Books& books);
    /// @return whether a joint broke, by the mean of its force in the step: at the end of its last flight
    /// @param contacts, paths  as they are after the last substep
    /// @param flights  of which the present one ends
    bool end_step(const JointStep<Real>& step, const StepView<Real>& contacts, const PathSolver<Real>& paths,
                  Books& books, const StepFlights& flights);

    /// Calls fn(row, row, work, bend) for what springs or drives, and for joints on paths that bend: works in
    /// this substep [J].
    template <class Fn>
    void for_each_drive(const JointStep<Real>& step, const Fn& fn) {
        swept_.for_each_drive(step, fn);
        for (DirectJoints<Real>& group : direct_)
            if (group.may_drive())
                fn(group.moving_row(), group.moving_row(), group.work_of_drives(step), 0.0);
    }
    /// Multiplies the impulses of each joint by share_of(row, row), which is the same for all joints of a
    /// group that is solved exactly; velocities stay as they are.
    template <class ShareOf>
    void scale(const ShareOf& share_of) {
        swept_.scale(share_of);
        for (DirectJoints<Real>& group : direct_)
            group.scale(share_of(group.moving_row(), group.moving_row()));
    }
    const SpringLoads& springs() const { return springs_; }
    /// The smallest row of the bodies that joints connect with this one; -1 where it has no joint.
    std::int32_t first_of_group(std::size_t row) const { return first_of_group_[row]; }

    /// [rows], above zero for bodies that have joints.
    const Real* joined() const { return joined_.data(); }
    /// Whether there are groups with many loops, which want more substeps.
    bool has_nets() const { return swept_groups_ > 0; }
    bool has_long_loops() const { return swept_.has_long_loops(); }
    std::size_t bytes() const;

    /// How many joints are solved in which way, in words, for `explain`.
    std::string describe() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.open_share_);
    }

  private:
    static bool hangs(const WorldState<Real>& world, const std::vector<std::size_t>& slots);
    static bool is_fit_for_crowd(const WorldState<Real>& world, const std::vector<std::size_t>& slots,
                                 double heaviest);
    static JointBreak break_of(const JointStep<Real>& step, std::size_t slot, double dt);
    void find_touching(const JointStep<Real>& step, const StepView<Real>& contacts,
                       const PathSolver<Real>& paths, double dt);
    void find_pressed(const StepView<Real>& contacts, const PathSolver<Real>& paths,
                      std::vector<std::uint8_t>& groups) const;
    /// Whether one of two rows is of such a group; below zero or beyond the bodies: none is.
    bool are_joined(std::int32_t a, std::int32_t b) const {
        return exact_group_of(a) >= 0 || exact_group_of(b) >= 0;
    }
    /// Marks the groups of two rows; below zero or beyond the bodies: none.
    void mark(std::int32_t a, std::int32_t b, std::vector<std::uint8_t>& groups) const {
        for (const std::int32_t row : {a, b})
            if (row >= 0 && static_cast<std::size_t>(row) < group_of_.size() &&
                group_of_[static_cast<std::size_t>(row)] >= 0)
                groups[static_cast<std::size_t>(group_of_[static_cast<std::size_t>(row)])] = 1;
    }

    /// The force and torque of a joint over the flights of a step that have ended.
    struct Mean {
        Vec2 force;         // N
        double torque = 0;  // N m
    };
    void add_to_means(JointStore& joints, const StepFlights& flights);

    bool is_known_ = false, touches_ = false;
    std::int64_t version_ = -1;  // of the store
    std::vector<DirectJoints<Real>> direct_;
    std::size_t first_beside_ = 0;  // of direct_, that are solved beside sweeps
    SweptJoints<Real> swept_;
    SpringLoads springs_;
    std::size_t swept_groups_ = 0, crowd_groups_ = 0;
    std::vector<std::size_t> breakable_;  // slots of joints that can break
    std::vector<Mean> means_;             // [slots], where a step has several flights
    Column<Real> joined_;
    std::vector<std::int32_t> first_of_group_;  // [rows]
    // The next members are of groups that are solved exactly, in the order of direct_.
    std::vector<std::int32_t> group_of_;  // by row; -1: none
    std::vector<std::uint8_t> group_touches_, is_pressed_;
    JoinedContacts contacts_;  // of the step
    ForeseenBlows<Real> blows_;
    bool crowd_hangs_ = false;
    double open_share_ = 0;  // of the mechanisms of a crowd, that were open at the end of the last step
};

extern template class SoftJoints<float>;
extern template class SoftJoints<double>;

}  // namespace carom
