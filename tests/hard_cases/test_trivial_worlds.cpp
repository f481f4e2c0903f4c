// B23 of docs/hard-cases.md: worlds with nothing to do work, and do nothing.
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

namespace test_trivial_worlds {

using namespace carom;
using namespace carom::test;

namespace {

std::vector<std::string> stages_run(const Profile& profile) {
    std::vector<std::string> names;
    for (const StageTime& stage : profile.stages) names.emplace_back(stage.name);
    return names;
}

/// Those that the scene calls for: debug builds keep and check books in every world that steps.
std::vector<std::string> stages_called_for(const Profile& profile) {
    std::vector<std::string> names = stages_run(profile);
#ifndef NDEBUG
    std::erase_if(names,
                  [](const std::string& name) { return name == "keep_books" || name == "check_energy"; });
#endif
    return names;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

TEST_SUITE("hard cases/trivial worlds") {
    TEST_CASE_TEMPLATE("an empty world steps and answers every question", Real, float, double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.walls = floor_at(0);
        Trial<Real> trial(scene);
        trial.run(10, 0.1);
        CHECK(trial.world.time() == doctest::Approx(1));
        CHECK(trial.world.body_count() == 0);
        CHECK(trial.world.bodies().count == 0);
        CHECK(trial.world.bodies().position_x.empty());
        CHECK(trial.world.overlaps().touching == 0);
        CHECK(trial.world.ledger().energy.total() == 0);
        CHECK(trial.world.profile().steps == 10);
        CHECK(stages_run(trial.world.profile()).empty());
        CHECK(trial.world.plan().stages.empty());
        trial.check();
    }

    TEST_CASE_TEMPLATE("a world of static bodies runs no stage", Real, float, double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.drag.linear = 1;
        for (int i = 0; i < 100; ++i) {
            Body body = disc(0.5, 1, {0.3 * i, 0});  // they overlap, too
            body.type = BodyType::static_body;
            scene.add(body);
        }
        Trial<Real> trial(scene);
        const std::uint64_t before = trial.world.state_hash();
        trial.run(60, 1.0 / 60);
        CHECK(trial.world.state_hash() == before);
        CHECK(stages_run(trial.world.profile()).empty());
        CHECK(trial.world.profile().impacts == 0);
        trial.check();
    }

    TEST_CASE_TEMPLATE("a single body without walls runs no stage that looks for contacts", Real, float,
                       double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.add(disc(0.5, 1, {0, 0}, {1, 0}));
        Trial<Real> trial(scene);
        trial.run(60, 1.0 / 60);
        CHECK(trial.state(0).position.x == doctest::Approx(1));
        CHECK(trial.state(0).position.y == doctest::Approx(-5));
        const auto names = stages_called_for(trial.world.profile());
        CHECK(names.size() == 2);
        CHECK(has(names, "begin_flight"));
        CHECK(has(names, "end_flight"));
        trial.check();
    }

    TEST_CASE_TEMPLATE("a single body between walls bounces", Real, float, double) {
        Scene scene;
        scene.accuracy.solver = Solver::impulse;
        scene.walls = Walls{.min = {-1, -1}, .max = {1, 1}, .material = bouncy(1)};
        scene.add(disc(0.5, 1, {0, 0}, {1, 0}));
        Trial<Real> trial(scene);
        trial.run(120, 1.0 / 60);  // over to one wall and the other, and back: 2 m at 1 m/s
        CHECK(trial.state(0).position.x == doctest::Approx(0).epsilon(1e-5));
        CHECK(trial.state(0).velocity.x == 1);
        CHECK(trial.world.profile().wall_impacts == 2);
        trial.check();
    }

    TEST_CASE_TEMPLATE("a stage that a scene does not call for is absent from the plan", Real, float,
                       double) {
        Scene scene = gas_scene({.count = 20});
        scene.accuracy.solver = Solver::impulse;
        BasicWorld<Real> world(scene);
        world.step(1.0 / 60);
        const auto names = stages_called_for(world.profile());
        CHECK(!has(names, "keep_books"));
        CHECK(!has(names, "advance_rotation"));
        CHECK(world.bodies().angle.empty());
        CHECK(world.bodies().angular_velocity.empty());
        const Plan plan = world.plan();
        for (const ColumnReport& column : plan.columns) {
            CHECK(column.name != "angle");
            CHECK(column.name != "mass");
            CHECK(column.name != "radius");
            CHECK(column.name != "restitution");
            CHECK(column.name != "flags");
        }
    }

    TEST_CASE_TEMPLATE("kinematic bodies alone move at their velocity, through each other", Real, float,
                       double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.drag = {2, 2};
        Body body = disc(0.5, 1, {-1, 0}, {1, 0});
        body.type = BodyType::kinematic_body;
        body.angular_velocity = 3;
        scene.add(body);
        body.position = {1, 0}, body.velocity = {-1, 0};
        scene.add(body);
        Trial<Real> trial(scene);
        trial.run(120, 1.0 / 60);
        CHECK(trial.state(0).position.x == doctest::Approx(1));
        CHECK(trial.state(0).position.y == 0);
        CHECK(trial.state(1).position.x == doctest::Approx(-1));
        CHECK(trial.state(0).velocity.x == 1);
        CHECK(trial.state(0).angular_velocity == 3);
        CHECK(trial.world.profile().impacts == 0);
        trial.check();
    }
}

}  // namespace test_trivial_worlds
