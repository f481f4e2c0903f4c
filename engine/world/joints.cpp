#include <carom/world.hpp>

#include <cmath>
#include <limits>

#include "constraints/joints/joint_laws.hpp"
#include "scene/call_effects.hpp"
#include "scene/validation/limits.hpp"
#include "scene/wording.hpp"
#include "world/implementation.hpp"
#include "world/set_up.hpp"

// What a world does with joints between steps.

namespace carom {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::max();
constexpr Item kJoint{"the joint has", "", -1, ""};

void check_number(std::string_view where, std::string_view what, double value, double low, double high) {
    if (value >= low && value <= high) return;
    const bool is_finite = value - value == 0;
    throw Error(is_finite ? ErrorCode::out_of_range : ErrorCode::not_finite,
                join(where, ": ", what, " is ", value, "; expected ",
                     high < kNoLimit ? join(low, " to ", high) : join("a finite number >= ", low), "."));
}

[[noreturn]] void refuse(std::string_view where, std::string_view what, std::string_view of) {
    throw Error(ErrorCode::inconsistent,
                join(where, ": the joint has no ", what, "; expected a joint of kind ", of, "."));
}

template <class Real>
JointPose pose_of(const WorldState<Real>& world, BodyId id) {
    if (id == BodyId{}) return {};
    const std::size_t row = world.handles.row_of_slot(id.index);
    const Bodies<Real>& b = world.bodies;
    const double angle = b.has_rotation ? static_cast<double>(b.angle[row]) : 0;
    return {{b.position_x[row], b.position_y[row]}, rotation_by(angle), angle};
}

}  // namespace

template <class Real>
JointId BasicWorld<Real>::add(const Joint& joint) {
    constexpr std::string_view kWhere = "World::add";
    Implementation& own = *implementation_;
    raise_if(kWhere, find_joint_problem(kJoint, joint));
    bool moves[2] = {false, false};
    for (int end = 0; end < 2; ++end) {
        const std::optional<BodyId>& id = end == 0 ? joint.a : joint.b;
        if (!id) continue;
        const std::size_t row = own.row_of(*id, kWhere);
        moves[end] = !own.bodies().is_immovable(row);
    }
    if (const auto* gear = std::get_if<GearJoint>(&joint.kind); gear && gear->first) {
        for (const JointId coupled : {*gear->first, *gear->second}) {
            const StoredJoint& of = own.world().joints[own.world().joints.slot_of(coupled, kWhere)];
            if (of.is_exchanged || (of.type != JointType::revolute && of.type != JointType::prismatic &&
                                    of.type != JointType::wheel))
                refuse(kWhere, "coordinate that a gear could couple",
                       "revolute, prismatic or wheel with a body b for both ends of a gear");
        }
    } else {
        raise_if(kWhere, find_joint_mobility_problem(kJoint, moves[0], moves[1]));
    }
    if (own.world().joints.count() >= kLargestJointCount)
        throw Error(ErrorCode::too_large, join(kWhere, ": the world has ", own.world().joints.count(),
                                               " joints, which is the limit. Remove some first."));
    const StoredJoint stored = joint_of(own.world(), joint);
    if (stored.type == JointType::distance && stored.is_held && !(stored.length >= kShortestRod))
        throw Error(ErrorCode::out_of_range,
                    join(kWhere, ": the joint has no length and its ends are ", stored.length,
                         " m apart; expected at least ", kShortestRod,
                         " m. Give a length, move an anchor, or use a revolute joint."));
    SolverFacts facts = own.facts;
    facts.joined = "a joint that was added";
    SolverChoice choice{own.sim().solver(), own.called.solver_reason};
    if (own.asked_for == Solver::automatic && choice.solver != Solver::soft) choice = choose_solver(facts);
    raise_if(kWhere, find_joint_solver_problem(1, choice.solver));
    own.facts = std::move(facts);
    own.change_solver(choice.solver, choice.reason);
    if (turns_bodies(joint)) own.turn_rotation_on();
    own.world().effects.joints = true;
    own.report_on("joints", "a joint was added");
    for (const BodyId id : {stored.a, stored.b})
        if (id != BodyId{}) own.wake_around(own.row_of(id, kWhere));
    const JointId id = own.world().joints.add(stored);
    own.sim().forget_derived_state();
    return id;
}

template <class Real>
void BasicWorld<Real>::remove(JointId joint) {
    Implementation& own = *implementation_;
    const std::size_t slot = own.world().joints.slot_of(joint, "World::remove");
    own.wake_joint(slot);
    own.world().joints.remove(slot);
    own.sim().forget_derived_state();
}

template <class Real>
std::size_t BasicWorld<Real>::joint_count() const noexcept {
    return implementation_->sim().world.joints.count();
}

template <class Real>
bool BasicWorld<Real>::is_alive(JointId joint) const noexcept {
    return implementation_->sim().world.joints.is_alive(joint);
}

template <class Real>
void BasicWorld<Real>::set_motor(JointId joint, double speed, double most) {
    constexpr std::string_view kWhere = "World::set_motor";
    Implementation& own = *implementation_;
    const std::size_t slot = own.world().joints.slot_of(joint, kWhere);
    check_number(kWhere, "speed", speed, -kLargestSpeed, kLargestSpeed);
    check_number(kWhere, "most", most, 0, kNoLimit);
    StoredJoint& stored = own.world().joints[slot];
    if (stored.type == JointType::distance || stored.type == JointType::weld ||
        stored.type == JointType::target || stored.type == JointType::gear)
        refuse(kWhere, "motor", "revolute, prismatic or wheel");
    own.wake_joint(slot);
    stored.has_motor = most > 0, stored.motor_speed = stored.as_kept(speed), stored.max_motor = most;
    ++own.world().joints.version;
}

template <class Real>
void BasicWorld<Real>::set_limits(JointId joint, double lower, double upper) {
    constexpr std::string_view kWhere = "World::set_limits";
    Implementation& own = *implementation_;
    const std::size_t slot = own.world().joints.slot_of(joint, kWhere);
    StoredJoint& stored = own.world().joints[slot];
    if (stored.type != JointType::distance && stored.type != JointType::revolute &&
        stored.type != JointType::prismatic)
        refuse(kWhere, "limits", "distance, revolute or prismatic");
    const double most = stored.type == JointType::revolute ? kLargestAngle : kLargestPosition;
    check_number(kWhere, "lower", lower, stored.type == JointType::distance ? 0 : -most, most);
    check_number(kWhere, "upper", upper, lower, most);
    own.wake_joint(slot);
    stored.has_lower = stored.has_upper = true;
    stored.set_limits(lower, upper);
    if (stored.type == JointType::distance) stored.is_held = stored.is_spring();
    ++own.world().joints.version;
}

template <class Real>
void BasicWorld<Real>::set_target(JointId joint, Vec2 target) {
    constexpr std::string_view kWhere = "World::set_target";
    Implementation& own = *implementation_;
    const std::size_t slot = own.world().joints.slot_of(joint, kWhere);
    check_number(kWhere, "target x", target.x, -kLargestPosition, kLargestPosition);
    check_number(kWhere, "target y", target.y, -kLargestPosition, kLargestPosition);
    if (own.world().joints[slot].type != JointType::target) refuse(kWhere, "target", "target");
    own.wake_joint(slot);
    own.world().joints[slot].target = target;
}

template <class Real>
Vec2 BasicWorld<Real>::joint_force(JointId joint) const {
    const JointStore& joints = implementation_->sim().world.joints;
    return joints[joints.slot_of(joint, "World::joint_force")].force;
}

template <class Real>
double BasicWorld<Real>::joint_torque(JointId joint) const {
    const JointStore& joints = implementation_->sim().world.joints;
    return joints[joints.slot_of(joint, "World::joint_torque")].torque;
}

template <class Real>
std::array<Vec2, 2> BasicWorld<Real>::joint_anchors(JointId joint) const {
    const WorldState<Real>& world = implementation_->sim().world;
    const StoredJoint& stored = world.joints[world.joints.slot_of(joint, "World::joint_anchors")];
    const JointPose a = pose_of(world, stored.a), b = pose_of(world, stored.b);
    const Vec2 from =
        stored.type == JointType::target ? stored.target : a.position + rotate(a.turn, stored.anchor_a);
    const Vec2 to = b.position + rotate(b.turn, stored.anchor_b);
    if (stored.is_exchanged) return {to, from};
    return {from, to};
}

template <class Real>
JointErrors BasicWorld<Real>::joint_errors() const {
    const WorldState<Real>& world = implementation_->sim().world;
    JointErrors errors;
    double sum = 0;
    world.joints.for_each([&](std::size_t, const StoredJoint& joint) {
        const JointPose a = pose_of(world, joint.a), b = pose_of(world, joint.b);
        const JointRows rows = rows_of(joint, a, b);
        const double apart = std::sqrt(length_squared(b.position - a.position));
        double worst = 0;
        for (int k = 0; k < rows.count; ++k) {
            const JointRow& row = rows.row[static_cast<std::size_t>(k)];
            const double off = row.law == RowLaw::hold   ? std::fabs(row.value)
                               : row.law == RowLaw::stop ? std::fmax(-row.value, 0)
                                                         : 0;
            worst = std::fmax(worst, row.n == Vec2{} ? off * apart : off);
        }
        if (joint.type == JointType::gear) {
            const double off = gear_value(world.joints, joint, [&](BodyId id) { return pose_of(world, id); });
            worst = std::fabs(off) * std::fmax(apart, 0);
        }
        ++errors.joints;
        sum += worst, errors.max = std::fmax(errors.max, worst);
    });
    if (errors.joints > 0) errors.mean = sum / static_cast<double>(errors.joints);
    return errors;
}

template <class Real>
std::vector<JointId> BasicWorld<Real>::broken_joints() const {
    const WorldState<Real>& world = implementation_->sim().world;
    std::vector<JointId> broken;
    for (const JointBreak& each : world.joints.broken)
        if (each.time == world.time) broken.push_back(each.joint);  // others are kept events
    return broken;
}

// The class is instantiated in world.cpp, without what is defined here.
template JointId BasicWorld<float>::add(const Joint&);
template void BasicWorld<float>::remove(JointId);
template std::size_t BasicWorld<float>::joint_count() const noexcept;
template bool BasicWorld<float>::is_alive(JointId) const noexcept;
template void BasicWorld<float>::set_motor(JointId, double, double);
template void BasicWorld<float>::set_limits(JointId, double, double);
template void BasicWorld<float>::set_target(JointId, Vec2);
template Vec2 BasicWorld<float>::joint_force(JointId) const;
template double BasicWorld<float>::joint_torque(JointId) const;
template std::array<Vec2, 2> BasicWorld<float>::joint_anchors(JointId) const;
template JointErrors BasicWorld<float>::joint_errors() const;
template std::vector<JointId> BasicWorld<float>::broken_joints() const;
template JointId BasicWorld<double>::add(const Joint&);
template void BasicWorld<double>::remove(JointId);
template std::size_t BasicWorld<double>::joint_count() const noexcept;
template bool BasicWorld<double>::is_alive(JointId) const noexcept;
template void BasicWorld<double>::set_motor(JointId, double, double);
template void BasicWorld<double>::set_limits(JointId, double, double);
template void BasicWorld<double>::set_target(JointId, Vec2);
template Vec2 BasicWorld<double>::joint_force(JointId) const;
template double BasicWorld<double>::joint_torque(JointId) const;
template std::array<Vec2, 2> BasicWorld<double>::joint_anchors(JointId) const;
template JointErrors BasicWorld<double>::joint_errors() const;
template std::vector<JointId> BasicWorld<double>::broken_joints() const;

}  // namespace carom
