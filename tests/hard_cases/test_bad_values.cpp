// B21 and B19 of docs/hard-cases.md, at the door of a running world: what is out of range, a restitution
// above 1 among it, is refused with a message that says where and what, and the world goes on as if nothing
// had been asked. (What scenes refuse: unit/scene.)
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace test_bad_values {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDenormal = std::numeric_limits<double>::denorm_min();

template <class Real>
struct Attempt {
    std::string what;
    std::string where;  // the message starts with it
    ErrorCode code;
    std::function<void(BasicWorld<Real>&)> call;
};

template <class Real>
std::vector<Attempt<Real>> attempts() {
    using World = BasicWorld<Real>;
    std::vector<Attempt<Real>> all;
    const auto code_of = [](double value) {
        return std::isfinite(value) ? ErrorCode::out_of_range : ErrorCode::not_finite;
    };
    for (const double dt : {kNaN, kInfinity, -kInfinity, -kStep, -kDenormal, kDenormal, 1e-300, 10.5, 1e30})
        all.push_back({"step", "World::step", code_of(dt), [dt](World& w) { w.step(dt); }});
    for (const double bad : {kNaN, kInfinity, -kInfinity, 1e9, -1e9}) {
        const ErrorCode code = code_of(bad);
        all.push_back({"position x", "World::set_position", code, [bad](World& w) {
                           w.set_position({1, 0}, {bad, 0});
                       }});
        all.push_back({"position y", "World::set_position", code, [bad](World& w) {
                           w.set_position({1, 0}, {0, bad});
                       }});
        all.push_back({"velocity x", "World::set_velocity", code, [bad](World& w) {
                           w.set_velocity({1, 0}, {bad, 0});
                       }});
        all.push_back({"velocity y", "World::set_velocity", code, [bad](World& w) {
                           w.set_velocity({1, 0}, {0, bad});
                       }});
        all.push_back({"spin", "World::set_angular_velocity", code, [bad](World& w) {
                           w.set_angular_velocity({1, 0}, bad);
                       }});
    }
    const auto add = [&](const char* what, double value, ErrorCode code, auto change) {
        Body body = disc(0.2, 1, {0, 0});
        change(body, value);
        all.push_back({what, "World::add", code, [body](World& w) { w.add(body); }});
    };
    for (const double bad : {kNaN, kInfinity, -kInfinity, 0.0, -1.0, kDenormal, 1e-31, 1e31}) {
        add("radius", bad, code_of(bad), [](Body& b, double v) { b.shape = Disc{v}; });
        add("mass", bad, code_of(bad), [](Body& b, double v) { b.mass = v; });
        add("density", bad, code_of(bad), [](Body& b, double v) { b.mass.reset(), b.material.density = v; });
    }
    for (const double bad : {kNaN, kInfinity, -0.1, 1.0000001, -kDenormal})
        add("restitution", bad, code_of(bad), [](Body& b, double v) { b.material.restitution = v; });
    for (const double bad : {kNaN, kInfinity, -0.1})
        add("friction", bad, code_of(bad), [](Body& b, double v) { b.material.friction = v; });
    add("friction", 0.5, ErrorCode::inconsistent, [](Body& b, double v) { b.material.friction = v; });
    for (const double bad : {kNaN, kInfinity, 1e9}) {
        add("position", bad, code_of(bad), [](Body& b, double v) { b.position.x = v; });
        add("velocity", bad, code_of(bad), [](Body& b, double v) { b.velocity.y = v; });
        add("angle", bad, code_of(bad), [](Body& b, double v) { b.angle = v; });
        add("spin", bad, code_of(bad), [](Body& b, double v) { b.angular_velocity = v; });
    }
    add("outside the walls", 100, ErrorCode::out_of_range, [](Body& b, double v) { b.position.x = v; });
    add("larger than the walls' box", 100, ErrorCode::inconsistent,
        [](Body& b, double v) { b.shape = Disc{v}; });
    for (const BodyId stale : {BodyId{}, BodyId{1, 7}, BodyId{1000, 0}}) {
        const ErrorCode code = ErrorCode::stale_handle;
        all.push_back({"stale", "World::remove", code, [stale](World& w) { w.remove(stale); }});
        all.push_back({"stale", "World::row", code, [stale](World& w) { static_cast<void>(w.row(stale)); }});
        all.push_back(
            {"stale", "World::state", code, [stale](World& w) { static_cast<void>(w.state(stale)); }});
        all.push_back(
            {"stale", "World::set_position", code, [stale](World& w) { w.set_position(stale, {}); }});
        all.push_back(
            {"stale", "World::set_velocity", code, [stale](World& w) { w.set_velocity(stale, {}); }});
        all.push_back({"stale", "World::set_angular_velocity", code,
                       [stale](World& w) { w.set_angular_velocity(stale, 0); }});
    }
    return all;
}

}  // namespace

TEST_SUITE("hard cases/bad values") {
    TEST_CASE_TEMPLATE("a world refuses bad values with a message and goes on bit for bit as before", Real,
                       float, double) {
        Scene scene = gas_scene({.count = 60, .packing_fraction = 0.2, .restitution = 0.9});
        scene.accuracy.solver = Solver::impulse;  // `auto` would take another one for friction
        scene.gravity = {0, -5};
        BasicWorld<Real> world(scene), untouched(scene);
        for (const Attempt<Real>& attempt : attempts<Real>()) {
            CAPTURE(attempt.what);
            const std::uint64_t before = world.state_hash();
            std::string message;
            try {
                attempt.call(world);
            } catch (const Error& error) {
                message = error.what();
                CHECK_MESSAGE(error.code() == attempt.code, message);
            }
            CAPTURE(message);
            CHECK(message.starts_with(attempt.where));
            CHECK(message.size() > attempt.where.size() + 20);
            CHECK(world.state_hash() == before);
            CHECK(world.body_count() == untouched.body_count());
            world.step(kStep);
            untouched.step(kStep);
            CHECK(world.state_hash() == untouched.state_hash());
        }
    }

    TEST_CASE_TEMPLATE("a step that drag would cut into more than 4,096 substeps is refused", Real, float,
                       double) {
        for (const Solver solver : {Solver::impulse, Solver::soft})
            for (const double drag : {1e4, 1e6, 1e9}) {
                Scene scene;
                scene.accuracy.solver = solver;
                scene.drag.linear = drag;
                scene.add(disc(0.5, 1, {0, 0}, {1, 0}));
                BasicWorld<Real> world(scene);
                const std::uint64_t before = world.state_hash();
                std::string message;
                try {
                    world.step(kStep);
                } catch (const Error& error) {
                    message = error.what();
                    CHECK(error.code() == ErrorCode::out_of_range);
                }
                CAPTURE(message);
                CHECK(message.empty() == (drag < 1e5));
                CHECK((world.state_hash() == before) == (drag > 1e5));
                if (drag > 1e5) CHECK(message.find("drag.linear") != std::string::npos);
            }
    }

    TEST_CASE_TEMPLATE("numbers at the edge of what is allowed step without harm", Real, float, double) {
        Scene scene;
        scene.accuracy.solver = Solver::impulse;
        scene.add(disc(1e-9, 1e-30, {0, 0}, {1e-9, 0}, 1));
        scene.add(disc(1e-3, 1e30, {1, 0}, {-1, 0}, 1));
        scene.add(disc(1e-9, 1e-30, {0, 1}, {kDenormal, -kDenormal}, 1));
        BasicWorld<Real> world(scene, {.effects = {.ledger = true}});
        for (const double dt : {1e-12, 1e-6, kStep, 10.0}) world.step(dt);
        for (std::uint32_t i = 0; i < 3; ++i) {
            const BodyState state = world.state({i, 0});
            CHECK(std::isfinite(state.position.x + state.position.y + state.velocity.x + state.velocity.y));
        }
        CHECK(std::isfinite(world.ledger().energy_by_cause.sum()));
        CHECK(world.quarantined().empty());
    }
}

}  // namespace test_bad_values
