// Worlds in which most of what there is has nothing to do with what moves: static bodies in great numbers,
// long terrains, and motion that all bodies share (docs/decisions/0033-costs-of-strangers.md).
#include "math/random.hpp"
#include "math/vec2_math.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace test_strangers {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// Static discs in a square lattice, 1.5 m apart.
void add_pegs(Scene& scene, int count, Vec2 corner, const Material& material) {
    const int columns = static_cast<int>(std::ceil(std::sqrt(count)));
    for (int i = 0; i < count; ++i)
        scene.add({.type = BodyType::static_body,
                   .shape = Disc{0.5},
                   .position = corner + Vec2{1.5 * (i % columns), 1.5 * (i / columns)},
                   .material = material});
}

/// 100 elastic discs in a box of their own.
Scene gas_beside(int strangers, Solver solver) {
    Scene scene = gas_scene({.count = 100, .packing_fraction = 0.2});
    scene.accuracy.solver = solver;
    scene.walls->right = scene.walls->top = false;
    scene.walls->max = {4000, 4000};
    add_pegs(scene, strangers, {200, 200}, bouncy(1));
    return scene;
}

/// Balls among pegs that stand closer to each other than to let them through, in a box.
constexpr int kPegs = 1600, kBalls = 60;
constexpr double kWidth = 60;
Scene pegs_and_balls(Solver solver) {
    const Material material{.friction = solver == Solver::soft ? 0.3 : 0.0, .restitution = 0.3};
    Scene scene;
    scene.accuracy.solver = solver;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {-2, -2}, .max = {kWidth + 2, 400}, .top = false, .material = material};
    add_pegs(scene, kPegs, {0, 0}, material);
    Random random(2);
    for (int i = 0; i < kBalls; ++i)
        scene.add({.shape = Disc{random.uniform(0.4, 0.6)},
                   .position = {1 + 2.9 * (i % 20), 62 + 1.5 * (i / 20)},
                   .material = material});
    return scene;
}

/// Takes pegs and balls away, puts them elsewhere and adds others: the same for the same numbers.
template <class Real>
class Touches {
  public:
    void touch(BasicWorld<Real>& world) {
        std::vector<BodyId> ids(world.bodies().id.begin(), world.bodies().id.end());
        std::sort(ids.begin(), ids.end(), [](BodyId a, BodyId b) { return a.index < b.index; });
        const BodyId body = ids[random_.below(ids.size())];
        const bool is_peg = random_.below(2) == 0;
        switch (random_.below(3)) {
            case 0:
                world.remove(body);
                break;
            case 1:
                world.add({.type = is_peg ? BodyType::static_body : BodyType::dynamic_body,
                           .shape = Disc{0.5},
                           .position = free_place(world),
                           .material = {.restitution = 0.3}});
                break;
            case 2:
                world.set_position(body, free_place(world));
                break;
        }
    }

  private:
    Vec2 free_place(const BasicWorld<Real>& world) {
        for (;;) {
            const Vec2 place{random_.uniform(0, kWidth), random_.uniform(62, 90)};
            const auto bodies = world.bodies();
            bool is_free = true;
            for (std::size_t i = 0; i < bodies.count; ++i)
                is_free &= std::hypot(bodies.position_x[i] - place.x, bodies.position_y[i] - place.y) > 1.3;
            if (is_free) return place;
        }
    }
    Random random_{7};
};

/// Hills from right to left, so that their upper side is outside: `points` of them, half a metre apart, from
/// number `first` on.
Scene discs_on_hills(int first, int points, const std::vector<double>& places) {
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = {0, -10};
    std::vector<Vec2> hills;
    for (int i = first + points - 1; i >= first; --i)
        hills.push_back({0.5 * i, 2 * std::sin(0.05 * i) + 0.2 * std::sin(0.9 * i)});
    scene.add({.type = BodyType::static_body, .shape = Chain{hills}, .material = {.friction = 0.5}});
    for (std::size_t k = 0; k < places.size(); ++k)
        scene.add({.shape = Disc{0.4 + 0.01 * static_cast<double>(k)},
                   .position = {places[k], 4 + static_cast<double>(k)},
                   .velocity = {k % 3 == 0 ? 3.0 : 0.0, k % 4 == 0 ? -90.0 : 0.0},
                   .material = {.friction = 0.5}});
    return scene;
}

/// 200 discs side by side, all but at rest beside each other.
Scene falling_together(double speed) {
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = {0, -10};
    for (int i = 0; i < 200; ++i)
        scene.add({.shape = Disc{0.5},
                   .position = {1.1 * (i % 10), 1.1 * (i / 10)},
                   .velocity = {0.1 * std::sin(1.7 * i), speed + 0.1 * std::sin(3.1 * i)},
                   .material = {.friction = 0.5}});
    return scene;
}

}  // namespace

TEST_SUITE("hard cases/strangers") {
    TEST_CASE_TEMPLATE("static bodies far away change no bit of a gas, and none of its candidate pairs", Real,
                       float, double) {
        for (const Solver solver : {Solver::impulse, Solver::soft}) {
            CAPTURE(static_cast<int>(solver));
            BasicWorld<Real> alone(gas_beside(0, solver), {.threads = 1}),
                beside(gas_beside(3000, solver), {.threads = 1});
            for (int i = 0; i < 60; ++i) {
                alone.step(kStep), beside.step(kStep);
                for (std::uint32_t body = 0; body < 100; ++body) {
                    const BodyState a = alone.state({body, 0}), b = beside.state({body, 0});
                    REQUIRE(a.position.x == b.position.x);
                    REQUIRE(a.position.y == b.position.y);
                }
            }
            CHECK(alone.profile().rebuilds * 2 >= beside.profile().rebuilds);
            CHECK(alone.profile().candidate_pairs * 2 + 20 >= beside.profile().candidate_pairs);
        }
    }

    // A pair that was not found would let a ball through a peg.
    TEST_CASE_TEMPLATE("balls meet pegs that stand, come, go and are put elsewhere", Real, float, double) {
        for (const Solver solver : {Solver::soft, Solver::impulse}) {
            CAPTURE(static_cast<int>(solver));
            BasicWorld<Real> world(pegs_and_balls(solver), {.threads = 1});
            Touches<Real> touches;
            double deepest = 0;
            for (int i = 0; i < 400; ++i) {
                if (i > 100 && i < 300) touches.touch(world);
                world.step(kStep);
                if (i % 4 == 0) deepest = std::max(deepest, world.overlaps().max);
            }
            report("overlap ", deepest);
            CHECK(deepest < 0.1);
            CHECK(world.quarantined().empty());
            double lowest = HUGE_VAL;
            for (std::uint32_t body = kPegs; body < kPegs + kBalls; ++body) {
                try {
                    lowest = std::min(lowest, world.state({body, 0}).position.y);
                } catch (const Error&) {  // it was removed
                }
            }
            CHECK(lowest > 50);  // none has got through
        }
    }

    TEST_CASE_TEMPLATE("a world with many static bodies goes on bit for bit from a saved state", Real, float,
                       double) {
        for (const Solver solver : {Solver::soft, Solver::impulse}) {
            BasicWorld<Real> world(pegs_and_balls(solver), {.threads = 1});
            Touches<Real> touches;
            for (int i = 0; i < 60; ++i) world.step(kStep);
            for (int i = 0; i < 20; ++i) touches.touch(world), world.step(kStep);
            touches.touch(world);
            BasicWorld<Real> other(world);
            Touches<Real> same(touches);
            for (int i = 0; i < 40; ++i) {
                world.step(kStep), other.step(kStep);
                REQUIRE(world.state_hash() == other.state_hash());
                if (i % 3 == 0) touches.touch(world), same.touch(other);
            }
        }
    }

    TEST_CASE(
        "a world with many static bodies has the same bits for any number of threads and instruction set") {
        for (const Solver solver : {Solver::soft, Solver::impulse}) {
            const auto hash = [&](int threads, const std::string& isa) {
                World world(pegs_and_balls(solver), {.isa = isa, .threads = threads});
                Touches<float> touches;
                for (int i = 0; i < 150; ++i) {
                    if (i > 90 && i % 4 == 0) touches.touch(world);
                    world.step(kStep);
                }
                return world.state_hash();
            };
            const std::uint64_t wanted = hash(1, "auto");
            CHECK(hash(3, "auto") == wanted);
            for (const std::string& isa : runnable_instruction_sets()) CHECK(hash(1, isa) == wanted);
        }
    }

    TEST_CASE_TEMPLATE("boxes rest on tiles of thousands", Real, float, double) {
        const Material rough{.friction = 0.5};
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.gravity = {0, -10};
        for (int i = 0; i < 2000; ++i)
            scene.add({.type = BodyType::static_body,
                       .shape = Box{2, 2},
                       .position = {2.0 * (i % 500) - 500, -1 - 20.0 * (i / 500)},
                       .material = rough});
        for (int i = 0; i < 30; ++i)
            scene.add({.shape = i % 2 == 0 ? Shape{Box{1, 0.8}} : Shape{Disc{0.5}},
                       .position = {90.0 * (i % 10) - 450, 0.6 + 1.2 * (i / 10)},
                       .material = rough});
        BasicWorld<Real> world(scene, {.threads = 1});
        for (int i = 0; i < 300; ++i) world.step(kStep);
        double lowest = HUGE_VAL;
        for (std::uint32_t body = 2000; body < 2030; ++body)
            lowest = std::min(lowest, world.state({body, 0}).position.y);
        CHECK(lowest > 0.39);
        CHECK(world.overlaps().max <
              0.016);  // contacts of shapes leave .015 inradii: docs/how-a-step-works.md
    }

    TEST_CASE("a ball rests on a peg of thousands that is added, and falls when it is removed") {
        Scene scene = gas_beside(3000, Solver::soft);
        scene.gravity = {0, -10};
        World world(scene, {.threads = 1});
        for (int i = 0; i < 5; ++i) world.step(kStep);
        const BodyId peg =
            world.add({.type = BodyType::static_body, .shape = Disc{5}, .position = {1000, 1000}});
        const BodyId ball = world.add({.shape = Disc{0.5}, .position = {1000, 1006}, .material = {}});
        for (int i = 0; i < 120; ++i) world.step(kStep);
        CHECK(world.state(ball).position.y == doctest::Approx(1005.5).epsilon(1e-5));
        world.set_position(peg, {1000, 999.9});
        for (int i = 0; i < 60; ++i) world.step(kStep);
        CHECK(world.state(ball).position.y == doctest::Approx(1005.4).epsilon(1e-5));
        world.remove(peg);
        for (int i = 0; i < 60; ++i) world.step(kStep);
        CHECK(world.state(ball).position.y < 1001);
    }

    TEST_CASE_TEMPLATE(
        "a heap beside thousands of static bodies sleeps, wakes and sleeps, and these stay in place", Real,
        float, double) {
        constexpr std::uint32_t kHeap = 60, kStrangers = 3000;
        const Material rough{.friction = 0.5, .rolling_resistance = 0.05};
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.effects.sleep = true;
        scene.gravity = {0, -10};
        scene.walls = Walls{.min = {-20, 0}, .max = {4000, 4000}, .material = rough};
        for (std::uint32_t i = 0; i < kHeap; ++i)
            scene.add(
                {.shape = Disc{0.5}, .position = {1.1 * (i % 10), 0.5 + 1.0 * (i / 10)}, .material = rough});
        add_pegs(scene, kStrangers, {200, 200}, rough);
        BasicWorld<Real> world(scene, {.threads = 1});
        const auto steps = [&](int count) {
            for (int i = 0; i < count; ++i) world.step(kStep);
            std::size_t moved = 0;
            for (std::uint32_t body = kHeap + 1; body < kHeap + kStrangers; ++body) {
                const Vec2 place = world.state({body, 0}).position, before = scene.bodies[body].position;
                moved += static_cast<Real>(before.x) != static_cast<Real>(place.x) ||
                         static_cast<Real>(before.y) != static_cast<Real>(place.y);
            }
            CHECK(moved == 0);
            CHECK(world.overlaps().max < 0.02);
        };
        steps(900);
        CHECK(world.profile().asleep == kHeap);
        const BodyId ball = world.add({.shape = Disc{0.5}, .position = {5, 12}, .material = rough});
        world.add({.type = BodyType::static_body, .shape = Disc{1}, .position = {900, 900}});
        CHECK(world.state(ball).position.y == 12);
        steps(100);
        CHECK(world.profile().islands_woken > 0);
        world.set_velocity(ball, {3, 0});
        steps(1200);  // the last of 24 balls like this one, elsewhere, let its heap sleep after 1,160
        CHECK(world.profile().asleep == kHeap + 1);
        world.remove({kHeap, 0});  // one of those that stand
        world.remove({3, 0});
        steps(60);
        BasicWorld<Real> other(world);
        for (int i = 0; i < 300; ++i) world.step(kStep), other.step(kStep);
        CHECK(world.state_hash() == other.state_hash());
        steps(0);
    }

    TEST_CASE_TEMPLATE("discs at the ends of a terrain of 20,000 points move as on a short one, bit for bit",
                       Real, float, double) {
        constexpr int kPoints = 20000, kPiece = 2000;
        for (const int first : {0, kPoints / 2, kPoints - kPiece}) {
            std::vector<double> places;
            for (int k = 0; k < 30; ++k) places.push_back(0.5 * first + 440 + 4 * k);
            BasicWorld<Real> whole(discs_on_hills(0, kPoints, places), {.threads = 1}),
                piece(discs_on_hills(first, kPiece, places), {.threads = 1});
            double lowest = HUGE_VAL;
            for (int i = 0; i < 240; ++i) {
                whole.step(kStep), piece.step(kStep);
                for (std::uint32_t body = 1; body <= places.size(); ++body) {
                    const BodyState a = whole.state({body, 0}), b = piece.state({body, 0});
                    REQUIRE(a.position.x == b.position.x);
                    REQUIRE(a.position.y == b.position.y);
                    lowest = std::min(lowest, a.position.y);
                }
            }
            CHECK(lowest > -2.5);  // they lie on it
        }
    }

    TEST_CASE_TEMPLATE("discs that fall side by side are each other's contacts no more than at rest", Real,
                       float, double) {
        BasicWorld<Real> slow(falling_together(0), {.threads = 1}),
            fast(falling_together(-150), {.threads = 1});
        double off = 0;
        std::int64_t most_slow = 0, most_fast = 0;
        for (int i = 1; i <= 60; ++i) {
            slow.step(kStep), fast.step(kStep);
            most_slow = std::max(most_slow, slow.profile().contacts);
            most_fast = std::max(most_fast, fast.profile().contacts);
            for (std::uint32_t body = 0; body < 200; ++body) {
                const Vec2 apart = fast.state({body, 0}).position - slow.state({body, 0}).position;
                off = std::max(off, std::hypot(apart.x, apart.y + 150 * kStep * i));
            }
        }
        report(most_slow, " contacts at rest, ", most_fast, " at 150 m/s; off by ", off, " m");
        CHECK(most_fast <= 2 * most_slow + 20);
        CHECK(fast.profile().candidate_pairs < 3 * slow.profile().candidate_pairs);
        CHECK(off < 0.05);
    }

    TEST_CASE_TEMPLATE("discs that fall side by side at 150 m/s do not pass a floor or each other", Real,
                       float, double) {
        for (const bool is_chain : {false, true}) {
            Scene scene = falling_together(-150);
            if (is_chain)
                scene.add({.type = BodyType::static_body,
                           .shape = Chain{.points = {{9000, -50}, {20, -50}, {-10, -50}, {-9000, -50}}},
                           .material = {.friction = 0.5}});
            else
                scene.walls = Walls{.min = {-200, -50},
                                    .max = {200, 900},
                                    .left = false,
                                    .right = false,
                                    .top = false,
                                    .material = {.friction = 0.5}};
            BasicWorld<Real> world(scene, {.threads = 1});
            for (int i = 0; i < 600; ++i) world.step(kStep);
            double lowest = HUGE_VAL;
            for (std::uint32_t body = 0; body < 200; ++body)
                lowest = std::min(lowest, world.state({body, 0}).position.y);
            CAPTURE(is_chain);
            CHECK(lowest > -49.6);
            CHECK(world.overlaps().max < 0.05);
        }
    }
}

}  // namespace test_strangers
