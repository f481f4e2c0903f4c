// Every feature of a scene beside every other one. Faults hide where two meet that no scene of ours has
// together: boxes of fixed rotation that bounce without friction had no column for their angles, and crashed.
#include <doctest/doctest.h>
#include <carom/carom.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "math/random.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"

namespace test_features_together {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;         // s
constexpr double kWidth = 6, kSize = 0.4;  // m, of the box and of what is in it
constexpr std::uint32_t kBodies = 12;      // that move
constexpr int kSteps = 48, kSaved = 24;    // the state is taken behind so many

struct Feature {
    std::string name;
    void (*add)(Scene& scene, WorldOptions& options);
};

/// The bodies that move, of those every n-th from one on.
template <class Fn>
void change(Scene& scene, std::uint32_t first, std::uint32_t every, const Fn& fn) {
    for (std::uint32_t i = first; i < kBodies; i += every) fn(scene.bodies[i], i);
}

BodyId body(std::uint32_t row) {
    return {row, 0};
}

template <class Kind>
void join(Scene& scene, std::uint32_t first, const Kind& kind) {
    for (std::uint32_t i = first; i + 1 < kBodies; i += 4)
        scene.add(Joint{.a = body(i), .b = body(i + 1), .kind = kind});
}

template <class Fn>
void change_materials(Scene& scene, const Fn& fn) {
    for (Body& each : scene.bodies) fn(each.material);
    if (scene.walls) fn(scene.walls->material);
}

/// Shapes take turns, so that two of them meet.
void take_shape(Scene& scene, const Shape& shape) {
    const bool is_first = std::holds_alternative<Disc>(scene.bodies[1].shape);
    change(scene, is_first ? 1 : 0, is_first ? 1 : 2, [&](Body& each, std::uint32_t) { each.shape = shape; });
}

const std::vector<Feature> kFeatures = {
    {"boxes",
     [](Scene& scene, WorldOptions&) {
         take_shape(scene, Box{kSize, kSize / 2});
     }},
    {"capsules",
     [](Scene& scene, WorldOptions&) {
         take_shape(scene, Capsule{kSize / 2, kSize / 4});
     }},
    {"triangles",
     [](Scene& scene, WorldOptions&) {
         take_shape(scene, Polygon{.vertices = {{-0.2, -0.1}, {0.2, -0.1}, {0, 0.25}}});
     }},
    {"rounded triangles",
     [](Scene& scene, WorldOptions&) {
         take_shape(scene, Polygon{.vertices = {{-0.2, -0.1}, {0.2, -0.1}, {0, 0.25}}, .radius = 0.05});
     }},
    {"compounds",
     [](Scene& scene, WorldOptions&) {
         take_shape(scene, Compound{.pieces = {{.shape = Disc{0.15}, .position = {-0.15, 0}},
                                               {.shape = Box{0.2, 0.2}, .position = {0.15, 0}}}});
     }},
    {"gravity",
     [](Scene& scene, WorldOptions&) {
         scene.gravity = {0.5, -10};
     }},
    {"drag", [](Scene& scene, WorldOptions&) { scene.drag = {.linear = 0.5, .angular = 0.2}; }},
    {"restitution .5",
     [](Scene& scene, WorldOptions&) {
         change_materials(scene, [](Material& material) { material.restitution = 0.5; });
     }},
    {"elastic discs",
     [](Scene& scene, WorldOptions&) {
         change(scene, 0, 2, [](Body& each, std::uint32_t) { each.material.restitution = 1; });
     }},
    {"friction",
     [](Scene& scene, WorldOptions&) {
         change_materials(scene, [](Material& material) { material.friction = 0.4; });
     }},
    {"rolling resistance",
     [](Scene& scene, WorldOptions&) {
         change_materials(scene, [](Material& material) {
             material.rolling_resistance = 0.1, material.friction = std::fmax(material.friction, 0.2);
         });
     }},
    {"fixed rotation",
     [](Scene& scene, WorldOptions&) {
         change(scene, 0, 1, [](Body& each, std::uint32_t) { each.fixed_rotation = true; });
     }},
    {"some of fixed rotation",
     [](Scene& scene, WorldOptions&) {
         change(scene, 1, 3, [](Body& each, std::uint32_t) { each.fixed_rotation = true; });
     }},
    {"spin",
     [](Scene& scene, WorldOptions&) {
         change(scene, 0, 2, [](Body& each, std::uint32_t i) {
             each.angle = i, each.angular_velocity = each.fixed_rotation ? 0 : 5;
         });
     }},
    {"uneven masses",
     [](Scene& scene, WorldOptions&) {
         change(scene, 0, 3, [](Body& each, std::uint32_t) { each.mass = 1e4; });
     }},
    {"small discs",
     [](Scene& scene, WorldOptions&) {
         change(scene, 2, 4, [](Body& each, std::uint32_t) { each.shape = Disc{kSize / 20}; });
     }},
    {"overlaps",
     [](Scene& scene, WorldOptions&) {
         change(scene, 1, 2, [&](Body& each, std::uint32_t i) {
             each.position = {scene.bodies[i - 1].position.x + 0.1, scene.bodies[i - 1].position.y + 0.05};
         });
     }},
    {"fast bodies",
     [](Scene& scene, WorldOptions&) {
         change(scene, 3, 5, [](Body& each, std::uint32_t) { each.velocity = {80, 35}; });
     }},
    {"static disc",
     [](Scene& scene, WorldOptions&) {
         scene.add({.type = BodyType::static_body, .shape = Disc{0.5}, .position = {3, 2}});
     }},
    {"static box",
     [](Scene& scene, WorldOptions&) {
         scene.add({.type = BodyType::static_body, .shape = Box{1, 0.5}, .position = {3, 1}, .angle = 0.3});
     }},
    {"segment",
     [](Scene& scene, WorldOptions&) {
         scene.add({.type = BodyType::static_body, .shape = Segment{{0.5, 1}, {5.5, 0.6}}});
     }},
    {"chain",
     [](Scene& scene, WorldOptions&) {
         scene.add({.type = BodyType::static_body,
                    .shape = Chain{.points = {{0.3, 1.2}, {2, 0.5}, {4, 0.7}, {5.7, 1.3}}}});
     }},
    {"kinematic segment",
     [](Scene& scene, WorldOptions&) {
         scene.add({.type = BodyType::kinematic_body,
                    .shape = Segment{{-1, 0}, {1, 0}},
                    .position = {3, 0.3},
                    .velocity = {0, 1},
                    .angular_velocity = 1});
     }},
    {"kinematic disc",
     [](Scene& scene, WorldOptions&) {
         scene.add({.type = BodyType::kinematic_body,
                    .shape = Disc{0.4},
                    .position = {1, 1},
                    .velocity = {1.5, 0.3}});
     }},
    {"sensors",
     [](Scene& scene, WorldOptions&) {
         scene.add({.type = BodyType::static_body, .shape = Box{2, 2}, .position = {2, 2}, .sensor = true});
         change(scene, 5, 6, [](Body& each, std::uint32_t) { each.sensor = true; });
     }},
    {"groups",
     [](Scene& scene, WorldOptions&) {
         change(scene, 0, 2, [](Body& each, std::uint32_t i) { each.group = i % 4 == 0 ? -1 : 2; });
     }},
    {"hinges", [](Scene& scene, WorldOptions&) { join(scene, 0, RevoluteJoint{}); }},
    {"motors and limits",
     [](Scene& scene, WorldOptions&) {
         RevoluteJoint hinge;
         hinge.motor_speed = 3, hinge.lower = -1, hinge.upper = 1;
         join(scene, 1, hinge);
     }},
    {"rods", [](Scene& scene, WorldOptions&) { join(scene, 1, DistanceJoint{}); }},
    {"ropes", [](Scene& scene, WorldOptions&) { join(scene, 2, DistanceJoint{.min = 0.1, .max = 1.5}); }},
    {"welds", [](Scene& scene, WorldOptions&) { join(scene, 0, WeldJoint{}); }},
    {"sliders",
     [](Scene& scene, WorldOptions&) {
         PrismaticJoint slider;
         slider.lower = -0.5, slider.upper = 0.5;
         join(scene, 2, slider);
     }},
    {"wheels", [](Scene& scene, WorldOptions&) { join(scene, 1, WheelJoint{}); }},
    {"targets",
     [](Scene& scene, WorldOptions&) {
         scene.add(Joint{.b = body(4), .kind = TargetJoint{.target = {3, 3}, .max_force = 50}});
     }},
    {"no walls", [](Scene& scene, WorldOptions&) { scene.walls.reset(); }},
    {"sleep", [](Scene& scene, WorldOptions&) { scene.effects.sleep = true; }},
    {"ledger", [](Scene& scene, WorldOptions&) { scene.effects.ledger = true; }},
    {"effects without need",
     [](Scene& scene, WorldOptions&) {
         scene.effects.rotation = true, scene.effects.restitution = true, scene.effects.gravity = true;
     }},
    {"rotation off", [](Scene& scene, WorldOptions&) { scene.effects.rotation = false; }},
    {"one substep", [](Scene&, WorldOptions& options) { options.substeps = 1; }},
    {"eight iterations", [](Scene&, WorldOptions& options) { options.iterations = 8; }},
    {"long steps", [](Scene& scene, WorldOptions&) { scene.step.dt = 1.0 / 12; }},
    {"short steps", [](Scene& scene, WorldOptions&) { scene.step.dt = 1e-4; }},
    {"solver impulse", [](Scene&, WorldOptions& options) { options.solver = Solver::impulse; }},
    {"solver event", [](Scene&, WorldOptions& options) { options.solver = Solver::event; }},
    {"solver soft", [](Scene&, WorldOptions& options) { options.solver = Solver::soft; }},
    {"solver rattle", [](Scene&, WorldOptions& options) { options.solver = Solver::rattle; }},
};

/// Discs of 1 kg that fly about in a box.
Scene plain_scene() {
    Random random(7);
    Scene scene;
    scene.step.dt = kStep;
    scene.walls = Walls{.min = {0, 0}, .max = {kWidth, kWidth}};
    for (std::uint32_t i = 0; i < kBodies; ++i)
        scene.add({.shape = Disc{kSize / 2},
                   .position = {1 + 1.1 * (i % 4) + random.uniform(0, 0.3), 1.5 + 0.6 * (i / 4)},
                   .velocity = {random.uniform(-2, 2), random.uniform(-2, 2)},
                   .mass = 1});
    return scene;
}

/// Boxes and discs that fall into it and bounce.
Scene bouncing_heap() {
    Scene scene = plain_scene();
    scene.gravity = {0, -10};
    change(scene, 0, 2, [](Body& each, std::uint32_t) { each.shape = Box{kSize, kSize / 2}; });
    change_materials(scene, [](Material& material) { material.restitution = 0.5; });
    return scene;
}

bool is_finite(const BodyState& state) {
    return std::isfinite(state.position.x) && std::isfinite(state.position.y) &&
           std::isfinite(state.velocity.x) && std::isfinite(state.velocity.y) && std::isfinite(state.angle) &&
           std::isfinite(state.angular_velocity);
}

/// What a program does to a world while it runs. Where the world refuses, it must say why by an Error.
template <class Real>
void touch(BasicWorld<Real>& world, const Scene& scene, int step) {
    try {
        if (step == 6) world.remove(body(3));
        if (step == 10) world.add(scene.bodies[2]);
        if (step == 14) world.set_velocity(body(1), {-1, 2});
        if (step == 18 && world.is_alive(JointId::of(0))) world.remove(JointId::of(0));
        if (step == 30) world.set_position(body(0), {1, 5});
        if (step == 34) world.set_filter(body(5), {.group = -3});
        if (step == 38) world.remove(body(2)), world.add(scene.bodies[4]);
    } catch (const Error&) {
    }
}

struct Outcome {
    bool is_refused = false, is_finite = true, goes_on_alike = true;
    std::size_t quarantined = 0;
};

/// The world of a scene, or none where it is refused.
template <class Real>
std::optional<BasicWorld<Real>> world_of(const Scene& scene, const WorldOptions& options) {
    try {
        return std::optional<BasicWorld<Real>>(std::in_place, scene, options);
    } catch (const Error&) {
        return std::nullopt;
    }
}

template <class Real>
Outcome run(const Scene& scene, const WorldOptions& options) {
    std::optional<BasicWorld<Real>> world = world_of<Real>(scene, options);
    if (!world) return {.is_refused = true};
    Outcome outcome;
    BasicWorld<Real> other(scene, options);
    std::vector<std::byte> state;
    for (int step = 0; step < kSteps; ++step) {
        touch(*world, scene, step);
        world->step(scene.step.dt);
        if (step + 1 != kSaved) continue;
        state.resize(world->state_bytes());
        world->save_state(state);
    }
    for (std::uint32_t i = 0; i < kBodies; ++i) {
        if (i == 2 || i == 3) continue;  // removed
        outcome.is_finite = outcome.is_finite && is_finite(world->state(body(i)));
    }
    other.step(scene.step.dt);
    other.restore_state(state);
    for (int step = kSaved; step < kSteps; ++step) touch(other, scene, step), other.step(scene.step.dt);
    outcome.goes_on_alike = other.state_hash() == world->state_hash();
    outcome.quarantined = world->quarantined().size();
    return outcome;
}

}  // namespace

TEST_SUITE("hard cases/features together") {
    TEST_CASE_TEMPLATE("every feature works beside every other one, or is refused with a reason", Real, float,
                       double) {
        int runs = 0, refused = 0;
        const std::size_t every = scaled<std::size_t>(1, 5);
        for (const bool is_heap : {false, true})
            for (std::size_t first = 0; first < kFeatures.size(); ++first)
                for (std::size_t second = first; second < kFeatures.size(); ++second) {
                    if ((first + second) % every != 0) continue;
                    Scene scene = is_heap ? bouncing_heap() : plain_scene();
                    WorldOptions options;
                    options.threads = 1;
                    kFeatures[first].add(scene, options);
                    if (second != first) kFeatures[second].add(scene, options);
                    CAPTURE(is_heap);
                    CAPTURE(kFeatures[first].name);
                    CAPTURE(kFeatures[second].name);
                    const Outcome outcome = run<Real>(scene, options);
                    CHECK(outcome.is_finite);
                    CHECK(outcome.goes_on_alike);
                    CHECK(outcome.quarantined == 0);
                    ++runs, refused += outcome.is_refused ? 1 : 0;
                }
        report(runs, " worlds, of which ", refused, " are refused");
        CHECK(refused < runs / 3);
    }
}

}  // namespace test_features_together
