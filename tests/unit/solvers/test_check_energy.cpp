// The check of energies behind a step (solvers/shared/check_energy.hpp), on books and columns that are
// written by hand.
#include "solvers/shared/check_energy.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "support/inside.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

namespace test_check_energy {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kMass = 2;                           // kg
constexpr double kAtStart = 0.5 * kMass * (3.0 * 3);  // J

/// A disc of 2 kg that flies at 3 m/s, and what else is asked for.
template <class Real>
struct Inside {
    explicit Inside(Vec2 gravity = {}, const Body* more = nullptr) {
        Scene scene;
        scene.gravity = gravity;
        scene.effects.ledger = true;
        scene.add(disc(0.5, kMass, {0, 0}, {3, 0}));
        if (more) scene.add(*more);
        simulation = inside_of<Real>(scene, Solver::soft);
        check();
    }
    void check() { check_energy(world(), 1, {}); }
    WorldState<Real>& world() { return simulation->world; }
    Books& books() { return simulation->world.books; }
    const EnergyExcess& excess() { return simulation->world.energy_watch.largest; }

    std::unique_ptr<Simulation<Real>> simulation;
};

/// What rounding explains of a substep [J]. @param energy  J, the sizes of its parts
template <class Real>
double round_off(double energy) {
    return 40 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * energy;
}

doctest::Approx close_to(double value) {
    return doctest::Approx(value).epsilon(1e-12);
}

}  // namespace

TEST_SUITE("solvers/check energy") {
    TEST_CASE_TEMPLATE("what restitution gives in a step is excess but for rounding; the most is kept", Real,
                       float, double) {
        Inside<Real> inside;
        CHECK(inside.excess().restitution == 0);
        inside.books().restitution -= 5;
        inside.check();
        CHECK(inside.excess().restitution == 0);
        inside.books().restitution += 1;
        inside.check();
        CHECK(inside.excess().restitution == close_to(1 - round_off<Real>(kAtStart)));
        inside.books().restitution += 0.5;
        inside.check();
        CHECK(inside.excess().restitution == close_to(1 - round_off<Real>(kAtStart)));
        CHECK(inside.excess().correction == 0);
        CHECK(inside.excess().passive == 0);
    }

    TEST_CASE_TEMPLATE("pushes may lift by what overlaps are worth and by what contacts take in the step",
                       Real, float, double) {
        Inside<Real> inside;
        inside.books().correction += 3, inside.books().overlap_worth = 3;
        inside.check();
        CHECK(inside.books().overlap_worth == 0);
        CHECK(inside.excess().correction == 0);
        inside.books().correction += 3;
        inside.books().restitution -= 1, inside.books().friction -= 1.5, inside.books().joints -= 0.5;
        inside.check();
        CHECK(inside.excess().correction == 0);
        inside.books().correction += 3, inside.books().overlap_worth = 0.5, inside.books().friction -= 0.25;
        inside.check();
        CHECK(inside.excess().correction == close_to(2.25 - round_off<Real>(kAtStart)));
    }

    TEST_CASE_TEMPLATE("a passive world may not have more energy than at its start", Real, float, double) {
        Inside<Real> inside({0, -10});
        inside.world().bodies.velocity_x[0] = 2;
        inside.world().bodies.position_y[0] = Real(0.25);  // 5 J in place of 5 J
        inside.check();
        CHECK(inside.excess().passive == 0);
        inside.world().bodies.position_y[0] = 1;  // 15 J more
        inside.check();
        // Rounding counts for three steps: 9 J of motion, then 4 J and 5 J of height, then 4 J and 20 J.
        CHECK(inside.excess().passive == close_to(15 - round_off<Real>(kAtStart + 9 + 24)));
        inside.world().bodies.position_y[0] = 0;
        inside.check();
        CHECK(inside.excess().passive == close_to(15 - round_off<Real>(kAtStart + 9 + 24)));
    }

    TEST_CASE_TEMPLATE("spin is energy", Real, float, double) {
        Body top = disc(0.5, 4, {5, 0});
        top.angular_velocity = 1;
        Inside<Real> inside({}, &top);
        inside.world().bodies.angular_velocity[1] = 3;  // of m r² / 2 = .5 kg m²: 2.25 J in place of .25
        inside.check();
        CHECK(inside.excess().passive == close_to(2 - round_off<Real>(2 * kAtStart + 0.25 + 2.25)));
    }

    TEST_CASE_TEMPLATE("what calls bring counts as there, and what they leave is the start", Real, float,
                       double) {
        Inside<Real> inside;
        inside.world().bodies.velocity_x[0] = 1;  // 8 J are lost
        inside.check();
        inside.world().bodies.velocity_x[0] = 2;
        inside.world().bring({.energy = {.kinetic = 3}, .momentum = {}});  // as World::set_velocity books it
        inside.check();
        CHECK(inside.excess().passive == 0);
        inside.world().bodies.velocity_x[0] = Real(2.5);  // less than at the start, but 2.25 J more than then
        inside.check();
        CHECK(inside.excess().passive == close_to(2.25 - round_off<Real>(4 + 6.25)));
    }

    TEST_CASE_TEMPLATE("calls that bring and take much leave its rounding", Real, float, double) {
        Inside<Real> inside;
        inside.world().bodies.velocity_x[0] = 0;
        inside.check();
        inside.world().bring({.energy = {.kinetic = 1e6}, .momentum = {}});
        inside.world().bring({.energy = {.kinetic = -1e6 - 1e-10}, .momentum = {}});
        inside.check();
        CHECK(inside.excess().passive == 0);
        inside.world().bring(
            {.energy = {.kinetic = -1e-10}, .momentum = {}});  // much is of the last step's calls alone
        inside.check();
        CHECK(inside.excess().passive == doctest::Approx(1e-10).epsilon(0.01));
    }

    TEST_CASE_TEMPLATE("what overlaps are worth that a world begins with may lift it once", Real, float,
                       double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.effects.ledger = true;
        scene.add(disc(0.5, kMass, {0, 0}));
        const auto simulation = inside_of<Real>(scene, Solver::soft);
        WorldState<Real>& world = simulation->world;
        const auto lift_to = [&](double height, double worth) {
            world.books.correction += kMass * 10 * (height - static_cast<double>(world.bodies.position_y[0]));
            world.bodies.position_y[0] = static_cast<Real>(height), world.books.overlap_worth = worth;
            check_energy(world, 1, {});
        };
        lift_to(0.5, 20);
        lift_to(1, 10);
        CHECK(world.energy_watch.largest.passive == 0);
        lift_to(1.5, 10);  // each step is within its worth, but there was no such overlap at the start
        CHECK(world.energy_watch.largest.correction == 0);
        CHECK(world.energy_watch.largest.passive == close_to(10 - round_off<Real>(10 + 20 + 30)));
    }

    TEST_CASE_TEMPLATE("a world with a kinematic body that moves is not passive while it does", Real, float,
                       double) {
        Body drum = disc(0.5, 1, {5, 0});
        drum.type = BodyType::kinematic_body, drum.angular_velocity = 2;
        Inside<Real> inside({}, &drum);
        inside.world().bodies.velocity_x[0] = 5;
        inside.check();
        CHECK(inside.excess().passive == 0);
        inside.world().bodies.angular_velocity[1] = 0;  // it stands, with 25 J in the world
        inside.check();
        CHECK(inside.excess().passive == 0);
        inside.world().bodies.velocity_x[0] = 6;
        inside.check();
        CHECK(inside.excess().passive == close_to(11 - round_off<Real>(25 + 36)));
    }
}

}  // namespace test_check_energy
