#include "world/joints.hpp"

#include <cmath>
#include <limits>

#include "constraints/joints/joint_laws.hpp"
#include "scene/validation/limits.hpp"
#include "scene/validation/validation.hpp"
#include "scene/validation/wording.hpp"
#include "world/implementation.hpp"
#include "world/set_up.hpp"

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
JointId WorldJoints<Real>::add(const Joint& joint) {
    constexpr std::string_view kWhere = "World::add";
    raise_if(kWhere, find_joint_problem(kJoint, joint));
    bool moves[2] = {false, false};
    for (int end = 0; end < 2; ++end) {
        const std::optional<BodyId>& id = end == 0 ? joint.a : joint.b;
        if (!id) continue;
        const std::size_t row = own_.row_of(*id, kWhere);
        moves[end] = !own_.bodies().is_immovable(row);
    }
    if (const auto* gear = std::get_if<GearJoint>(&joint.kind); gear && gear->first) {
        for (const JointId coupled : {*gear->first, *gear->second}) {
            const StoredJoint& of = own_.world().joints[own_.world().joints.slot_of(coupled, kWhere)];
            if (of.is_exchanged || (of.type != JointType::revolute && of.type != JointType::prismatic &&
                                    of.type != JointType::wheel))
                refuse(kWhere, "coordinate that a gear could couple",
                       "revolute, prismatic or wheel with a body b for both ends of a gear");
        }
    } else {
        raise_if(kWhere, find_joint_mobility_problem(kJoint, moves[0], moves[1]));
    }
    if (own_.world().joints.count() >= kLargestJointCount)
        throw Error(ErrorCode::too_large, join(kWhere, ": the world has ", own_.world().joints.count(),
                                               " joints, which is the limit. Remove some first."));
    const StoredJoint stored = joint_of(own_.world(), joint);
    if (stored.type == JointType::distance && stored.is_held && !(stored.length >= kShortestRod))
        throw Error(ErrorCode::out_of_range,
                    join(kWhere, ": the joint has no length and its ends are ", stored.length,
                         " m apart; expected at least ", kShortestRod,
                         " m. Give a length, move an anchor, or use a revolute joint."));
    SolverFacts facts = own_.facts;
    facts.joined = "a joint that was added";
    SolverChoice choice{own_.sim().solver(), own_.called.solver_reason};
    if (own_.asked_for == Solver::automatic && choice.solver != Solver::soft) choice = choose_solver(facts);
    raise_if(kWhere, find_joint_solver_problem(1, choice.solver));
    own_.facts = std::move(facts);
    own_.change_solver(choice.solver, choice.reason);
    if (turns_bodies(joint)) own_.turn_rotation_on();
    own_.world().effects.joints = true;
    own_.report_on("joints", "a joint was added");
    for (const BodyId id : {stored.a, stored.b})
        if (id != BodyId{}) own_.wake_around(own_.row_of(id, kWhere));
    const JointId id = own_.world().joints.add(stored);
    own_.sim().forget_derived_state();
    return id;
}

template <class Real>
void WorldJoints<Real>::remove(JointId joint) {
    const std::size_t slot = own_.world().joints.slot_of(joint, "World::remove");
    own_.wake_joint(slot);
    own_.world().joints.remove(slot);
    own_.sim().forget_derived_state();
}

template <class Real>
std::size_t WorldJoints<Real>::count() const {
    return own_.sim().world.joints.count();
}

template <class Real>
bool WorldJoints<Real>::is_alive(JointId joint) const {
    return own_.sim().world.joints.is_alive(joint);
}

template <class Real>
void WorldJoints<Real>::set_motor(JointId joint, double speed, double most) {
    constexpr std::string_view kWhere = "World::set_motor";
    const std::size_t slot = own_.world().joints.slot_of(joint, kWhere);
    check_number(kWhere, "speed", speed, -kLargestSpeed, kLargestSpeed);
    check_number(kWhere, "most", most, 0, kNoLimit);
    StoredJoint& stored = own_.world().joints[slot];
    if (stored.type == JointType::distance || stored.type == JointType::weld ||
        stored.type == JointType::target || stored.type == JointType::gear)
        refuse(kWhere, "motor", "revolute, prismatic or wheel");
    own_.wake_joint(slot);
    if (stored.has_motor != (most > 0)) ++own_.world().joints.version;
    ++own_.world().joints.settings;
    stored.has_motor = most > 0, stored.motor_speed = stored.as_kept(speed), stored.max_motor = most;
}

template <class Real>
void WorldJoints<Real>::set_limits(JointId joint, double lower, double upper) {
    constexpr std::string_view kWhere = "World::set_limits";
    const std::size_t slot = own_.world().joints.slot_of(joint, kWhere);
    const StoredJoint& stored = own_.world().joints[slot];
    if (stored.type != JointType::distance && stored.type != JointType::revolute &&
        stored.type != JointType::prismatic)
        refuse(kWhere, "limits", "distance, revolute or prismatic");
    const double most = stored.type == JointType::revolute ? kLargestAngle : kLargestPosition;
    check_number(kWhere, "lower", lower, stored.type == JointType::distance ? 0 : -most, most);
    check_number(kWhere, "upper", upper, lower, most);
    own_.wake_joint(slot);
    own_.world().joints.set_limits(slot, lower, upper);
}

template <class Real>
void WorldJoints<Real>::set_target(JointId joint, Vec2 target) {
    constexpr std::string_view kWhere = "World::set_target";
    const std::size_t slot = own_.world().joints.slot_of(joint, kWhere);
    check_number(kWhere, "target x", target.x, -kLargestPosition, kLargestPosition);
    check_number(kWhere, "target y", target.y, -kLargestPosition, kLargestPosition);
    if (own_.world().joints[slot].type != JointType::target) refuse(kWhere, "target", "target");
    own_.wake_joint(slot);
    own_.world().joints[slot].target = target;
}

template <class Real>
Vec2 WorldJoints<Real>::force(JointId joint) const {
    const JointStore& joints = own_.sim().world.joints;
    return joints[joints.slot_of(joint, "World::joint_force")].force;
}

template <class Real>
double WorldJoints<Real>::torque(JointId joint) const {
    const JointStore& joints = own_.sim().world.joints;
    return joints[joints.slot_of(joint, "World::joint_torque")].torque;
}

template <class Real>
std::array<Vec2, 2> WorldJoints<Real>::anchors(JointId joint) const {
    const WorldState<Real>& world = own_.sim().world;
    const StoredJoint& stored = world.joints[world.joints.slot_of(joint, "World::joint_anchors")];
    const JointPose a = pose_of(world, stored.a), b = pose_of(world, stored.b);
    const Vec2 from =
        stored.type == JointType::target ? stored.target : a.position + rotate(a.turn, stored.anchor_a);
    const Vec2 to = b.position + rotate(b.turn, stored.anchor_b);
    if (stored.is_exchanged) return {to, from};
    return {from, to};
}

template <class Real>
JointErrors WorldJoints<Real>::errors() const {
    const WorldState<Real>& world = own_.sim().world;
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
std::vector<JointId> WorldJoints<Real>::broken() const {
    const WorldState<Real>& world = own_.sim().world;
    std::vector<JointId> broken;
    for (const JointBreak& each : world.joints.broken)
        if (each.time == world.time) broken.push_back(each.joint);  // others are kept events
    return broken;
}

template class WorldJoints<float>;
template class WorldJoints<double>;

}  // namespace carom
