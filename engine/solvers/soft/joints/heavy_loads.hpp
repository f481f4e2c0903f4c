#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "constraints/coupled_impulses.hpp"
#include "solvers/soft/joints/held_contacts.hpp"
#include "solvers/soft/joints/soft_joints.hpp"

namespace carom {

/// Contacts of bodies that joints hold with what weighs many times as much: the load on a bridge of light
/// planks, the ground under the wheels of a loaded cart.
///
/// Contacts and joints are solved in turns, and to a contact a plank is as heavy as it is alone. Of a load of
/// a hundred planks a turn takes what would stop one plank; then joints draw that plank back into the load.
/// These contacts know what their bodies are with all that joints hold. A unit impulse along a direction i of
/// one is answered by the factored system of the group (JointSystem::answer) with a change R_i of the
/// velocities of all its bodies, and J_k R_i, with the direction J_k of another, is their inverse mass. So
/// impulses are found that the contacts hold with while joints hold: a problem of complementarity with
/// friction, as small as these contacts are few. Motors of these groups are rows of it: they hold a load up
/// to the most that they have, and wheels that all of them drive have more motors and grips than ways to go.
/// Rolling resistance is left to the turns.
///
/// Where joints are corrected by displacements, what presses is displaced with them (JointSystem::Load).
///
/// Cost: about .1 us a joint and body with such contacts in each substep, .3 us a joint and turn;
/// O(directions²) for the problem. docs/decisions/0069-loads-on-light-mechanisms.md.
template <class Real>
class HeavyLoads {
  public:
    /// Finds the contacts of a step. Cost: O(contacts of groups that are solved exactly).
    void find(const HeldContacts<Real>& contacts, const JointStep<Real>& step, SoftJoints<Real>& joints);
    /// Whether none may press in this substep.
    bool empty() const { return contacts_.empty(); }
    /// Before joints are solved in a substep: tells them what presses on their bodies.
    void tell(const HeldContacts<Real>& contacts, const JointStep<Real>& step, SoftJoints<Real>& joints);
    /// After that: displaces what presses, and finds what impulses do.
    void begin_substep(const JointStep<Real>& step, SoftJoints<Real>& joints);
    /// Gives bodies, whose joints were just solved, what these contacts lack.
    /// @return by how much an impulse changed the velocity along its own direction, at most [m/s]
    double solve(const HeldContacts<Real>& contacts, const JointStep<Real>& step, SoftJoints<Real>& joints);

    std::size_t bytes() const;

  private:
    static constexpr std::size_t kDirections = HeldContact::kDirections;

    /// A direction of a contact on a body that joints hold.
    struct HeldEnd {
        std::size_t direction;     // of impulses_
        std::size_t body;          // of the group's rows
        std::size_t last_body;     // the last of those of this end and the ones before
        JointSystem::Vector push;  // what a unit impulse gives it [N s, N s, N m s]
    };
    struct HeldGroup {
        std::vector<std::int32_t> rows;  // of bodies with such contacts
        std::vector<HeldEnd> ends;
    };
    /// Where a load of a group is, in the order in which they were told.
    struct Told {
        std::int32_t group;
        std::size_t load;
    };

    void weigh_groups(const HeldContacts<Real>& contacts, const Bodies<Real>& bodies,
                      SoftJoints<Real>& joints);
    double weight_of(std::int32_t row, const Bodies<Real>& bodies, const SoftJoints<Real>& joints) const;
    bool is_heavy(const HeldContact& contact, const Bodies<Real>& bodies,
                  const SoftJoints<Real>& joints) const;
    static bool may_press(const HeldContact& contact, const HeldContacts<Real>& contacts,
                          const JointStep<Real>& step);
    void displace_loads(const JointStep<Real>& step, SoftJoints<Real>& joints) const;
    void list_held_ends(SoftJoints<Real>& joints);
    void add_answers(std::size_t g, SoftJoints<Real>& joints);
    void find_answers(const JointStep<Real>& step, SoftJoints<Real>& joints);
    void find_masses(const JointStep<Real>& step, SoftJoints<Real>& joints);
    void add_answer(std::size_t by, std::int32_t row, const std::array<double, 3>& change);
    void leave_held_directions(const Bodies<Real>& bodies, SoftJoints<Real>& joints);
    void read_motors(const JointStep<Real>& step, SoftJoints<Real>& joints);
    /// Calls fn(row of impulses_, motor) for the motors of groups_[g].
    template <class Fn>
    void for_each_motor(std::size_t g, SoftJoints<Real>& joints, const Fn& fn) const {
        std::size_t row = kDirections * contacts_.size() + first_motor_[g];
        for (const JointSystem::Motor& motor : joints.exact_group(groups_[g]).motors()) fn(row++, motor);
    }
    std::size_t number_of(std::int32_t group) const {
        return static_cast<std::size_t>(std::lower_bound(groups_.begin(), groups_.end(), group) -
                                        groups_.begin());
    }

    std::vector<HeldContact> found_;     // of the step
    std::vector<HeldContact> contacts_;  // those of them that may press in this substep
    std::vector<std::int32_t> groups_;   // of their bodies, ascending
    std::vector<double> weight_;         // kg, by group: the heaviest of its bodies and of what touches them
    std::vector<Told> told_;
    std::vector<HeldGroup> held_;                // as groups_
    std::vector<JointSystem::Vector> changes_;   // of bodies of one of them, by an impulse
    std::vector<std::size_t> first_motor_;       // as groups_, and the end: of motors_
    std::vector<CoupledImpulses::Ends> motors_;  // by group
    CoupledImpulses impulses_;                   // by contact and direction, then by motor
    std::vector<double> more_;                   // N s, likewise: what is given beyond what was
    std::vector<std::vector<JointBlow>> blows_;  // as groups_
};

extern template class HeavyLoads<float>;
extern template class HeavyLoads<double>;

}  // namespace carom
