// A joint of a body and the world counts the angle and the way of b against a, whichever of them the world
// is.
#include "support/joints.hpp"

#include <doctest/doctest.h>

#include <optional>
#include <type_traits>

namespace test_joints_to_the_world {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kSpeed = 0.5;        // s; m/s or rad/s
constexpr double kLower = -1, kUpper = 2, kMost = 100;  // m or rad; N or N m

struct Coordinate {
    double speed, value;  // of b against a
};

template <class Kind>
class Driven {
  public:
    Driven(const Kind& kind, bool is_world_a) : sign_(is_world_a ? 1 : -1) {
        Scene scene;
        body_ = scene.add(bob({3, 4}, 2));
        Joint joint{.kind = kind};
        (is_world_a ? joint.b : joint.a) = body_;
        joint_ = scene.add(joint);
        world_.emplace(scene);
    }
    World& world() { return *world_; }
    JointId joint() const { return joint_; }

    Coordinate after(int steps) {
        for (int i = 0; i < steps; ++i) world_->step(kStep);
        const BodyState state = world_->state(body_);
        if constexpr (std::is_same_v<Kind, RevoluteJoint>)
            return {sign_ * state.angular_velocity, sign_ * state.angle};
        return {sign_ * state.velocity.y, sign_ * (state.position.y - 4)};
    }

  private:
    double sign_;
    BodyId body_;
    JointId joint_;
    std::optional<World> world_;
};

RevoluteJoint driven(RevoluteJoint hinge, double speed) {
    hinge.motor_speed = speed, hinge.max_motor_torque = kMost;
    return hinge;
}
PrismaticJoint driven(PrismaticJoint slider, double speed) {
    slider.axis = {0, 1}, slider.motor_speed = speed, slider.max_motor_force = kMost;
    return slider;
}

}  // namespace

TEST_SUITE("world/joints to the world") {
    TEST_CASE_TEMPLATE("a motor drives b against a, as given in the scene and as set later", Kind,
                       RevoluteJoint, PrismaticJoint) {
        for (const bool is_world_a : {true, false}) {
            CAPTURE(is_world_a);
            Driven<Kind> it(driven(Kind{}, kSpeed), is_world_a);
            CHECK(it.after(60).speed == doctest::Approx(kSpeed).epsilon(1e-5));
            it.world().set_motor(it.joint(), -kSpeed, kMost);
            CHECK(it.after(60).speed == doctest::Approx(-kSpeed).epsilon(1e-5));
        }
    }

    TEST_CASE_TEMPLATE("limits stop b against a, as given in the scene and as set later", Kind, RevoluteJoint,
                       PrismaticJoint) {
        for (const bool is_world_a : {true, false})
            for (const bool is_upward : {true, false}) {
                CAPTURE(is_world_a);
                CAPTURE(is_upward);
                Kind kind = driven(Kind{}, is_upward ? kSpeed : -kSpeed);
                kind.lower = kLower, kind.upper = kUpper;
                Driven<Kind> it(kind, is_world_a);
                CHECK(it.after(600).value == doctest::Approx(is_upward ? kUpper : kLower).epsilon(1e-3));
                it.world().set_limits(it.joint(), kLower - 0.5, kUpper + 0.25);
                CHECK(it.after(300).value ==
                      doctest::Approx(is_upward ? kUpper + 0.25 : kLower - 0.5).epsilon(1e-3));
            }
    }

    TEST_CASE("a limit at one end alone is that end's, whichever is the world") {
        for (const bool is_world_a : {true, false}) {
            CAPTURE(is_world_a);
            PrismaticJoint slider = driven(PrismaticJoint{}, kSpeed);
            slider.lower = 0;
            Driven<PrismaticJoint> it(slider, is_world_a);
            CHECK(it.after(240).value == doctest::Approx(4 * kSpeed).epsilon(1e-2));
        }
    }

    TEST_CASE("anchors are told in the order in which the bodies were given") {
        for (const bool is_world_a : {true, false}) {
            CAPTURE(is_world_a);
            Scene scene;
            const BodyId body = scene.add(bob({3, 4}));
            Joint rod{.kind = DistanceJoint{.anchor_a = is_world_a ? Vec2{1, 4} : Vec2{},
                                            .anchor_b = is_world_a ? Vec2{} : Vec2{1, 4}}};
            (is_world_a ? rod.b : rod.a) = body;
            const JointId joint = scene.add(rod);
            const auto anchors = World(scene).joint_anchors(joint);
            CHECK(anchors[is_world_a ? 0 : 1] == Vec2{1, 4});
            CHECK(anchors[is_world_a ? 1 : 0] == Vec2{3, 4});
        }
    }
}

}  // namespace test_joints_to_the_world
