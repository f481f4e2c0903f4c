#include "scene_file/parts.hpp"

#include <array>

namespace carom::tool {
namespace {

constexpr std::array<std::string_view, 7> kJointKinds{"distance", "revolute", "prismatic", "weld",
                                                      "wheel",    "target",   "gear"};

/// A body by index or by name; null is the world.
std::optional<BodyId> read_reference(const Node& joint, std::string_view key, const Scene& scene) {
    const auto reference = joint.find(key);
    if (!reference || reference->json().is_null()) return std::nullopt;
    if (reference->json().is_string()) {
        const std::string& name = reference->text();
        for (std::size_t i = 0; i < scene.bodies.size() && !name.empty(); ++i)
            if (scene.bodies[i].name == name) return BodyId{static_cast<std::uint32_t>(i), 0};
        reference->fail(
            ErrorCode::unknown_name,
            short_text(reference->json()) +
                " names no body of this file; expected the name or the index of one, or null for the "
                "world.");
    }
    const std::int64_t index = reference->integer();
    if (index < 0 || static_cast<std::uint64_t>(index) >= scene.bodies.size())
        reference->fail(ErrorCode::unknown_name,
                        "body " + std::to_string(index) + ", but the file makes " +
                            std::to_string(scene.bodies.size()) +
                            " bodies; expected 0 to the last, or null for the world.");
    return BodyId{static_cast<std::uint32_t>(index), 0};
}

void read_optional(const Node& node, std::string_view key, std::optional<double>& into) {
    if (const auto value = node.find(key)) into = value->number();
}
void read_optional(const Node& node, std::string_view key, std::optional<Vec2>& into) {
    if (const auto value = node.find(key)) into = value->vec2();
}

/// A kind of joint, key by key as it has them.
template <class Kind>
Kind read_keys(const Node& node) {
    Kind kind;
    if constexpr (requires { kind.anchor_a; }) node.read("anchor_a", kind.anchor_a);
    if constexpr (requires { kind.anchor_b; }) node.read("anchor_b", kind.anchor_b);
    if constexpr (requires { kind.axis; }) node.read("axis", kind.axis);
    if constexpr (requires { kind.anchor.value(); }) read_optional(node, "anchor", kind.anchor);
    if constexpr (requires { kind.anchor.x; }) node.read("anchor", kind.anchor);
    if constexpr (requires { kind.length; }) read_optional(node, "length", kind.length);
    if constexpr (requires { kind.min; }) read_optional(node, "min", kind.min);
    if constexpr (requires { kind.max; }) read_optional(node, "max", kind.max);
    if constexpr (requires { kind.lower; }) read_optional(node, "lower", kind.lower);
    if constexpr (requires { kind.upper; }) read_optional(node, "upper", kind.upper);
    if constexpr (requires { kind.motor_speed; }) read_optional(node, "motor_speed", kind.motor_speed);
    if constexpr (requires { kind.max_motor_torque; }) node.read("max_motor_torque", kind.max_motor_torque);
    if constexpr (requires { kind.max_motor_force; }) node.read("max_motor_force", kind.max_motor_force);
    if constexpr (requires { kind.target; }) kind.target = node.at("target").vec2();
    if constexpr (requires { kind.max_force; }) kind.max_force = node.at("max_force").number();
    if constexpr (requires { kind.frequency; }) node.read("frequency", kind.frequency);
    if constexpr (requires { kind.damping_ratio; }) node.read("damping_ratio", kind.damping_ratio);
    return kind;
}

GearJoint read_gear(const Node& node) {
    GearJoint kind;
    for (const auto& [key, into] : {std::pair{"first", &kind.first}, std::pair{"second", &kind.second}})
        if (const auto number = node.find(key)) {
            const std::int64_t index = number->integer();
            if (index < 0 || index > std::int64_t{UINT32_MAX})
                number->fail(ErrorCode::unknown_name, "joint " + std::to_string(index) +
                                                          "; expected the index of a joint that is listed "
                                                          "above the gear.");
            *into = JointId::of(static_cast<std::uint32_t>(index));
        }
    kind.ratio = node.at("ratio").number();
    return kind;
}

/// The keys of each kind, after those that all have.
Node::Names keys_of(std::string_view kind) {
    static constexpr std::array<std::string_view, 12> kDistance{
        "a",        "b",      "collide", "break_force", "break_torque", "anchor_a",
        "anchor_b", "length", "min",     "max",         "frequency",    "damping_ratio"};
    static constexpr std::array<std::string_view, 12> kRevolute{
        "a",     "b",     "collide",     "break_force",      "break_torque", "anchor",
        "lower", "upper", "motor_speed", "max_motor_torque", "frequency",    "damping_ratio"};
    static constexpr std::array<std::string_view, 13> kPrismatic{
        "a",     "b",     "collide",     "break_force",     "break_torque", "anchor",       "axis",
        "lower", "upper", "motor_speed", "max_motor_force", "frequency",    "damping_ratio"};
    static constexpr std::array<std::string_view, 8> kWeld{
        "a", "b", "collide", "break_force", "break_torque", "anchor", "frequency", "damping_ratio"};
    static constexpr std::array<std::string_view, 11> kWheel{
        "a",    "b",           "collide",          "break_force", "break_torque", "anchor",
        "axis", "motor_speed", "max_motor_torque", "frequency",   "damping_ratio"};
    static constexpr std::array<std::string_view, 10> kTarget{
        "a",      "b",      "collide",   "break_force", "break_torque",
        "anchor", "target", "max_force", "frequency",   "damping_ratio"};
    if (kind == "distance") return kDistance;
    if (kind == "revolute") return kRevolute;
    if (kind == "prismatic") return kPrismatic;
    if (kind == "weld") return kWeld;
    static constexpr std::array<std::string_view, 8> kGear{
        "a", "b", "collide", "break_force", "break_torque", "first", "second", "ratio"};
    if (kind == "wheel") return kWheel;
    return kind == "gear" ? Node::Names(kGear) : Node::Names(kTarget);
}

JointKind read_kind(const Node& node) {
    const std::string_view kind = node.key();
    node.expect_keys(keys_of(kind));
    if (kind == "distance") return read_keys<DistanceJoint>(node);
    if (kind == "revolute") return read_keys<RevoluteJoint>(node);
    if (kind == "prismatic") return read_keys<PrismaticJoint>(node);
    if (kind == "weld") return read_keys<WeldJoint>(node);
    if (kind == "wheel") return read_keys<WheelJoint>(node);
    if (kind == "gear") return read_gear(node);
    return read_keys<TargetJoint>(node);
}

Joint read_joint(const Node& entry, const Scene& scene) {
    const Node node = entry.only_member(kJointKinds, "kind of joint");
    Joint joint;
    joint.kind = read_kind(node);
    joint.a = read_reference(node, "a", scene), joint.b = read_reference(node, "b", scene);
    node.read("collide", joint.collide);
    node.read("break_force", joint.break_force), node.read("break_torque", joint.break_torque);
    return joint;
}

}  // namespace

JointKind read_link(const Node& node) {
    if (!node.json().is_string()) return read_kind(node.only_member(kJointKinds, "kind of joint"));
    static constexpr std::array<std::string_view, 3> kLinks{"distance", "revolute", "weld"};
    switch (node.one_of(kLinks, "kind of link")) {
        case 0:
            return DistanceJoint{};
        case 1:
            return RevoluteJoint{};
        default:
            return WeldJoint{};
    }
}

void read_joints(const Node& root, Scene& scene) {
    const auto joints = root.find("joints");
    if (!joints) return;
    joints->expect_array("joints");
    std::vector<Joint> listed;
    for (std::size_t i = 0; i < joints->size(); ++i) listed.push_back(read_joint((*joints)[i], scene));
    scene.joints.insert(scene.joints.begin(), listed.begin(), listed.end());
}

}  // namespace carom::tool
