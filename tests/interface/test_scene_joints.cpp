// Joints of a scene file: what is read, and what is refused, where.
#include "interface/refused_scene.hpp"

#include <doctest/doctest.h>

#include <string>

namespace test_scene_joints {

using namespace carom;
using namespace carom::test;
using namespace carom::tool;

namespace {

std::string with_joints(const std::string& joints, const std::string& type = "dynamic") {
    return R"({"carom": 1, "bodies": [{"name": "ball", "type": ")" + type +
           R"(", "shape": {"disc": {"radius": 0.2}}}, {"shape": {"disc": {"radius": 0.2}}, "position": [1, 0]}],
           "joints": [)" +
           joints + "]}";
}

}  // namespace

TEST_SUITE("interface: joints") {
    TEST_CASE("every kind of joint is read with its keys") {
        const Scene scene = parse_scene(
            with_joints(
                R"({"distance": {"a": "ball", "b": 1, "anchor_b": [0, 0.1], "max": 2, "collide": true}},
                {"revolute": {"b": 0, "anchor": [0, 1], "lower": -1, "motor_speed": 2, "max_motor_torque": 3}},
                {"prismatic": {"a": null, "b": 0, "axis": [0, 1], "upper": 2}},
                {"weld": {"a": 0, "b": 1, "frequency": 3, "break_torque": 7}},
                {"wheel": {"a": 0, "b": 1, "damping_ratio": 0.5}},
                {"target": {"b": 1, "target": [3, 4], "max_force": 5}})"),
            "test.json");
        REQUIRE(scene.joints.size() == 6);
        const auto& rope = std::get<DistanceJoint>(scene.joints[0].kind);
        CHECK(scene.joints[0].a == BodyId{0, 0});
        CHECK(scene.joints[0].collide);
        CHECK(rope.max == 2.0);
        CHECK(rope.anchor_b == Vec2{0, 0.1});
        CHECK_FALSE(scene.joints[1].a.has_value());
        CHECK(std::get<RevoluteJoint>(scene.joints[1].kind).lower == -1.0);
        CHECK(std::get<PrismaticJoint>(scene.joints[2].kind).axis == Vec2{0, 1});
        CHECK(scene.joints[3].break_torque == 7);
        CHECK(std::get<WheelJoint>(scene.joints[4].kind).damping_ratio == 0.5);
        CHECK(std::get<TargetJoint>(scene.joints[5].kind).target == Vec2{3, 4});
    }

    TEST_CASE("a chain has a joint a body, a net two but for its edge, and its bodies do not touch") {
        const Scene chain = parse_scene(
            R"({"carom": 1, "generate": [{"chain": {"count": 5, "spacing": 0.5, "shape": {"disc": {"radius": 0.1}}}}]})",
            "test.json");
        CHECK(chain.joints.size() == 5);
        CHECK(chain.bodies[4].position.x == 2);
        const Scene net = parse_scene(
            R"({"carom": 1, "generate": [{"net": {"count": [4, 3], "spacing": 1, "shape": {"disc": {"radius": 0.1}}}}]})",
            "test.json");
        CHECK(net.joints.size() == 3 * 3 + 4 * 2);
        CHECK(net.bodies[8].type == BodyType::static_body);
        CHECK(net.bodies[9].type == BodyType::dynamic_body);
        CHECK(net.bodies[9].group < 0);
    }

    TEST_CASE("joints that cannot be are refused where they stand") {
        check_refused_scene(with_joints(R"({"revolute": {"a": 7}})"), ErrorCode::unknown_name,
                            "/joints/0/revolute/a", "body 7, but the file makes 2 bodies");
        check_refused_scene(with_joints(R"({"revolute": {"b": "arm"}})"), ErrorCode::unknown_name,
                            "/joints/0/revolute/b", "names no body");
        check_refused_scene(with_joints(R"({"revolute": {"b": 1, "lower": 1, "upper": 0}})"),
                            ErrorCode::inconsistent, "/joints/0/revolute/lower",
                            "joint 0 has lower 1 rad above its upper 0");
        check_refused_scene(with_joints(R"({"weld": {"b": 0}})", "static"), ErrorCode::inconsistent,
                            "/joints/0", "no dynamic body");
        check_refused_scene(with_joints(R"({"weld": {}})"), ErrorCode::missing, "/joints/0/weld", "no body");
        check_refused_scene(with_joints(R"({"weld": {"a": 1, "b": 1}})"), ErrorCode::inconsistent,
                            "/joints/0/weld/b", "body 1 as a and as b");
        check_refused_scene(with_joints(R"({"distance": {"b": 0}})"), ErrorCode::out_of_range,
                            "/joints/0/distance", "0 m apart");
        check_refused_scene(with_joints(R"({"target": {"b": 0, "target": [1, 1], "max_force": 0}})"),
                            ErrorCode::out_of_range, "/joints/0/target/max_force", "max_force 0 N");
        check_refused_scene(with_joints(R"({"prismatic": {"b": 0, "axis": [0, 0]}})"),
                            ErrorCode::out_of_range, "/joints/0/prismatic/axis", "expected a direction");
        check_refused_scene(with_joints(R"({"wheel": {"b": 0, "length": 1}})"), ErrorCode::unknown_name,
                            "/joints/0/wheel/length", "length");
    }
}

}  // namespace test_scene_joints
