#include "torture/worlds/group.hpp"

#include <cmath>

#include "torture/worlds/bodies.hpp"

namespace carom::torture {
namespace {

/// A turn and a shift.
struct Frame {
    double cos, sin;
    Vec2 at;

    Vec2 direction(Vec2 v) const { return {cos * v.x - sin * v.y, sin * v.x + cos * v.y}; }
    Vec2 point(Vec2 p) const {
        const Vec2 turned = direction(p);
        return {at.x + turned.x, at.y + turned.y};
    }
};

/// Moves what a joint says of the world; points in frames of bodies stay.
struct MoveJoint {
    const Frame& frame;
    bool has_a, has_b;

    void move(std::optional<Vec2>& anchor) const {
        if (anchor) anchor = frame.point(*anchor);
    }
    void operator()(DistanceJoint& joint) const {
        if (!has_a) joint.anchor_a = frame.point(joint.anchor_a);
        if (!has_b) joint.anchor_b = frame.point(joint.anchor_b);
    }
    void operator()(RevoluteJoint& joint) const { move(joint.anchor); }
    void operator()(PrismaticJoint& joint) const {
        move(joint.anchor), joint.axis = frame.direction(joint.axis);
    }
    void operator()(WeldJoint& joint) const { move(joint.anchor); }
    void operator()(WheelJoint& joint) const { move(joint.anchor), joint.axis = frame.direction(joint.axis); }
    void operator()(TargetJoint& joint) const { joint.target = frame.point(joint.target); }
    void operator()(GearJoint&) const {}
};

double from_origin(const std::optional<Vec2>& anchor) {
    return anchor ? std::hypot(anchor->x, anchor->y) : 0;
}

/// m, from (0, 0) to the farthest point that a joint with the world holds there.
double reach_of_pins(const Joint& joint) {
    if (const auto* rod = std::get_if<DistanceJoint>(&joint.kind))
        return joint.a ? 0 : std::hypot(rod->anchor_a.x, rod->anchor_a.y);
    if (const auto* hinge = std::get_if<RevoluteJoint>(&joint.kind)) return from_origin(hinge->anchor);
    if (const auto* target = std::get_if<TargetJoint>(&joint.kind))
        return std::hypot(target->target.x, target->target.y);
    return 0;
}

std::optional<BodyId> behind(std::optional<BodyId> body, std::size_t bodies) {
    if (body) body->index += static_cast<std::uint32_t>(bodies);
    return body;
}

std::optional<JointId> behind(std::optional<JointId> joint, std::size_t joints) {
    if (joint) joint->index += static_cast<std::uint32_t>(joints);
    return joint;
}

}  // namespace

double reach_of(const Group& group) {
    double reach = 0;
    for (const Body& body : group.bodies)
        reach = std::fmax(reach, std::hypot(body.position.x, body.position.y) + reach_of(body));
    for (const Joint& joint : group.joints) reach = std::fmax(reach, reach_of_pins(joint));
    return reach;
}

Group placed(Group group, Vec2 at, double angle, Vec2 velocity) {
    const Frame frame{std::cos(angle), std::sin(angle), at};
    for (Body& body : group.bodies) {
        body.position = frame.point(body.position), body.angle += angle;
        if (body.type != BodyType::static_body)
            body.velocity = {body.velocity.x + velocity.x, body.velocity.y + velocity.y};
    }
    for (Joint& joint : group.joints)
        std::visit(MoveJoint{frame, joint.a.has_value(), joint.b.has_value()}, joint.kind);
    return group;
}

void add_to(Scene& scene, const Group& group) {
    const std::size_t bodies = scene.bodies.size(), joints = scene.joints.size();
    for (const Body& body : group.bodies) scene.add(body);
    for (Joint joint : group.joints) {
        joint.a = behind(joint.a, bodies), joint.b = behind(joint.b, bodies);
        if (auto* gear = std::get_if<GearJoint>(&joint.kind))
            gear->first = behind(gear->first, joints), gear->second = behind(gear->second, joints);
        scene.add(joint);
    }
}

}  // namespace carom::torture
