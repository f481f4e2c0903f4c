#include "math/rotation.hpp"
#include "scene/validation/limits.hpp"
#include "scene/validation/validation.hpp"
#include "shapes/mass.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace carom {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::max();
constexpr Quantity kFrequency{"frequency", "Hz", 0, kLargestFrequency, "Give 0 for a rigid joint."};
constexpr Quantity kDampingRatio{"damping ratio", "", 0, kLargestDampingRatio, "1 is critical, 0 none."};
constexpr Quantity kRodLength{"length", "m", kShortestRod, kLargestPosition,
                              "Use a revolute joint to hold two points on each other."};
constexpr Quantity kLength{"length", "m", 0, kLargestPosition, kUseMetres};
constexpr Quantity kWay{"way", "m", -kLargestPosition, kLargestPosition, kUseMetres};
constexpr Quantity kMotorSpeed{"motor speed", "rad/s or m/s", -kLargestSpeed, kLargestSpeed,
                               "Give it in radians or metres a second."};
constexpr Quantity kMotorTorque{"torque", "N m", 0, kNoLimit, "Leave the motor out to have none."};
constexpr Quantity kMotorForce{"force", "N", 0, kNoLimit, "Leave the motor out to have none."};
constexpr Quantity kAnchorX{"anchor x", "m", -kLargestPosition, kLargestPosition, kUseMetres};
constexpr Quantity kAnchorY{"anchor y", "m", -kLargestPosition, kLargestPosition, kUseMetres};
constexpr Quantity kAxis{"axis", "", -kNoLimit, kNoLimit, "Give a direction."};

std::optional<Problem> check_point(const Item& item, std::string_view key, Vec2 point) {
    if (auto found = check(item, join(key, "/0"), point.x, kAnchorX)) return found;
    return check(item, join(key, "/1"), point.y, kAnchorY);
}

std::optional<Problem> check_spring(const Item& item, std::string_view kind, double frequency, double ratio) {
    if (auto found = check(item, join(kind, "/frequency"), frequency, kFrequency)) return found;
    return check(item, join(kind, "/damping_ratio"), ratio, kDampingRatio);
}

/// Two ends that a joint stays between.
struct Ends {
    std::string_view low_key, high_key;
    const std::optional<double>&low, &high;
    const Quantity& quantity;
};

std::optional<Problem> check_ends(const Item& item, std::string_view kind, const Ends& ends) {
    if (ends.low)
        if (auto found = check(item, join(kind, ends.low_key), *ends.low, ends.quantity)) return found;
    if (ends.high)
        if (auto found = check(item, join(kind, ends.high_key), *ends.high, ends.quantity)) return found;
    if (!ends.low || !ends.high || *ends.low <= *ends.high) return std::nullopt;
    return problem(ErrorCode::inconsistent, item, join(kind, ends.low_key), ends.low_key.substr(1), " ",
                   *ends.low, " ", ends.quantity.unit, " above its ", ends.high_key.substr(1), " ",
                   *ends.high, "; expected at most that. Exchange them.");
}

std::optional<Problem> check_motor(const Item& item, std::string_view kind,
                                   const std::optional<double>& speed, std::string_view most_key, double most,
                                   const Quantity& quantity) {
    if (speed)
        if (auto found = check(item, join(kind, "/motor_speed"), *speed, kMotorSpeed)) return found;
    return check(item, join(kind, most_key), most, quantity);
}

std::optional<Problem> check_axis(const Item& item, std::string_view kind, Vec2 axis) {
    if (auto found = check(item, join(kind, "/axis/0"), axis.x, kAxis)) return found;
    if (auto found = check(item, join(kind, "/axis/1"), axis.y, kAxis)) return found;
    const double squared = axis.x * axis.x + axis.y * axis.y;
    if (squared > 0 && squared < kNoLimit) return std::nullopt;
    return problem(ErrorCode::out_of_range, item, join(kind, "/axis"), "axis ", axis,
                   "; expected a direction. Give a vector that is not zero, such as [1, 0].");
}

struct FindProblem {
    const Item& item;

    std::optional<Problem> operator()(const DistanceJoint& kind) const {
        constexpr std::string_view kKind = "/distance";
        if (auto found = check_point(item, join(kKind, "/anchor_a"), kind.anchor_a)) return found;
        if (auto found = check_point(item, join(kKind, "/anchor_b"), kind.anchor_b)) return found;
        if (kind.length)
            if (auto found = check(item, join(kKind, "/length"), *kind.length, kRodLength)) return found;
        if (auto found = check_ends(item, kKind, {"/min", "/max", kind.min, kind.max, kLength})) return found;
        return check_spring(item, kKind, kind.frequency, kind.damping_ratio);
    }
    std::optional<Problem> operator()(const RevoluteJoint& kind) const {
        return check_anchored("/revolute", kind);
    }
    std::optional<Problem> operator()(const PrismaticJoint& kind) const {
        return check_anchored("/prismatic", kind);
    }
    std::optional<Problem> operator()(const WeldJoint& kind) const { return check_anchored("/weld", kind); }
    std::optional<Problem> operator()(const WheelJoint& kind) const { return check_anchored("/wheel", kind); }
    std::optional<Problem> operator()(const TargetJoint& kind) const {
        constexpr std::string_view kKind = "/target";
        static constexpr Quantity kForce{"max_force", "N", std::numeric_limits<double>::min(), kNoLimit,
                                         "It is the force of the drag."};
        static constexpr Quantity kOwnFrequency{"frequency", "Hz", 1e-6, kLargestFrequency,
                                                "Larger is stiffer; 5 is usual."};
        if (auto found = check_point(item, join(kKind, "/anchor"), kind.anchor)) return found;
        if (auto found = check_point(item, join(kKind, "/target"), kind.target)) return found;
        if (auto found = check(item, join(kKind, "/max_force"), kind.max_force, kForce)) return found;
        if (auto found = check(item, join(kKind, "/frequency"), kind.frequency, kOwnFrequency)) return found;
        return check(item, join(kKind, "/damping_ratio"), kind.damping_ratio, kDampingRatio);
    }

    std::optional<Problem> operator()(const GearJoint& kind) const {
        constexpr std::string_view kKind = "/gear";
        static constexpr Quantity kRatio{"ratio", "", -kLargestGearRatio, kLargestGearRatio,
                                         "It is the turn of the second over that of the first."};
        if (auto found = check(item, join(kKind, "/ratio"), kind.ratio, kRatio)) return found;
        if (std::fabs(kind.ratio) * kLargestGearRatio >= 1) return std::nullopt;
        return problem(ErrorCode::out_of_range, item, join(kKind, "/ratio"), "ratio ", kind.ratio,
                       "; expected at least ", 1 / kLargestGearRatio, " or at most ", -1 / kLargestGearRatio,
                       ". Exchange first and second for its inverse.");
    }

  private:
    /// A joint about a point of the world, with what it has of axis, limits, motor and spring.
    template <class Kind>
    std::optional<Problem> check_anchored(std::string_view key, const Kind& kind) const {
        if constexpr (requires { kind.axis; })
            if (auto found = check_axis(item, key, kind.axis)) return found;
        if (kind.anchor)
            if (auto found = check_point(item, join(key, "/anchor"), *kind.anchor)) return found;
        if constexpr (requires { kind.lower; }) {
            const Quantity& quantity = requires {
                kind.axis;
            }
            ? kWay : kAngle;
            if (auto found = check_ends(item, key, {"/lower", "/upper", kind.lower, kind.upper, quantity}))
                return found;
        }
        if constexpr (requires { kind.max_motor_torque; })
            if (auto found = check_motor(item, key, kind.motor_speed, "/max_motor_torque",
                                         kind.max_motor_torque, kMotorTorque))
                return found;
        if constexpr (requires { kind.max_motor_force; })
            if (auto found = check_motor(item, key, kind.motor_speed, "/max_motor_force",
                                         kind.max_motor_force, kMotorForce))
                return found;
        return check_spring(item, key, kind.frequency, kind.damping_ratio);
    }
};

std::string_view key_of(const Joint& joint) {
    static constexpr std::string_view kKeys[] = {"/distance", "/revolute", "/prismatic", "/weld",
                                                 "/wheel",    "/target",   "/gear"};
    return kKeys[joint.kind.index()];
}

/// Two points that a rod without a length of its own holds where they are must not be one.
std::optional<Problem> find_length_problem(const Item& item, const Joint& joint, const Scene& scene) {
    const auto* rod = std::get_if<DistanceJoint>(&joint.kind);
    if (!rod || rod->length || ((rod->min || rod->max) && rod->frequency == 0)) return std::nullopt;
    const auto end = [&](const std::optional<BodyId>& id, Vec2 anchor) {
        if (!id) return anchor;
        const Body& body = scene.bodies[id->index];
        const Vec2 turned = rotate(rotation_by(body.angle), anchor);
        return Vec2{body.position.x + turned.x, body.position.y + turned.y};
    };
    const Vec2 a = end(joint.a, rod->anchor_a), b = end(joint.b, rod->anchor_b);
    const double length = std::sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
    if (length >= kShortestRod) return std::nullopt;
    return problem(ErrorCode::out_of_range, item, "/distance", "no length and its ends are ", length,
                   " m apart; expected at least ", kShortestRod,
                   " m. Give a length, move an anchor, or use a revolute joint.");
}

}  // namespace

std::optional<Problem> find_joint_problem(const Item& item, const Joint& joint) {
    const auto* gear = std::get_if<GearJoint>(&joint.kind);
    if (gear && gear->first.has_value() != gear->second.has_value())
        return problem(ErrorCode::missing, item, gear->first ? "/gear/second" : "/gear/first",
                       "one joint that it couples; expected two, \"first\" and \"second\", or two bodies.");
    const bool is_of_joints = gear && gear->first;
    if (is_of_joints && (joint.a || joint.b))
        return problem(ErrorCode::inconsistent, item, "/gear/first",
                       "joints and bodies to couple; expected one of both. Leave \"a\" and \"b\" out.");
    if (is_of_joints && *gear->first == *gear->second)
        return problem(ErrorCode::inconsistent, item, "/gear/second", "joint ", gear->second->index,
                       " as first and as second; expected two joints.");
    if (gear && !is_of_joints && (!joint.a || !joint.b))
        return problem(
            ErrorCode::missing, item, joint.a ? "/gear/b" : "/gear/a",
            "no two bodies to couple; expected \"a\" and \"b\", or two joints \"first\" and \"second\".");
    if (!is_of_joints && !joint.a && !joint.b)
        return problem(ErrorCode::missing, item, key_of(joint),
                       "no body; expected one at \"a\" or \"b\" at least, and null for the world.");
    if (joint.a && joint.b && joint.a->index == joint.b->index)
        return problem(ErrorCode::inconsistent, item, join(key_of(joint), "/b"), "body ", joint.b->index,
                       " as a and as b; expected two bodies, or null for the world.");
    if (std::holds_alternative<TargetJoint>(joint.kind) && (joint.a || !joint.b))
        return problem(ErrorCode::inconsistent, item, join(key_of(joint), "/b"),
                       "a target for other than one body b; expected b alone. Leave \"a\" out.");
    static constexpr Quantity kBreak{"limit", "", 0, std::numeric_limits<double>::infinity(),
                                     "Leave it out for a joint that does not break."};
    if (!(joint.break_force >= 0)) return check(item, "/break_force", joint.break_force, kBreak);
    if (!(joint.break_torque >= 0)) return check(item, "/break_torque", joint.break_torque, kBreak);
    return std::visit(FindProblem{item}, joint.kind);
}

std::optional<Problem> find_joint_mobility_problem(const Item& item, bool moves_a, bool moves_b) {
    if (moves_a || moves_b) return std::nullopt;
    return problem(
        ErrorCode::inconsistent, item, "",
        "no dynamic body: nothing that it could move; expected one at a or b at least. Make one of "
        "them dynamic.");
}

/// The joints that a gear couples: listed before it, with a coordinate.
std::optional<Problem> find_gear_problem(const Item& item, const GearJoint& gear, const Scene& scene) {
    const auto own = static_cast<std::size_t>(item.index);
    for (const auto& [key, id] :
         {std::pair{"/gear/first", *gear.first}, std::pair{"/gear/second", *gear.second}}) {
        if (id.index >= own || id.generation != 0)
            return problem(
                ErrorCode::unknown_name, item, key, "joint ", id.index,
                ", which does not come before it; expected a joint that is listed above the gear.");
        const Joint& coupled = scene.joints[id.index];
        const bool has_coordinate = std::holds_alternative<RevoluteJoint>(coupled.kind) ||
                                    std::holds_alternative<PrismaticJoint>(coupled.kind) ||
                                    std::holds_alternative<WheelJoint>(coupled.kind);
        if (has_coordinate && coupled.b) continue;
        return problem(
            ErrorCode::inconsistent, item, key, "joint ", id.index,
            ", which it cannot couple; expected a revolute, prismatic or wheel joint with a body b.");
    }
    return std::nullopt;
}

bool turns_bodies(const Joint& joint) {
    if (const auto* target = std::get_if<TargetJoint>(&joint.kind)) return target->anchor != Vec2{};
    const auto* rod = std::get_if<DistanceJoint>(&joint.kind);
    if (!rod) return true;
    return (joint.a && rod->anchor_a != Vec2{}) || (joint.b && rod->anchor_b != Vec2{});
}

std::optional<Problem> find_joint_bodies_problem(const Item& item, const Joint& joint, const Scene& scene) {
    if (const auto* gear = std::get_if<GearJoint>(&joint.kind); gear && gear->first)
        return find_gear_problem(item, *gear, scene);
    bool moves[2] = {false, false};
    for (int end = 0; end < 2; ++end) {
        const std::optional<BodyId>& id = end == 0 ? joint.a : joint.b;
        if (!id) continue;
        if (id->index >= scene.bodies.size() || id->generation != 0)
            return problem(ErrorCode::unknown_name, item, join(key_of(joint), end == 0 ? "/a" : "/b"),
                           "body ", id->index, " but the scene has ", scene.bodies.size(),
                           " bodies; expected a handle that Scene::add returned, 0 to the last.");
        moves[end] = scene.bodies[id->index].type == BodyType::dynamic_body;
    }
    if (auto found = find_joint_mobility_problem(item, moves[0], moves[1])) return found;
    return find_length_problem(item, joint, scene);
}

}  // namespace carom
