#include "torture/worlds/joints.hpp"

#include <cmath>

namespace carom::torture {
namespace {

struct Softness {
    double frequency = 0, damping_ratio = 0;  // Hz; 1: critical
};

Softness random_softness(const WorldTraits& traits, double chance, Random& random) {
    const Softness softness{random.log_uniform(0.2, 200),
                            random.chance(0.3) ? 0 : random.log_uniform(0.01, 3)};
    return traits.has_springs && random.chance(chance) ? softness : Softness{};
}

double random_motor_speed(Random& random) {
    return (random.chance(0.5) ? 1 : -1) * random.log_uniform(0.1, 30);  // rad/s, or units/s
}

double distance_of(const JointEnds& ends) {
    return std::hypot(ends.at_b.x - ends.at_a.x, ends.at_b.y - ends.at_a.y);
}

Vec2 middle_of(const JointEnds& ends) {
    return {0.5 * (ends.at_a.x + ends.at_b.x), 0.5 * (ends.at_a.y + ends.at_b.y)};
}

Joint joint_of(const JointEnds& ends, const JointKind& kind, const WorldTraits& traits, Random& random) {
    Joint joint{.a = ends.a, .b = ends.b, .kind = kind};
    joint.collide = random.chance(0.1);
    const double force = ends.force * random.log_uniform(0.1, 1e3);
    if (traits.can_break && random.chance(0.5)) joint.break_force = force;
    return joint;
}

DistanceJoint random_rod(const JointEnds& ends, const WorldTraits& traits, Random& random) {
    DistanceJoint rod;
    if (!ends.a) rod.anchor_a = ends.at_a;
    if (!ends.b) rod.anchor_b = ends.at_b;
    const double now = std::fmax(distance_of(ends), 0.1 * traits.unit);
    double length = now;
    if (traits.are_joints_stretched && random.chance(0.5)) length *= random.log_uniform(0.3, 3);
    const Softness softness = random_softness(traits, 0.4, random);
    rod.frequency = softness.frequency, rod.damping_ratio = softness.damping_ratio;
    const bool is_rope = softness.frequency == 0 && random.chance(0.4);
    if (!is_rope) rod.length = length;
    const double slack = random.chance(0.5) ? 1 : random.uniform(1, 1.5), play = random.uniform(0, 1);
    if (is_rope) rod.max = length * slack;
    if (is_rope && random.chance(0.2)) rod.min = *rod.max * play * 0.9;
    return rod;
}

RevoluteJoint random_hinge(double force, Vec2 anchor, const WorldTraits& traits, Random& random) {
    RevoluteJoint hinge{.anchor = anchor};
    const double lower = -random.uniform(0, 2), upper = random.uniform(0, 2);
    if (random.chance(0.4)) hinge.lower = lower, hinge.upper = upper;
    const Softness softness = random_softness(traits, 0.3, random);
    hinge.frequency = softness.frequency, hinge.damping_ratio = softness.damping_ratio;
    const double speed = random_motor_speed(random),
                 torque = force * traits.unit * random.log_uniform(0.1, 100);
    if (traits.has_motors && random.chance(0.3)) hinge.motor_speed = speed, hinge.max_motor_torque = torque;
    return hinge;
}

WeldJoint random_weld(Vec2 anchor, const WorldTraits& traits, Random& random) {
    const Softness softness = random_softness(traits, 0.5, random);
    return {anchor, softness.frequency, softness.damping_ratio};
}

PrismaticJoint random_slider(const JointEnds& ends, const WorldTraits& traits, Random& random) {
    const double angle = random.uniform(0, 7);
    PrismaticJoint slider{.axis = {std::cos(angle), std::sin(angle)}};
    const double lower = -traits.unit * random.uniform(0, 3), upper = traits.unit * random.uniform(0, 3);
    if (random.chance(0.5)) slider.lower = lower, slider.upper = upper;
    const Softness softness = random_softness(traits, 0.3, random);
    slider.frequency = softness.frequency, slider.damping_ratio = softness.damping_ratio;
    const double speed = traits.unit * random_motor_speed(random),
                 force = ends.force * random.log_uniform(0.1, 100);
    if (traits.has_motors && random.chance(0.4)) slider.motor_speed = speed, slider.max_motor_force = force;
    return slider;
}

TargetJoint random_target(const JointEnds& ends, const WorldTraits& traits, Random& random) {
    TargetJoint target;
    const double away = traits.unit * random.uniform(0, 2);
    target.target = {ends.at_b.x + away, ends.at_b.y};
    target.anchor = {0.3 * traits.unit * random.uniform(), 0};
    target.max_force = ends.force * random.log_uniform(0.1, 100);
    target.frequency = random.log_uniform(0.5, 50), target.damping_ratio = random.log_uniform(0.1, 2);
    return target;
}

}  // namespace

Joint random_link(const JointEnds& ends, const WorldTraits& traits, Random& random) {
    const double which = random.uniform();
    const Vec2 middle = middle_of(ends);
    if (which < 0.5) return joint_of(ends, random_hinge(ends.force, middle, traits, random), traits, random);
    if (which < 0.85) return joint_of(ends, random_rod(ends, traits, random), traits, random);
    return joint_of(ends, random_weld(middle, traits, random), traits, random);
}

Joint random_joint(const JointEnds& ends, const WorldTraits& traits, Random& random) {
    const double which = random.uniform();
    if (which < 0.5) return random_link(ends, traits, random);
    if (which < 0.75) return joint_of(ends, random_slider(ends, traits, random), traits, random);
    if (which < 0.9 || !traits.has_motors) return wheel_on(ends, traits, random);
    JointEnds alone = ends;
    alone.a.reset();
    return joint_of(alone, random_target(alone, traits, random), traits, random);
}

Joint hinge_at(const JointEnds& ends, Vec2 anchor, const WorldTraits& traits, Random& random) {
    return joint_of(ends, random_hinge(ends.force, anchor, traits, random), traits, random);
}

Joint wheel_on(const JointEnds& ends, const WorldTraits& traits, Random& random) {
    WheelJoint wheel;
    const Softness softness = random_softness(traits, 0.9, random);
    wheel.frequency = softness.frequency, wheel.damping_ratio = softness.damping_ratio;
    const double speed = random_motor_speed(random),
                 torque = ends.force * traits.unit * random.log_uniform(0.1, 100);
    if (traits.has_motors && random.chance(0.7)) wheel.motor_speed = speed, wheel.max_motor_torque = torque;
    return joint_of(ends, wheel, traits, random);
}

}  // namespace carom::torture
