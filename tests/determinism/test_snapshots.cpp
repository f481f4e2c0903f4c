// World::save_state and restore_state: a world that is restored goes on to the same bits as the one that was
// saved, on any number of threads and any instruction set, whatever scene it was made of.
#include "determinism/golden_scenes.hpp"

#include <carom/errors.hpp>

#include <doctest/doctest.h>

#include <string>
#include <utility>

#include "math/random.hpp"

namespace test_snapshots {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;  // s
constexpr int kSaved = 45, kEnd = 90;

template <class Real>
void run(BasicWorld<Real>& world, int steps) {
    for (int i = 0; i < steps; ++i) world.step(kStep);
}

template <class Real>
std::vector<std::byte> saved(const BasicWorld<Real>& world) {
    std::vector<std::byte> state(world.state_bytes());
    world.save_state(state);
    return state;
}

/// The scenes that solver `event` takes, and the golden ones under their own solvers.
std::vector<Scene> scenes_of_every_solver() {
    std::vector<Scene> scenes = golden_scenes();
    scenes.push_back(gas(400, {0.3, 0.5}, 0.9));
    scenes.back().name = "gas of solver event", scenes.back().accuracy.solver = Solver::event;
    scenes.push_back(moving_obstacles());
    scenes.back().name = "moving obstacles of solver soft", scenes.back().accuracy.solver = Solver::soft;
    scenes.push_back(rough_sizes());
    scenes.back().name = "rough sizes with a ledger", scenes.back().effects.ledger = true;
    return scenes;
}

/// Changes a world between steps, as a host does.
template <class Real>
void edit(BasicWorld<Real>& world, int round) {
    const auto ids = world.bodies().id;
    const std::vector<BodyId> bodies(ids.begin(), ids.end());
    const BodyId gone = bodies[bodies.size() / 3];
    Body body{.shape = Disc{0.4}, .position = {2.0 + 0.5 * round, 3}, .velocity = {1, 0}};
    body.material.restitution = 0.9;
    world.remove(gone);
    world.add(body);
}

/// Small boxes that fall on a row of large ones within walls, all of which fall asleep when they rest.
Scene boxes_that_fall_asleep(std::uint64_t seed) {
    const Material rough{.friction = 0.5};
    Random random(seed);
    Scene scene;
    scene.gravity = {0, -10};
    scene.effects.sleep = true;
    scene.walls = Walls{.min = {0, 0}, .max = {14, 30}, .material = rough};
    for (int i = 0; i < 12; ++i)
        scene.add({.shape = Box{0.8, 0.8},
                   .position = {1 + 1.1 * i, 0.4 + random.uniform(0, 1e-3)},
                   .material = rough});
    for (int i = 0; i < 10; ++i)
        scene.add({.shape = Box{0.3, 0.3},
                   .position = {random.uniform(1, 13), 3 + 2.5 * i},
                   .angle = random.uniform(),
                   .velocity = {random.uniform(-2, 2), 0},
                   .material = rough});
    return scene;
}

template <class Real>
std::string refusal(BasicWorld<Real>& world, std::span<const std::byte> state) {
    const std::uint64_t before = world.state_hash();
    std::string message;
    try {
        world.restore_state(state);
    } catch (const Error& error) {
        message = error.what();
    }
    CHECK(world.state_hash() == before);
    return message;
}

/// A world and those that its state is restored in, of each instruction set, go on alike for some steps.
template <class Real>
void check_goes_on(BasicWorld<Real> whole, int steps) {
    const std::vector<std::byte> state = saved(whole);
    run(whole, steps);
    for (const std::string& isa : runnable_instruction_sets()) {
        CAPTURE(isa);
        BasicWorld<Real> other(Scene{}, {.isa = isa, .threads = 2});
        other.restore_state(state);
        run(other, steps);
        CHECK(other.state_hash() == whole.state_hash());
    }
}
/// The same from step `first` of a scene on.
template <class Real>
void check_goes_on(const Scene& scene, int first, int steps) {
    BasicWorld<Real> whole(scene, {.threads = 1});
    run(whole, first);
    check_goes_on(std::move(whole), steps);
}

}  // namespace

TEST_SUITE("determinism/snapshots") {
    TEST_CASE_TEMPLATE("every golden scene goes on to the same hash in another world", Real, float, double) {
        for (const Scene& scene : scenes_of_every_solver()) {
            CAPTURE(scene.name);
            BasicWorld<Real> whole(scene, {.threads = 1});
            run(whole, kSaved);
            const std::vector<std::byte> state = saved(whole);
            const Ledger ledger = whole.ledger();
            run(whole, kEnd - kSaved);
            for (const std::string& isa : runnable_instruction_sets()) {
                CAPTURE(isa);
                BasicWorld<Real> other(scene, {.isa = isa, .threads = isa == "scalar" ? 1 : 3});
                run(other, 7);  // its own history must not matter
                other.restore_state(state);
                CHECK(other.profile().steps == kSaved);
                if (whole.plan().solver == "soft")
                    CHECK(other.profile().touching == 0);  // it has made no step whose contacts it knows
                CHECK(other.ledger().energy.kinetic == ledger.energy.kinetic);
                run(other, kEnd - kSaved);
                CHECK(other.state_hash() == whole.state_hash());
                CHECK(other.time() == whole.time());
                CHECK(other.ledger().energy_by_cause.friction == whole.ledger().energy_by_cause.friction);
            }
        }
    }

    TEST_CASE_TEMPLATE("a world of another scene and solver takes a state, with its plan", Real, float,
                       double) {
        for (const Scene& scene : scenes_of_every_solver()) {
            CAPTURE(scene.name);
            BasicWorld<Real> whole(scene, {.threads = 1});
            run(whole, kSaved);
            BasicWorld<Real> other{Scene{}}, gas_world(gas(50, {0.5, 0.5}, 1));
            for (BasicWorld<Real>* world : {&other, &gas_world}) {
                world->restore_state(saved(whole));
                CHECK(world->plan().solver == whole.plan().solver);
                CHECK(world->plan().solver_reason == whole.plan().solver_reason);
                CHECK(world->plan().effects.size() == whole.plan().effects.size());
            }
            run(whole, 30), run(other, 30), run(gas_world, 30);
            CHECK(other.state_hash() == whole.state_hash());
            CHECK(gas_world.state_hash() == whole.state_hash());
        }
    }

    TEST_CASE_TEMPLATE("bodies added and removed before and after the save make no difference", Real, float,
                       double) {
        for (const Scene& scene : golden_scenes()) {
            if (scene.name == "gas" || scene.name == "turning chain" || scene.name == "stack at rest")
                continue;
            CAPTURE(scene.name);
            BasicWorld<Real> whole(scene, {.threads = 1}), other(scene, {.threads = 1});
            run(whole, 20), edit(whole, 0), run(whole, 20),
                edit(whole, 1);  // saved with an edit not yet stepped
            other.restore_state(saved(whole));
            for (int round = 2; round < 5; ++round)
                for (BasicWorld<Real>* world : {&whole, &other}) run(*world, 9), edit(*world, round);
            CHECK(other.state_hash() == whole.state_hash());
        }
    }

    // What has gone is remembered until the next step: docs/decisions/0067-weights-taken-off-heaps.md.
    TEST_CASE_TEMPLATE("a heap whose weight was just removed goes on alike", Real, float, double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.add({.type = BodyType::static_body, .shape = Box{40, 2}, .position = {0, -1}});
        add_pyramid(scene,
                    {.base = 8, .body = {.shape = Box{1, 1}, .mass = 1, .material = {.friction = 0.6}}});
        const BodyId weight =
            scene.add({.shape = Box{4, 1}, .position = {0.3, 9}, .angle = 0.1, .mass = 100});
        BasicWorld<Real> whole(scene, {.threads = 1}), other(scene, {.threads = 1});
        run(whole, 60), whole.remove(weight);
        other.restore_state(saved(whole));
        run(whole, 10), run(other, 10);
        CHECK(other.state_hash() == whole.state_hash());
    }

    TEST_CASE_TEMPLATE("a pyramid at rest, whose contacts are carried on from step to step, goes on alike",
                       Real, float, double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.add({.type = BodyType::static_body, .shape = Box{40, 2}, .position = {0, -1}});
        add_pyramid(scene, {.base = 12, .body = {.shape = Box{1, 1}, .material = {.friction = 0.6}}});
        scene.add({.shape = Box{0.5, 0.5}, .position = {-9, 8}, .velocity = {2, 0}});
        check_goes_on<Real>(scene, 80, 45);
    }

    TEST_CASE_TEMPLATE("crates at rest on a chain, whose contacts are carried on, go on alike", Real, float,
                       double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.add({.type = BodyType::static_body, .shape = Chain{{{9, 1}, {3, 0}, {-3, 0.5}, {-9, 1}}}});
        for (int i = 0; i < 12; ++i)
            scene.add(
                {.shape = Box{0.8, 0.5}, .position = {-6 + 1.1 * i, 1.4}, .material = {.friction = 0.8}});
        check_goes_on<Real>(scene, 200, 45);
    }

    TEST_CASE_TEMPLATE(
        "a heap of shapes that falls, whose cut into paths is kept for some steps, goes on alike", Real,
        float, double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.add({.type = BodyType::static_body, .shape = Box{60, 2}, .position = {0, -1}});
        Lattice lattice{.count_x = 40, .count_y = 30, .origin = {-25, 1}, .spacing = {1.25, 1.25}};
        lattice.body.material.friction = 0.5;
        add_lattice(scene, lattice);
        for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
            scene.bodies[i].angle = 0.7 * static_cast<double>(i);
            if (i % 3 == 0)
                scene.bodies[i].shape = Capsule{.length = 0.5, .radius = 0.3};
            else
                scene.bodies[i].shape = Box{1, 0.8};
        }
        BasicWorld<Real> whole(scene, {.threads = 1});
        run(whole, 90);
        CHECK(whole.profile().contacts > 1024);             // fewer are cut anew in each step
        for (int saved_at = 0; saved_at < 4; ++saved_at) {  // as many steps as a cut is kept for
            CAPTURE(saved_at);
            check_goes_on(whole, 11);
            run(whole, 1);
        }
    }

    TEST_CASE_TEMPLATE("a large pile in several task groups, its margins moving with the flow, goes on alike",
                       Real, float, double) {
        Scene scene = gas(12'000, {0.4, 0.6}, 0.2);
        scene.gravity = {0, -30};
        for (Body& body : scene.bodies) body.material.friction = 0.5;
        BasicWorld<Real> whole(scene, {.threads = 1}), other(Scene{}, {.threads = 2});
        run(whole, 40);
        other.restore_state(saved(whole));
        run(whole, 20), run(other, 20);
        CHECK(other.state_hash() == whole.state_hash());
    }

    TEST_CASE("saving changes no bit of the world, and a state saved again is the same bytes") {
        World watched(rough_sizes()), free(rough_sizes());
        for (int i = 0; i < kSaved; ++i) {
            watched.step(kStep), free.step(kStep);
            static_cast<void>(saved(watched));
        }
        CHECK(watched.state_hash() == free.state_hash());
        CHECK(saved(watched) == saved(watched));
    }

    // What is carried on from step to step, or kept for what sleeps, is state wherever it is in use: contacts
    // of sleepers were those of the step before the last, contacts that are carried on behind others in their
    // path took these to be at rest when paths were made anew, and saving made them so.
    TEST_CASE_TEMPLATE("boxes that fall asleep one by one go on alike from each step", Real, float, double) {
        constexpr int kSteps = 240, kAhead = 3;
        int differ = 0;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            const Scene scene = boxes_that_fall_asleep(seed);
            BasicWorld<Real> whole(scene, {.threads = 1}), restored(scene, {.threads = 1}),
                free(scene, {.threads = 1});
            std::vector<std::uint64_t> after;
            for (int i = 0; i < kSteps; ++i) run(free, 1), after.push_back(free.state_hash());
            for (int i = 0; i < kSteps; ++i) {
                run(whole, 1);
                differ += whole.state_hash() != after[static_cast<std::size_t>(i)] ? 1 : 0;
                restored.restore_state(saved(whole));
                for (int k = i + 1; k <= i + kAhead && k < kSteps; ++k) {
                    run(restored, 1);
                    differ += restored.state_hash() != after[static_cast<std::size_t>(k)] ? 1 : 0;
                }
            }
        }
        CHECK(differ == 0);
    }

    TEST_CASE("a world that steps back again and again takes the same way each time") {
        World world(woken_sleepers());
        run(world, kSaved);
        const std::vector<std::byte> state = saved(world);
        run(world, 60);
        const std::uint64_t end = world.state_hash();
        for (int round = 0; round < 3; ++round) {
            world.restore_state(state);
            run(world, 60);
            CHECK(world.state_hash() == end);
        }
    }

    TEST_CASE("a copy goes on like the original, and neither feels the other") {
        World world(turning_chain(), {.threads = 2});
        run(world, kSaved);
        World copy(world), assigned{Scene{}};
        assigned = world;
        run(world, 30);
        CHECK(copy.state_hash() != world.state_hash());
        run(copy, 30), run(assigned, 30);
        CHECK(copy.state_hash() == world.state_hash());
        CHECK(assigned.state_hash() == world.state_hash());
    }

    TEST_CASE("bytes that are no state are refused with what is wrong, and the world stays as it is") {
        World world(rough_sizes());
        run(world, 10);
        const std::vector<std::byte> state = saved(world);
        std::vector<std::byte> damaged = state, other_start = state;
        damaged[state.size() / 2] ^= std::byte{1};
        other_start[0] ^= std::byte{1};
        const std::span<const std::byte> whole(state);
        CHECK(refusal(world, whole.first(10)).find("10 bytes") != std::string::npos);
        CHECK(refusal(world, whole.first(state.size() - 1)).find("are there") != std::string::npos);
        CHECK(refusal(world, damaged).find("damaged") != std::string::npos);
        CHECK(refusal(world, other_start).find("do not begin like a state") != std::string::npos);
        // Of the header, too: its solver, say, would be made a world of.
        for (std::size_t at = 0; at < 64; ++at)
            for (const unsigned bit : {0u, 1u, 2u, 7u}) {
                std::vector<std::byte> flipped = state;
                flipped[at] ^= std::byte{1} << bit;
                CAPTURE(at);
                CHECK(refusal(world, flipped) != "");
            }
        World64 wide(rough_sizes());
        CHECK(refusal(wide, whole).find("numbers of 4 bytes") != std::string::npos);
        std::vector<std::byte> small(state.size() - 1, std::byte{7});
        CHECK_THROWS_AS(world.save_state(small), Error);
        CHECK(small == std::vector<std::byte>(state.size() - 1, std::byte{7}));
    }
}

}  // namespace test_snapshots
