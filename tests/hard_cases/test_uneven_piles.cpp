// B41 of docs/hard-cases.md: heavy and light discs mixed in a pile, and a heavy one on a column of light
// ones.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "math/random.hpp"
#include "torture/energy_rule.hpp"

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kRadius = 0.5, kStep = 1.0 / 60;
constexpr int kSteps = 240;

enum class Masses { two, log_uniform };

struct Pile {
    int columns = 20;  // discs in a row and a column of the lattice that falls
    double ratio = 1e6;
    Masses masses = Masses::two;  // half of the discs at random are heavy, or all between
    double friction = 0.5, restitution = 0;
    std::uint64_t seed = 1;
};

/// A loose lattice in an open box, each disc a little aside.
Scene pile_scene(const Pile& pile) {
    constexpr double kPitch = 2.1 * kRadius, kAside = 0.04;
    Scene scene;
    scene.gravity = {0, -10};
    scene.accuracy.solver = Solver::soft;
    scene.walls = Walls{.min = {0, 0}, .max = {pile.columns * kPitch, 1e4}, .top = false};
    scene.walls->material = {.friction = pile.friction, .restitution = pile.restitution};
    Random random(pile.seed);
    for (int row = 0; row < pile.columns; ++row)
        for (int column = 0; column < pile.columns; ++column) {
            const double x = (column + 0.5) * kPitch + kAside * (random.uniform() - 0.5),
                         y = (row + 0.5) * kPitch + kAside * (random.uniform() - 0.5), u = random.uniform();
            const double mass =
                pile.masses == Masses::two ? (u < 0.5 ? pile.ratio : 1) : std::pow(pile.ratio, u);
            Body body = disc(kRadius, mass, {x, y});
            body.material = {.friction = pile.friction, .restitution = pile.restitution};
            scene.add(body);
        }
    return scene;
}

/// A pile falls and comes to lie: nothing is lost, energy never rises, and in the last quarter nothing is
/// deep in another. @return the largest overlap in that time
template <class Real>
double overlap_of_settled(const Pile& pile, int steps) {
    BasicWorld<Real> world(pile_scene(pile), {.threads = 1});
    const double start = world.ledger().energy.total();
    double highest = start, settled = 0, ever = 0;
    for (int i = 0; i < steps; ++i) {
        world.step(kStep);
        highest = std::max(highest, world.ledger().energy.total());
        if (i % 5 > 0) continue;
        const double overlap = world.overlaps().max;
        ever = std::max(ever, overlap);
        if (4 * i >= 3 * steps) settled = std::max(settled, overlap);
    }
    report(pile.columns * pile.columns, " discs, ratio ", pile.ratio,
           pile.masses == Masses::two ? ", half of them heavy" : ", all between", ", friction ",
           pile.friction, ", restitution ", pile.restitution, ", seed ", pile.seed, ": overlap at most ",
           ever, ", settled ", settled, " radii, energy at most ", highest / start);
    CHECK(world.quarantined().empty());
    CHECK(torture::keeps_energy_rule(highest, start));
    return settled;
}

/// Tasks one by one, the last first.
void in_reverse(std::size_t count, const std::function<void(std::size_t)>& task) {
    while (count-- > 0) task(count);
}

}  // namespace

TEST_SUITE("hard cases/uneven piles") {
    TEST_CASE_TEMPLATE("B41: heavy and light discs mixed at random make a pile", Real, float, double) {
        const int columns = scaled(20, 7);
        for (const double ratio : {1e3, 1e4})
            if (ratio > 1e3 || !is_effort_reduced())
                CHECK(overlap_of_settled<Real>({.columns = columns, .ratio = ratio}, kSteps) < 0.1);
        for (std::uint64_t seed = 1; seed <= scaled<std::uint64_t>(3, 1); ++seed)
            CHECK(overlap_of_settled<Real>({.columns = columns, .seed = seed}, kSteps) < 0.1);
        CHECK(overlap_of_settled<Real>({.columns = columns, .masses = Masses::log_uniform}, kSteps) < 0.1);
        CHECK(overlap_of_settled<Real>({.columns = columns, .restitution = 0.3}, kSteps) < 0.1);
    }

    TEST_CASE_TEMPLATE("B41: without friction light discs are squeezed out, and nothing is lost", Real, float,
                       double) {
        const int columns = scaled(20, 10);
        for (std::uint64_t seed = 1; seed <= scaled<std::uint64_t>(2, 1); ++seed)
            overlap_of_settled<Real>({.columns = columns, .friction = 0, .seed = seed}, kSteps);
        overlap_of_settled<Real>({.columns = columns, .masses = Masses::log_uniform, .friction = 0}, kSteps);
    }

    TEST_CASE_TEMPLATE("B41: twenty light discs carry one that is a million times heavier", Real, float,
                       double) {
        constexpr int kLight = 20;
        Scene scene;
        scene.gravity = {0, -10};
        scene.accuracy.solver = Solver::soft;
        scene.walls = Walls{.min = {-1.001 * kRadius, 0}, .max = {1.001 * kRadius, 100}, .top = false};
        for (int i = 0; i <= kLight; ++i)
            scene.add(disc(kRadius, i < kLight ? 1 : 1e6, {0, kRadius + 2 * kRadius * i}));
        BasicWorld<Real> world(scene, {.threads = 1});
        const double start = world.ledger().energy.total(), top = kRadius + 2 * kRadius * kLight;
        double deepest = 0, highest = start;
        for (int i = 0; i < 600; ++i) {
            world.step(kStep);
            deepest = std::max(deepest, top - world.state({kLight, 0}).position.y);
            highest = std::max(highest, world.ledger().energy.total());
        }
        report("sink ", 100 * deepest / (2 * kRadius), " % of a diameter, energy at most ", highest / start);
        CHECK(deepest < 0.05 * 2 * kRadius);
        CHECK(torture::keeps_energy_rule(highest, start));
    }

    TEST_CASE_TEMPLATE("B37: a disc that is squeezed beside a pile of uneven masses is not lost", Real, float,
                       double) {
        // A kinematic disc comes into the corner where a light one lies: there is no room for both.
        constexpr double kDistance = 2.5;  // m, of the two at the start
        for (const double speed : {0.25, 2.5})
            for (const double angle : {0.2, 0.785, 1.2}) {
                if (is_effort_reduced() && speed < 1 && angle != 0.785) continue;  // 600 steps each
                CAPTURE(speed);
                CAPTURE(angle);
                Scene scene = pile_scene({.columns = 6, .ratio = 1e4});
                for (Body& body : scene.bodies) body.position.x += 4;
                scene.walls->max.x += 4;
                const BodyId squeezed = scene.add(disc(kRadius, 1, {kRadius, kRadius}));
                const Vec2 towards{-std::cos(angle), -std::sin(angle)};
                Body pusher =
                    disc(kRadius, 1, {kRadius - kDistance * towards.x, kRadius - kDistance * towards.y});
                pusher.type = BodyType::kinematic_body, pusher.mass.reset();
                pusher.velocity = {speed * towards.x, speed * towards.y};
                scene.add(pusher);
                BasicWorld<Real> world(scene, {.threads = 1});
                bool is_inside = true;
                while (world.time() < kDistance / speed) {
                    world.step(kStep);
                    const BodyState state = world.state(squeezed);
                    is_inside = is_inside && state.position.x > 0 && state.position.y > 0;
                }
                CHECK(world.quarantined().empty());
                CHECK(is_inside);
            }
    }

    TEST_CASE("B41: the same bits with the tasks in another order, and after a restored state") {
        const Scene scene = pile_scene({.columns = 8});
        World world(scene, {.threads = 1});
        World other(scene, {.threads = 2, .parallel_for = in_reverse});
        for (int i = 0; i < 60; ++i) world.step(kStep), other.step(kStep);
        World restored(world);
        for (int i = 0; i < 30; ++i) world.step(kStep), other.step(kStep), restored.step(kStep);
        CHECK(world.state_hash() == other.state_hash());
        CHECK(world.state_hash() == restored.state_hash());
    }
}
