// What the ledger of solver `soft` says, whatever carries it out.
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <carom/build_info.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace test_books {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// All energies and momenta that the books have.
std::vector<double> entries(const Ledger& ledger) {
    const EnergyByCause& energy = ledger.energy_by_cause;
    const MomentumByCause& momentum = ledger.momentum_by_cause;
    std::vector<double> all{energy.drag,   energy.restitution, energy.friction, energy.correction,
                            energy.joints, energy.drive,       energy.sleep,    ledger.wall_impulse};
    for (const Vec2 of : {momentum.gravity, momentum.drag, momentum.walls, momentum.immovable})
        all.push_back(of.x), all.push_back(of.y);
    return all;
}

/// Discs that fall on a kinematic plate and a floor, with drag and rolling resistance.
Scene falling_discs(int count) {
    Scene scene;
    scene.gravity = {1, -10};
    scene.drag = {.linear = 0.2, .angular = 0.1};
    scene.walls = Walls{.min = {0, 0}, .max = {80, 1000}, .material = {.friction = 0.5}};
    scene.effects.ledger = true;
    std::mt19937 random(5);
    for (int i = 0; i < count; ++i) {
        const double radius = 0.35 + 0.1 * static_cast<double>(random() % 1000) / 1000;
        Body body = disc(radius, radius * radius, {0.6 + 1.1 * (i % 70), 0.6 + 1.1 * (i / 70)});
        body.material = {.friction = 0.4, .restitution = 0.2, .rolling_resistance = 0.02};
        scene.add(body);
    }
    scene.add(Body{
        .type = BodyType::kinematic_body, .shape = Disc{2}, .position = {40, -1.5}, .velocity = {0.5, 0}});
    return scene;
}

/// Chains of smooth elastic boxes that whirl, each with two loose ones in its way; they fall on a floor.
/// @param chains  far from each other
Scene whirling_chains(int chains, int links) {
    constexpr double kLength = 0.5;  // m
    constexpr double kSpin = 3;      // rad/s
    Scene scene;
    scene.gravity = {0, -10};
    scene.effects.ledger = true;
    const Material smooth{.friction = 0, .restitution = 1};
    const auto box = [&](Vec2 at) {
        return Body{.shape = Box{kLength, 0.2}, .position = at, .material = smooth};
    };
    for (int chain = 0; chain < chains; ++chain) {
        const double x = 40 * chain;
        BodyId last;
        for (int i = 0; i < links; ++i) {
            Body link = box({x + kLength * i, 3});
            link.velocity = {0, kSpin * kLength * (i - 0.5 * (links - 1))};
            link.angular_velocity = kSpin;
            const BodyId id = scene.add(link);
            if (i > 0)
                scene.joints.push_back(
                    {.a = last, .b = id, .kind = RevoluteJoint{.anchor = Vec2{x + kLength * (i - 0.5), 3}}});
            last = id;
        }
        scene.add(box({x + 1, 4})), scene.add(box({x + kLength * links - 1, 4}));
    }
    Body floor{
        .type = BodyType::static_body, .shape = Box{200, 1}, .position = {20, -0.5}, .material = smooth};
    scene.add(floor);
    return scene;
}

/// Steps a world of a chain that whirls for ten seconds. @param fn  fn(cause) is called after each step
/// @return J, kinetic energy at the start
template <class Real, class Fn>
double follow_chains(int chains, int links, const Fn& fn) {
    BasicWorld<Real> world(whirling_chains(chains, links), {.solver = Solver::soft});
    const double start = world.ledger().energy.kinetic;
    for (int i = 0; i < 600; ++i) {
        world.step(kStep);
        fn(world.ledger().energy_by_cause);
    }
    return start;
}

/// The most energy that a step of such a world leaves without a cause, over that at the start.
template <class Real>
double largest_without_cause(int chains, int links) {
    double largest = 0, before = 0;
    const double start = follow_chains<Real>(chains, links, [&](const EnergyByCause& cause) {
        largest = std::fmax(largest, std::abs(cause.unexplained - before)), before = cause.unexplained;
    });
    report("a step leaves at most ", largest / start, " of the energy without a cause");
    return largest / start;
}

/// A body of 1 kg at a wall that it leaves by 1 m/s, and one of 9 kg beyond the wall that draws it back by a
/// rod.
Scene drawn_back(const Shape& shape, const DistanceJoint& rod) {
    Scene scene;
    scene.effects.ledger = true;
    scene.add(Body{.type = BodyType::static_body, .shape = Box{1, 20}, .position = {-1, 0}});
    Body light{.shape = shape, .position = {0, 0}, .velocity = {1, 0}}, heavy = light;
    light.mass = 1, heavy.mass = 9;
    heavy.position.x = -8, heavy.velocity.x = -1;
    const BodyId a = scene.add(light), b = scene.add(heavy);
    scene.add(Joint{.a = a, .b = b, .kind = rod});
    return scene;
}

/// Carts, each a box on two sprung wheels, in a drum of three sides that turns.
/// @param corner  m, distance of the drum's corners from its axle  @param spin  rad/s
Scene carts_in_a_drum(int carts, double corner, double spin) {
    Scene scene;
    scene.effects.ledger = true;
    scene.gravity = {0, -10};
    Chain drum{.points = {}, .loop = true};
    for (const double angle : {0.5, 0.5 + 2 * std::numbers::pi / 3, 0.5 + 4 * std::numbers::pi / 3})
        drum.points.push_back({corner * std::cos(angle), corner * std::sin(angle)});
    for (int i = 0; i < carts; ++i) {
        const int side = static_cast<int>(std::sqrt(carts));
        const double x = 2.4 * (i % side - 0.5 * side), y = 1.2 * (i / side - 0.5 * side);
        const BodyId chassis = scene.add(Body{.shape = Box{2, 0.5}, .position = {x, y}});
        for (const double side_of_wheel : {-0.7, 0.7}) {
            const BodyId wheel =
                scene.add(Body{.shape = Disc{0.3}, .position = {x + side_of_wheel, y - 0.5}});
            scene.add(
                Joint{.a = chassis, .b = wheel, .kind = WheelJoint{.frequency = 20, .damping_ratio = 0.1}});
        }
    }
    scene.add(Body{.type = BodyType::kinematic_body, .shape = drum, .angular_velocity = spin});
    return scene;
}

}  // namespace

TEST_SUITE("hard cases/books") {
    TEST_CASE_TEMPLATE("have the same bits on every instruction set and any number of threads", Real, float,
                       double) {
        const Scene scene = falling_discs(3000);
        const auto entries_with = [&](const WorldOptions& options) {
            BasicWorld<Real> world(scene, options);  // solver soft, which has rolling resistance
            for (int i = 0; i < 40; ++i) world.step(kStep);
            return entries(world.ledger());
        };
        const std::vector<double> expected = entries_with({.isa = "scalar", .threads = 1});
        for (const double entry : expected) CHECK(std::isfinite(entry));
        for (const std::string& isa : runnable_instruction_sets()) {
            CAPTURE(isa);
            CHECK(entries_with({.isa = isa, .threads = 1}) == expected);
        }
        CHECK(entries_with({.threads = 3}) == expected);
    }

    // The books had the drag of a substep in double precision, which differs from what bodies in single
    // precision flew with by 1e-5 of what it takes.
    TEST_CASE("what drag takes in single precision is what bodies lose") {
        Scene scene;
        scene.drag = {.linear = 0.3, .angular = 0.3};
        scene.effects.ledger = true;
        for (int i = 0; i < 200; ++i) {
            Body body = disc(0.5, 1 + 0.01 * i, {3.0 * (i % 20), 3.0 * (i / 20)}, {1.0 + 0.001 * i, 2});
            body.angular_velocity = 1, body.material.friction = 0.5;
            scene.add(body);
        }
        BasicWorld<float> world(scene, {.solver = Solver::soft});
        for (int i = 0; i < 120; ++i) world.step(kStep);
        const Ledger ledger = world.ledger();
        REQUIRE(ledger.energy_by_cause.drag < -100);
        const double error = std::abs(ledger.energy_by_cause.unexplained / ledger.energy_by_cause.drag);
        report("drag misses ", error, " of what it takes");
        CHECK(error < 1e-6);
    }

    // Where what joints and contacts gave was scaled, impulses of wheels and sliders across their axes were
    // not: the next substep took more from velocities than these had got, and the books had it given by
    // nothing.
    TEST_CASE_TEMPLATE("carts in a drum have all of their energy from a cause", Real, float, double) {
        double largest = 0;
        for (const int carts : {4, 9, 16})
            for (const double spin : {2.0, 4.0, 7.0}) {
                BasicWorld<Real> world(carts_in_a_drum(carts, 3 * std::sqrt(carts) + 3, spin),
                                       {.solver = Solver::soft});
                double before = 0, most = 0, share = 0;
                for (int i = 0; i < 120; ++i) {
                    world.step(0.05);
                    const Ledger ledger = world.ledger();
                    const double unexplained = ledger.energy_by_cause.unexplained;
                    most = std::fmax(most, ledger.energy.kinetic);
                    share = std::fmax(share, std::abs(unexplained - before) / most);
                    before = unexplained;
                }
                report(carts, " carts, ", spin, " rad/s: without a cause ", share);
                largest = std::fmax(largest, share);
            }
        report("a step leaves at most ", largest, " of the energy without a cause");
        CHECK(largest < 1e-5);
    }

    // Sides that move by 70 m in a step tear wheels from their carts. What then turns about an axle far away
    // bends off by any way, and that work was granted to it: 16 carts came to 8e6 times this energy, and 48
    // bodies were lost.
    TEST_CASE_TEMPLATE("carts that a drum tears apart go no faster than it throws them", Real, float,
                       double) {
        constexpr double kCorner = 200, kSpin = 7;  // m, rad/s
        const Scene scene = carts_in_a_drum(16, kCorner, kSpin);
        double mass = 0, most = 0;  // kg, J
        for (const Body& body : scene.bodies)
            if (body.type == BodyType::dynamic_body) mass += body_mass_of(body).mass;
        BasicWorld<Real> world(scene, {.solver = Solver::soft});
        for (int i = 0; i < 200; ++i) {
            world.step(0.05);
            const Energy energy = world.ledger().energy;
            most = std::fmax(most, energy.kinetic + energy.rotational);
        }
        // A wall throws what comes as fast as itself by twice its speed.
        const double thrown = 0.5 * mass * 4 * kSpin * kSpin * kCorner * kCorner;
        report("carts have at most ", most / thrown, " of the energy of being thrown");
        CHECK(most < thrown);
        CHECK(world.profile().quarantined == 0);
    }

    // Half of gravity's kick at each end of a step was booked as what drag leaves of it, the kicks between as
    // all of it: a body that hangs still was pushed down in the books, in two seconds by .016 of the energy
    // that a step of free fall gives. Drag takes from velocities between substeps, which joints give back.
    TEST_CASE_TEMPLATE("what hangs still in a drag is displaced by nothing", Real, float, double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.drag = {.linear = 2, .angular = 0};
        scene.effects.ledger = true;
        const BodyId hung = scene.add(disc(0.5, 3, {1, 2}));
        scene.add(Joint{.b = hung, .kind = RevoluteJoint{.anchor = Vec2{1, 2}}});
        BasicWorld<Real> world(scene, {.solver = Solver::soft});
        for (int i = 0; i < 120; ++i) world.step(kStep);
        const EnergyByCause cause = world.ledger().energy_by_cause;
        const double fall = 3 * 10 * 0.5 * 10 * kStep * kStep;  // J, of one free step
        report("displacement works ", cause.correction / fall, " of the fall of a step, joints ",
               cause.joints / fall, ", drag ", cause.drag / fall);
        CHECK(std::abs(cause.correction) < 1e-6 * fall);
        CHECK(std::abs(cause.joints + cause.drag) < 1e-6 * fall);
        CHECK(std::abs(cause.unexplained) < 1e-6 * fall);
    }

    // Half of gravity's kick that a joined body has had when it is struck was taken off the work of joints,
    // not off that of gravity: joints seemed to give what displacement took.
    TEST_CASE_TEMPLATE("where what joints hold is struck, displacement has no work but that of overlaps",
                       Real, float, double) {
        double least = 0, most = 0;
        const double start = follow_chains<Real>(1, 2, [&](const EnergyByCause& cause) {
            least = std::fmin(least, cause.correction), most = std::fmax(most, cause.correction);
        });
        report("displacement works ", least / start, " to ", most / start, " of the energy");
        CHECK(least > -1e-3 * start);
        CHECK(most < 1e-3 * start);
    }

    // An impact within a substep was worked out with velocities that had a part of what joints give in it,
    // and changed those that have none of it: the difference was in no book, and was energy from nothing.
    TEST_CASE_TEMPLATE("where something of a long chain is struck, all of the energy has a cause", Real,
                       float, double) {
        CHECK(largest_without_cause<Real>(1, 24) < 1e-5);
    }

    // Hinges of a crowd that are open are closed within a substep, by displacement: the books took the arms
    // that bodies had after that for those at which the joints had acted.
    TEST_CASE_TEMPLATE("where chains of a crowd are struck and closed, all of the energy has a cause", Real,
                       float, double) {
        CHECK(largest_without_cause<Real>(2, 24) < 1e-5);
    }

    // A rod and a wall act at once, at a mean velocity away from the wall: the wall seemed to give a third of
    // the energy that there was, and the rod to take more than all of it.
    TEST_CASE_TEMPLATE("a wall gives no energy to what a rod draws back to it", Real, float, double) {
        for (const Shape& shape : {Shape{Box{1, 1}}, Shape{Disc{0.5}}}) {
            BasicWorld<Real> world(drawn_back(shape, {}), {.solver = Solver::soft});
            const double start = world.ledger().energy.kinetic;
            REQUIRE(start == doctest::Approx(5));
            double most = -start;
            for (int i = 0; i < 10; ++i) {
                world.step(kStep);
                most = std::fmax(most, world.ledger().energy_by_cause.restitution);
            }
            const Ledger ledger = world.ledger();
            const EnergyByCause& cause = ledger.energy_by_cause;
            CAPTURE(shape.index());
            CHECK(ledger.energy.kinetic < 1e-6 * start);  // the wall and the rod hold both
            CHECK(most < 1e-6 * start);
            CHECK(cause.joints + cause.restitution == doctest::Approx(-start));
            CHECK(cause.joints > -1.000001 * start);
        }
    }

    // A spring that is stretched by a metre pulls with 3,600 N and takes 20 J in the substep in which it
    // brings the two to rest or back: the wall seemed to give 7 J of these.
    TEST_CASE_TEMPLATE("a wall gives no energy to what a stretched spring draws back to it", Real, float,
                       double) {
        for (const Shape& shape : {Shape{Box{1, 1}}, Shape{Disc{0.5}}}) {
            const Scene scene = drawn_back(shape, {.length = 7.0, .frequency = 10});
            BasicWorld<Real> world(scene, {.solver = Solver::soft});
            constexpr double kRoundOff = 1e-6 * 1776;  // J
            double before = 0, most = 0;
            for (int i = 0; i < 10; ++i) {
                world.step(kStep);
                const double now = world.ledger().energy_by_cause.restitution;
                most = std::fmax(most, now - before), before = now;
            }
            CAPTURE(shape.index());
            report("the wall gives at most ", most, " J in a step");
            CHECK(most < kRoundOff);
            CHECK(std::abs(world.ledger().energy_by_cause.unexplained) < kRoundOff);
        }
    }
}

}  // namespace test_books
