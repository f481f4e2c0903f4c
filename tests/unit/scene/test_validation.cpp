#include <carom/scene.hpp>

#include "scene/validation/validation.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace test_validation {

using namespace carom;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A scene in which everything is set and nothing is wrong: body 1 is the one the cases below change.
Scene sound_scene() {
    Scene scene;
    scene.gravity = {0, -10};
    scene.drag = {0.1, 0.2};
    scene.walls = Walls{.min = {0, 0}, .max = {10, 8}, .material = {.restitution = 0.5}};
    scene.add({.name = "floor", .type = BodyType::static_body, .position = {5, -3}});
    scene.add({.name = "ball", .position = {2, 6}, .velocity = {3, 0}, .material = {.restitution = 0.8}});
    scene.add(
        {.type = BodyType::kinematic_body, .position = {5, 5}, .velocity = {1, 0}, .angular_velocity = 1});
    return scene;
}

struct Fault {
    std::string what;
    std::function<void(Scene&)> make;
    ErrorCode code;
    std::string pointer;
    std::string statement;  // a part of it
};

Fault of_ball(std::string what, const std::function<void(Body&)>& make, ErrorCode code,
              const std::string& pointer, std::string statement) {
    return {std::move(what), [make](Scene& scene) { make(scene.bodies[1]); }, code, "/bodies/1" + pointer,
            std::move(statement)};
}

void check_fault(const Fault& fault) {
    CAPTURE(fault.what);
    Scene scene = sound_scene();
    REQUIRE_FALSE(scene.find_problem().has_value());
    fault.make(scene);
    const auto found = scene.find_problem();
    REQUIRE(found.has_value());
    CAPTURE(found->statement);
    CHECK(found->code == fault.code);
    CHECK(found->pointer == fault.pointer);
    CHECK(found->statement.find(fault.statement) != std::string::npos);
    try {
        scene.validate();
        FAIL_CHECK("validate() accepts it");
    } catch (const Error& error) {
        CHECK(error.code() == fault.code);
        CHECK(std::string(error.what()) == "Scene: " + found->statement);
    }
}

const std::vector<Fault> kBodyFaults{
    of_ball(
        "zero radius", [](Body& b) { b.shape = Disc{0}; }, ErrorCode::out_of_range, "/shape/disc/radius",
        "body 1 (\"ball\") has radius 0 m; expected 1e-09 <= radius <= 1e+07 m."),
    of_ball(
        "negative radius", [](Body& b) { b.shape = Disc{-0.4}; }, ErrorCode::out_of_range,
        "/shape/disc/radius", "has radius -0.4 m"),
    of_ball(
        "denormal radius", [](Body& b) { b.shape = Disc{1e-310}; }, ErrorCode::out_of_range,
        "/shape/disc/radius", "has radius 1e-310 m"),
    of_ball(
        "radius without a number", [](Body& b) { b.shape = Disc{kNaN}; }, ErrorCode::not_finite,
        "/shape/disc/radius", "has radius nan m"),
    of_ball(
        "infinite radius", [](Body& b) { b.shape = Disc{kInfinity}; }, ErrorCode::not_finite,
        "/shape/disc/radius", "has radius inf m"),
    of_ball(
        "position x without a number", [](Body& b) { b.position.x = kNaN; }, ErrorCode::not_finite,
        "/position/0", "has position x nan m; expected -1e+08"),
    of_ball(
        "position too far", [](Body& b) { b.position.y = 2e8; }, ErrorCode::out_of_range, "/position/1",
        "has position y 2e+08 m"),
    of_ball(
        "infinite velocity", [](Body& b) { b.velocity.y = -kInfinity; }, ErrorCode::not_finite, "/velocity/1",
        "has velocity y -inf m/s"),
    of_ball(
        "velocity components within, speed beyond",
        [](Body& b) {
            b.velocity = {8e6, 8e6};
        },
        ErrorCode::out_of_range, "/velocity", "has speed 11313708"),
    of_ball(
        "angle without a number", [](Body& b) { b.angle = kNaN; }, ErrorCode::not_finite, "/angle",
        "has angle nan rad"),
    of_ball(
        "spin too fast", [](Body& b) { b.angular_velocity = 1e9; }, ErrorCode::out_of_range,
        "/angular_velocity", "has angular velocity 1e+09 rad/s"),
    of_ball(
        "zero mass", [](Body& b) { b.mass = 0; }, ErrorCode::out_of_range, "/mass", "has mass 0 kg"),
    of_ball(
        "negative mass", [](Body& b) { b.mass = -2; }, ErrorCode::out_of_range, "/mass", "has mass -2 kg"),
    of_ball(
        "denormal mass", [](Body& b) { b.mass = 1e-310; }, ErrorCode::out_of_range, "/mass",
        "has mass 1e-310"),
    of_ball(
        "infinite mass", [](Body& b) { b.mass = kInfinity; }, ErrorCode::not_finite, "/mass",
        "has mass inf kg; expected"),
    of_ball(
        "density that makes no mass",
        [](Body& b) {
            b.shape = Disc{1e-9};
            b.material.density = 1e-20;
        },
        ErrorCode::out_of_range, "/material/density", "mass (density times area) 3.14"),
    of_ball(
        "zero density", [](Body& b) { b.material.density = 0; }, ErrorCode::out_of_range, "/material/density",
        "has density 0 kg/m²"),
    of_ball(
        "restitution above one", [](Body& b) { b.material.restitution = 1.2; }, ErrorCode::out_of_range,
        "/material/restitution", "has restitution 1.2; expected 0 <= restitution <= 1."),
    of_ball(
        "restitution without a number", [](Body& b) { b.material.restitution = kNaN; }, ErrorCode::not_finite,
        "/material/restitution", "has restitution nan"),
    of_ball(
        "negative friction", [](Body& b) { b.material.friction = -0.1; }, ErrorCode::out_of_range,
        "/material/friction", "has friction -0.1"),
    of_ball(
        "friction without a number", [](Body& b) { b.material.friction = kNaN; }, ErrorCode::not_finite,
        "/material/friction", "has friction nan"),
    of_ball(
        "negative rolling resistance", [](Body& b) { b.material.rolling_resistance = -0.1; },
        ErrorCode::out_of_range, "/material/rolling_resistance", "has rolling resistance -0.1"),
    of_ball(
        "moving static body", [](Body& b) { b.type = BodyType::static_body; }, ErrorCode::inconsistent,
        "/velocity", "has velocity [3, 0] m/s but is static"),
    of_ball(
        "turning static body",
        [](Body& b) {
            b.type = BodyType::static_body;
            b.velocity = {};
            b.angular_velocity = 1;
        },
        ErrorCode::inconsistent, "/angular_velocity", "has angular velocity 1 rad/s but is static"),
    of_ball(
        "fixed rotation that turns",
        [](Body& b) {
            b.fixed_rotation = true;
            b.angular_velocity = 1;
        },
        ErrorCode::inconsistent, "/angular_velocity", "but fixed rotation"),
    of_ball(
        "color by name", [](Body& b) { b.color = "red"; }, ErrorCode::out_of_range, "/color",
        "has color \"red\"; expected \"#rrggbb\""),
    of_ball(
        "name twice", [](Body& b) { b.name = "floor"; }, ErrorCode::duplicate_name, "/name",
        "has name \"floor\", which body 0 has already"),
    of_ball(
        "name with control characters", [](Body& b) { b.name = "a\n\"b", b.mass = 0; },
        ErrorCode::out_of_range, "/mass", "body 1 (\"a\\x0a\\\"b\") has"),
    of_ball(
        "outside the right wall", [](Body& b) { b.position.x = 10.5; }, ErrorCode::out_of_range,
        "/position/0", "has position x 10.5 m, outside the right wall; expected 0 <= x <= 10 m."),
    of_ball(
        "below the floor", [](Body& b) { b.position.y = -0.01; }, ErrorCode::out_of_range, "/position/1",
        "outside the bottom wall"),
    of_ball(
        "too big for the walls", [](Body& b) { b.shape = Disc{4.5}; }, ErrorCode::inconsistent,
        "/shape/disc/radius", "has diameter 9 m but the bottom and top walls are 8 m apart"),
};

const std::vector<Fault> kSettingFaults{
    {"gravity without a number", [](Scene& s) { s.gravity.x = kNaN; }, ErrorCode::not_finite, "/gravity/0",
     "the scene has gravity x nan m/s²"},
    {"gravity too strong", [](Scene& s) { s.gravity.y = 1e8; }, ErrorCode::out_of_range, "/gravity/1",
     "has gravity y 1e+08 m/s²"},
    {"negative drag", [](Scene& s) { s.drag.linear = -1; }, ErrorCode::out_of_range, "/drag/linear",
     "has linear drag -1 1/s"},
    {"infinite drag", [](Scene& s) { s.drag.angular = kInfinity; }, ErrorCode::not_finite, "/drag/angular",
     "has angular drag inf 1/s"},
    {"inverted walls", [](Scene& s) { s.walls->max.x = -1; }, ErrorCode::inconsistent, "/walls/max",
     "the walls have max [-1, 8] m and min [0, 0] m; expected max > min"},
    {"walls without a number", [](Scene& s) { s.walls->min.y = kNaN; }, ErrorCode::not_finite, "/walls/min/1",
     "the walls have min y nan m"},
    {"walls that gain energy", [](Scene& s) { s.walls->material.restitution = 2; }, ErrorCode::out_of_range,
     "/walls/material/restitution", "the walls have restitution 2"},
    {"zero step", [](Scene& s) { s.step.dt = 0; }, ErrorCode::out_of_range, "/step/dt",
     "the step has dt 0 s"},
    {"negative step", [](Scene& s) { s.step.dt = -0.016; }, ErrorCode::out_of_range, "/step/dt",
     "dt -0.016 s"},
    {"endless step", [](Scene& s) { s.step.dt = kInfinity; }, ErrorCode::not_finite, "/step/dt", "dt inf s"},
    {"negative count", [](Scene& s) { s.step.count = -5; }, ErrorCode::out_of_range, "/step/count",
     "count -5;"},
    {"frames of no step", [](Scene& s) { s.record.every = 0; }, ErrorCode::out_of_range, "/record/every",
     "every 0"},
    {"negative trail", [](Scene& s) { s.record.trail = -1; }, ErrorCode::out_of_range, "/record/trail",
     "trail -1"},
    {"no substeps", [](Scene& s) { s.accuracy.substeps = 0; }, ErrorCode::out_of_range, "/accuracy/substeps",
     "has substeps 0; expected 1 <= substeps <= 1024."},
    {"iterations of impulse",
     [](Scene& s) { s.accuracy.solver = Solver::impulse, s.accuracy.iterations = 3; },
     ErrorCode::inconsistent, "/accuracy/iterations",
     "has iterations 3, but the solver \"impulse\" does no sweeps"},
    {"iterations of event", [](Scene& s) { s.accuracy.solver = Solver::event, s.accuracy.iterations = 2; },
     ErrorCode::inconsistent, "/accuracy/iterations", "Use \"soft\" or \"auto\""},
    {"iterations of pairwise",
     [](Scene& s) { s.accuracy.solver = Solver::pairwise, s.accuracy.iterations = 2; },
     ErrorCode::inconsistent, "/accuracy/iterations", "expected 1"},
    {"many iterations", [](Scene& s) { s.accuracy.iterations = 5000; }, ErrorCode::out_of_range,
     "/accuracy/iterations", "has iterations 5000"},
    {"solver rigid", [](Scene& s) { s.accuracy.solver = Solver::rigid; }, ErrorCode::not_built_yet,
     "/accuracy/solver", "solver \"rigid\", which is not built yet. Use \"auto\", \"impulse\""},
    {"friction that the solver has not",
     [](Scene& s) {
         s.accuracy.solver = Solver::impulse;
         s.gravity = {0, -2};
         s.bodies[1].material.friction = 0.5;
     },
     ErrorCode::inconsistent, "/bodies/1/material/friction",
     "friction 0.5 and gravity is [0, -2] m/s², but the solver \"impulse\" has friction in impacts alone, "
     "none "
     "where bodies rest; with gravity expected 0. Use \"soft\" or \"auto\""},
    {"rolling resistance that the solver has not",
     [](Scene& s) {
         s.accuracy.solver = Solver::impulse;
         s.bodies[1].material.rolling_resistance = 0.5;
     },
     ErrorCode::inconsistent, "/bodies/1/material/rolling_resistance",
     "rolling resistance 0.5, but the solver \"impulse\" has none. Use \"soft\" or \"auto\""},
    {"rolling resistance of the walls that the solver has not",
     [](Scene& s) {
         s.accuracy.solver = Solver::event;
         s.drag = {};
         s.walls->material.rolling_resistance = 0.5;
     },
     ErrorCode::inconsistent, "/walls/material/rolling_resistance",
     "rolling resistance 0.5, but the solver \"event\" has none"},
    {"rolling resistance forced on where the solver has it not",
     [](Scene& s) {
         s.accuracy.solver = Solver::impulse;
         s.effects.rolling_resistance = true;
     },
     ErrorCode::inconsistent, "/effects/rolling_resistance",
     "forced on, but the solver \"impulse\" does not have it. Use \"soft\""},
    {"rolling resistance forced off",
     [](Scene& s) {
         s.bodies[1].material.rolling_resistance = 0.5;
         s.effects.rolling_resistance = false;
     },
     ErrorCode::inconsistent, "/effects/rolling_resistance", "body 1 with rolling resistance 0.5"},
    {"rolling resistance without friction",
     [](Scene& s) { s.effects.friction = false, s.effects.rolling_resistance = true; },
     ErrorCode::inconsistent, "/effects/friction", "rolling_resistance forced on"},
    {"a piece with rolling resistance and rotation forced off",
     [](Scene& s) {
         s.bodies.erase(s.bodies.begin() + 1, s.bodies.end());
         s.bodies[0].shape = Compound{{{.shape = Disc{1}, .material = Material{.rolling_resistance = 0.2}}}};
         s.bodies[0].fixed_rotation = true;
         s.effects.rotation = false;
     },
     ErrorCode::inconsistent, "/effects/rotation", "body 0 with rolling resistance 0.2"},
    {"walls with rolling resistance and rotation forced off",
     [](Scene& s) {
         s.bodies.erase(s.bodies.begin() + 1, s.bodies.end());
         s.bodies[0].angle = s.bodies[0].angular_velocity = 0;
         s.walls->material.rolling_resistance = 0.1;
         s.effects.rotation = false;
     },
     ErrorCode::inconsistent, "/effects/rotation", "walls with rolling resistance 0.1"},
    {"walls with solver rattle", [](Scene& s) { s.accuracy.solver = Solver::rattle; },
     ErrorCode::inconsistent, "/walls", "walls, but the solver \"rattle\" has joints alone"},
    {"drag with solver event", [](Scene& s) { s.accuracy.solver = Solver::event; }, ErrorCode::inconsistent,
     "/drag/linear", "the solver \"event\" knows free flight only. Use \"auto\" or \"impulse\""},
    {"what rests at once with solver event",
     [](Scene& s) {
         s.accuracy.solver = Solver::event;
         s.drag = {};
         s.bodies[1].material.restitution = 0;
     },
     ErrorCode::inconsistent, "/bodies/1/material/restitution",
     "comes to rest at once; the solver \"event\""},
    {"sleep with a solver that never rests",
     [](Scene& s) {
         s.accuracy.solver = Solver::impulse;
         s.effects.sleep = true;
     },
     ErrorCode::inconsistent, "/effects/sleep",
     "the effect sleep forced on, but the solver \"impulse\" does not have it. Use \"soft\" or \"auto\""},
    {"not continuous", [](Scene& s) { s.effects.continuous = false; }, ErrorCode::inconsistent,
     "/effects/continuous", "looks ahead over the whole step"},
    {"gravity forced off", [](Scene& s) { s.effects.gravity = false; }, ErrorCode::inconsistent,
     "/effects/gravity", "the effect gravity forced off although it has gravity [0, -10] m/s²"},
    {"drag forced off", [](Scene& s) { s.effects.drag = false; }, ErrorCode::inconsistent, "/effects/drag",
     "drag 0.1 1/s (linear) and 0.2 1/s (angular)"},
    {"rotation forced off", [](Scene& s) { s.effects.rotation = false; }, ErrorCode::inconsistent,
     "/effects/rotation", "body 2 with angle 0 rad and angular velocity 1 rad/s"},
    {"restitution forced off", [](Scene& s) { s.effects.restitution = false; }, ErrorCode::inconsistent,
     "/effects/restitution", "walls with restitution 0.5"},
    {"restitution of a body forced off",
     [](Scene& s) {
         s.walls->material.restitution = 0;
         s.effects.restitution = false;
     },
     ErrorCode::inconsistent, "/effects/restitution", "body 1 with restitution 0.8"},
};

/// The code an act is refused with; `not_built_yet` stands for no refusal.
ErrorCode refusal(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& error) {
        return error.code();
    }
    return ErrorCode::not_built_yet;
}
constexpr ErrorCode kAccepted = ErrorCode::not_built_yet;

}  // namespace

TEST_SUITE("scene/validation") {
    TEST_CASE("every fault of a body is found, with its place and its value") {
        for (const Fault& fault : kBodyFaults) check_fault(fault);
    }

    TEST_CASE("every fault of a setting is found, with its place and its value") {
        for (const Fault& fault : kSettingFaults) check_fault(fault);
    }

    TEST_CASE("an empty scene is sound") {
        CHECK_FALSE(Scene{}.find_problem().has_value());
    }

    TEST_CASE("radii may differ ten million times but no more") {
        Scene scene;
        scene.add({.shape = Disc{1e-6}});
        scene.add({.shape = Disc{10}});
        CHECK_FALSE(scene.find_problem().has_value());
        scene.add({.shape = Disc{10.001}});
        const auto found = scene.find_problem();
        REQUIRE(found.has_value());
        CHECK(found->code == ErrorCode::out_of_range);
        CHECK(found->pointer == "/bodies/2/shape/disc/radius");
        CHECK(found->statement.find("body 0 has radius 1e-06 m") != std::string::npos);
    }

    TEST_CASE("a disc may reach over a wall, a static one may stand outside, an open side holds none") {
        Scene scene = sound_scene();
        scene.bodies[1].position = {0, 8};
        CHECK_FALSE(scene.find_problem().has_value());
        scene.bodies[1].position.y = 9;
        CHECK(scene.find_problem().has_value());
        scene.walls->top = false;
        CHECK_FALSE(scene.find_problem().has_value());
        scene.bodies[0].position = {-50, 50};
        CHECK_FALSE(scene.find_problem().has_value());
    }

    TEST_CASE("a body's handle is its index, and bodies without a name do not share one") {
        Scene scene;
        CHECK(scene.add(Body{}) == BodyId{0, 0});
        CHECK(scene.add(Body{}) == BodyId{1, 0});
        CHECK_FALSE(scene.find_problem().has_value());
    }

    TEST_CASE("of very many names the one that is there twice is found") {
        Scene scene;
        for (int i = 0; i < 20000; ++i) scene.add({.name = "body " + std::to_string(i)});
        CHECK_FALSE(scene.find_problem().has_value());
        scene.bodies[19999].name = "body 7";
        const auto found = scene.find_problem();
        REQUIRE(found.has_value());
        CHECK(found->pointer == "/bodies/19999/name");
        CHECK(found->statement.find("which body 7 has already") != std::string::npos);
    }

    TEST_CASE("a step's length is zero or between the limits") {
        const auto step = [](double dt) { return refusal([dt] { validate_dt(dt, "World::step"); }); };
        CHECK(step(0) == kAccepted);
        CHECK(step(1e-9) == kAccepted);
        CHECK(step(kLargestStep) == kAccepted);
        CHECK(step(-1e-9) == ErrorCode::out_of_range);
        CHECK(step(1e-310) == ErrorCode::out_of_range);
        CHECK(step(10.5) == ErrorCode::out_of_range);
        CHECK(step(kNaN) == ErrorCode::not_finite);
        CHECK(step(kInfinity) == ErrorCode::not_finite);
    }

    TEST_CASE("a message begins with who was asked") {
        try {
            validate_body({.shape = Disc{-1}}, "World::add");
            FAIL_CHECK("accepted");
        } catch (const Error& error) {
            CHECK(std::string(error.what()).starts_with("World::add: the body has radius -1 m; expected"));
        }
    }

    TEST_CASE("single values are held to the limits of a body's") {
        CHECK(refusal([] { validate_position({kNaN, 0}, "here"); }) == ErrorCode::not_finite);
        CHECK(refusal([] { validate_position({0, 2e8}, "here"); }) == ErrorCode::out_of_range);
        CHECK(refusal([] { validate_position({1, 2}, "here"); }) == kAccepted);
        CHECK(refusal([] { validate_velocity({8e6, 8e6}, "here"); }) == ErrorCode::out_of_range);
        CHECK(refusal([] { validate_velocity({8e6, 0}, "here"); }) == kAccepted);
        CHECK(refusal([] { validate_angular_velocity(kInfinity, "here"); }) == ErrorCode::not_finite);
        CHECK(refusal([] {
                  validate_inside({.position = {2, 0}}, Walls{.max = {1, 1}}, "here");
              }) == ErrorCode::out_of_range);
    }

    TEST_CASE("every solver has a name that finds it again") {
        for (const Solver solver : {Solver::automatic, Solver::pairwise, Solver::impulse, Solver::soft,
                                    Solver::rigid, Solver::event, Solver::rattle})
            CHECK(solver_named(name_of(solver)) == solver);
        CHECK(name_of(Solver::automatic) == "auto");
        CHECK_FALSE(solver_named("magic").has_value());
    }
}

}  // namespace test_validation
