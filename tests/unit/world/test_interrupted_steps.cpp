// Steps that end early: the embedding program says so, or a step of solver `event` has more impacts than it
// may.
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/errors.hpp>
#include <carom/world.hpp>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace test_interrupted_steps {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// Says yes when it is asked for the `last`th time, and from then on.
struct Patience {
    int last;
    int asked = 0;

    ShouldStop should_stop() {
        return [this] { return ++asked >= last; };
    }
};

/// Takes a step that ends early. @return its error's code
template <class Real>
ErrorCode code_of_step(BasicWorld<Real>& world, double dt) {
    try {
        world.step(dt);
    } catch (const Error& error) {
        return error.code();
    }
    FAIL("the step came to its end");
    return {};
}

/// Discs on a lattice in a closed box that fly in directions that follow a fixed rule.
Scene crowd(int side, const Material& material) {
    Scene scene;
    constexpr double kSpacing = 1.3, kSpeed = 3, kGoldenAngle = 2.399963;
    scene.walls = Walls{.min = {0, 0}, .max = {kSpacing * side, kSpacing * side}, .material = material};
    for (int i = 0; i < side * side; ++i) {
        Body body = disc(0.5, 1, {kSpacing * (i % side + 0.5), kSpacing * (i / side + 0.5)},
                         {kSpeed * std::cos(kGoldenAngle * i), kSpeed * std::sin(kGoldenAngle * i)}, 1);
        body.material = material;
        scene.add(body);
    }
    return scene;
}

constexpr Material kSmooth{.restitution = 1}, kRough{.friction = 0.3, .restitution = 1},
    kLossy{.friction = 0.3, .restitution = 0.9};

/// A kinematic disc that pushes another one against a wall: impacts without end before it gets there.
Scene press() {
    Scene scene;
    scene.walls = Walls{.min = {0, 0}, .max = {10, 4}, .material = kSmooth};
    Body pusher = disc(0.5, 1, {8, 2}, {1, 0}, 1);
    pusher.type = BodyType::kinematic_body, pusher.mass.reset();
    scene.add(disc(0.5, 1, {2, 1}, {}, 1));
    scene.add(pusher);
    scene.add(disc(0.5, 1, {9.2, 2}, {}, 1));
    scene.accuracy.solver = Solver::event;
    return scene;
}

double total_energy(const Ledger& ledger) {
    return ledger.energy.total();
}

}  // namespace

TEST_SUITE("world/interrupted steps") {
    TEST_CASE("event: an interrupted step ends at the time of an impact, exactly as a shorter step does") {
        Scene scene = crowd(20, kSmooth);
        scene.accuracy.solver = Solver::event;
        Patience patience{3};
        World64 world(scene, {.should_stop = patience.should_stop()}), whole(scene);
        CHECK(code_of_step(world, 10) == ErrorCode::interrupted);
        CHECK(patience.asked == 3);
        CHECK(world.time() > 0);
        CHECK(world.time() < 3);
        CHECK(total_energy(world.ledger()) == doctest::Approx(world.ledger().initial.total()).epsilon(1e-12));
        whole.step(world.time());
        for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
            const BodyState a = world.state({i, 0}), b = whole.state({i, 0});
            CHECK(std::abs(a.position.x - b.position.x) < 1e-6);
            CHECK(std::abs(a.position.y - b.position.y) < 1e-6);
        }
        patience.last = std::numeric_limits<int>::max();
        const double before = world.time();
        world.step(0.5);
        CHECK(world.time() == doctest::Approx(before + 0.5).epsilon(1e-12));
        CHECK(world.overlaps().max < 1e-9);
    }

    TEST_CASE("soft: an interrupted step leaves the world where the step began, with its books") {
        for (const Material& material : {kLossy, kSmooth}) {
            Scene scene = crowd(20, material);
            scene.gravity = {0, -10};
            scene.accuracy.solver = Solver::soft, scene.accuracy.substeps = 200;
            scene.effects.ledger = true;
            Patience never{std::numeric_limits<int>::max()};
            World world(scene, {.should_stop = never.should_stop()});
            for (int i = 0; i < 5; ++i) world.step(kStep);
            const std::uint64_t hash = world.state_hash();
            const Ledger ledger = world.ledger();
            const double time = world.time();
            for (const int last : {1, 2, 3}) {
                CAPTURE(last);
                never.last = last, never.asked = 0;
                CHECK(code_of_step(world, kStep) == ErrorCode::interrupted);
                CHECK(world.state_hash() == hash);
                CHECK(world.time() == time);
                CHECK(world.ledger().energy_by_cause.restitution == ledger.energy_by_cause.restitution);
                CHECK(world.ledger().energy_by_cause.friction == ledger.energy_by_cause.friction);
                CHECK(world.ledger().energy_by_cause.unexplained == ledger.energy_by_cause.unexplained);
            }
            never.last = std::numeric_limits<int>::max();
            const double unexplained = std::abs(ledger.energy_by_cause.unexplained);
            world.step(kStep);
            CHECK(std::abs(world.ledger().energy_by_cause.unexplained) <
                  unexplained + 1e-4 * std::abs(total_energy(ledger)));
        }
    }

    TEST_CASE("impulse: an interrupted step leaves the world where the present substep began") {
        for (const Material& material : {kSmooth, kRough}) {
            Scene scene = crowd(30, material);
            scene.accuracy.solver = Solver::impulse, scene.accuracy.substeps = 4;
            scene.effects.ledger = true;
            constexpr double kLong = 2;
            for (const int last : {1, 2, 5, 8}) {
                CAPTURE(last);
                Patience patience{last};
                World64 world(scene, {.should_stop = patience.should_stop()});
                CHECK(code_of_step(world, kLong) == ErrorCode::interrupted);
                const double substeps = world.time() / (kLong / 4);
                CHECK(substeps == std::floor(substeps));
                CHECK(substeps < 4);
                World64 whole(scene, {.substeps = 1});
                for (int i = 0; i < static_cast<int>(substeps); ++i) whole.step(kLong / 4);
                CHECK(world.state_hash() == whole.state_hash());
                CHECK(world.ledger().energy_by_cause.friction == whole.ledger().energy_by_cause.friction);
                CHECK(world.ledger().energy_by_cause.restitution ==
                      whole.ledger().energy_by_cause.restitution);
            }
        }
    }

    TEST_CASE("impulse: a heap whose contacts at rest are being solved can be interrupted") {
        Scene scene;
        scene.gravity = {0, -10};
        scene.walls = Walls{.min = {0, 0}, .max = {40, 100}};
        for (int i = 0; i < 400; ++i) scene.add(disc(0.5, 1, {0.5 + i % 40, 0.5 + i / 40}, {}, 0));
        scene.accuracy.solver = Solver::impulse;
        Patience patience{1};
        World world(scene, {.should_stop = patience.should_stop()});
        const std::uint64_t hash = world.state_hash();
        CHECK(code_of_step(world, kStep) == ErrorCode::interrupted);
        CHECK(world.state_hash() == hash);
    }

    TEST_CASE("an interrupted world goes on from a saved state bit for bit") {
        for (const Solver solver : {Solver::event, Solver::impulse, Solver::soft}) {
            CAPTURE(static_cast<int>(solver));
            Scene scene = crowd(20, kRough);
            scene.accuracy.solver = solver;
            Patience patience{std::numeric_limits<int>::max()};
            World world(scene, {.should_stop = patience.should_stop()}), other(scene);
            world.step(kStep), other.step(kStep);
            std::vector<std::byte> state(world.state_bytes());
            world.save_state(state);
            patience.last = 1;
            CHECK(code_of_step(world, 5) == ErrorCode::interrupted);
            patience.last = std::numeric_limits<int>::max();
            world.restore_state(state);
            for (int i = 0; i < 5; ++i) world.step(kStep), other.step(kStep);
            CHECK(world.state_hash() == other.state_hash());
        }
    }

    TEST_CASE("short steps do not ask, and being asked changes no bit") {
        for (const Solver solver : {Solver::event, Solver::impulse, Solver::soft}) {
            Scene scene = crowd(20, kRough);
            scene.accuracy.solver = solver;
            Patience patience{std::numeric_limits<int>::max()};
            World world(scene, {.should_stop = patience.should_stop()}), other(scene);
            world.step(1e-6), other.step(1e-6);
            CHECK(patience.asked == 0);
            world.step(5), other.step(5);
            CHECK(patience.asked > 0);
            CHECK(world.state_hash() == other.state_hash());
        }
    }

    TEST_CASE("what should_stop throws leaves the step, and another solver and a copy ask it, too") {
        struct Failure : std::runtime_error {
            using std::runtime_error::runtime_error;
        };
        Scene scene = crowd(20, kSmooth);
        scene.accuracy.solver = Solver::impulse;
        bool fails = true;
        World world(scene, {.should_stop = [&] { return fails ? throw Failure("asked") : false; }});
        CHECK_THROWS_AS(world.step(5), Failure);
        World copy(world);
        CHECK_THROWS_AS(copy.step(5), Failure);
        world.set_solver(Solver::soft);
        CHECK_THROWS_AS(world.step(5), Failure);
        fails = false;
        const double before = world.time();  // s, of flights of the long step that were done
        world.step(kStep);
        CHECK(world.time() == doctest::Approx(before + kStep));
    }

    TEST_CASE("event: a disc that is squeezed against a wall ends the step, by name, and soft goes on") {
        World64 world(press());
        std::string message;
        ErrorCode code{};
        double before = 0;
        try {
            for (int i = 0; i < 120; ++i) {
                before = world.time();
                world.step(kStep);
            }
        } catch (const Error& error) {
            message = error.what(), code = error.code();
        }
        CAPTURE(message);
        CHECK(code == ErrorCode::given_up);
        CHECK(message.find("body 2 (10000)") != std::string::npos);
        CHECK((message.find("body 1 (5000)") != std::string::npos ||
               message.find("a wall (5000)") != std::string::npos));
        CHECK(message.find("1020000 impacts") != std::string::npos);
        CHECK(message.find("\"soft\"") != std::string::npos);
        CHECK(world.time() >= before);
        CHECK(world.time() < before + kStep);
        // Before the gap is closed, at 1 s: the disc has its place between the two.
        CHECK(world.time() == doctest::Approx(0.5).epsilon(0.01));
        CHECK(std::isfinite(world.state({2, 0}).velocity.x));
        world.set_solver(Solver::soft);
        for (int i = 0; i < 10; ++i) world.step(kStep);
    }

    TEST_CASE("event: Galperin's 31,415 collisions are no reason to give a step up") {
        Scene scene;
        scene.walls = Walls{.min = {0, 0}, .max = {100, 1}, .material = kSmooth};
        scene.add(disc(0.5, 1, {5, 0.5}, {}, 1));
        scene.add(disc(0.5, 1e8, {8, 0.5}, {-10, 0}, 1));
        scene.accuracy.solver = Solver::event;
        World64 world(scene);
        world.step(3);
        CHECK(world.profile().impacts == 31415);
    }
}

}  // namespace test_interrupted_steps
