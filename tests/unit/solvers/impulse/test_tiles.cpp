// Tiles: who works on one stays out of the way of who works on another at the same time, and does its own.
#include "solvers/impulse/impacts/tiles.hpp"

#include <carom/world.hpp>

#include "isa/kernel_table.hpp"
#include "isa/select_isa.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace test_tiles {

using namespace carom;

namespace {

/// Discs at random places of a box.
struct Crowd {
    std::size_t count;
    Column<float> x, y, reach;
    UniformGrid<float> grid;

    Crowd(std::size_t discs, double width, double height) : count(discs) {
        std::mt19937 random(3);
        for (Column<float>* column : {&x, &y, &reach}) column->resize(padded(count));
        for (std::size_t i = 0; i < count; ++i) {
            x[i] = static_cast<float>(width * static_cast<double>(random() % 100001) * 1e-5);
            y[i] = static_cast<float>(height * static_cast<double>(random() % 100001) * 1e-5);
            reach[i] = 0.7F;
        }
        grid.build({count, x.data(), y.data(), reach.data()}, select_kernels("auto").of<float>(), Executor());
    }
};

/// The lines that a line may be for another who counts them around, through rounding and at the ends of
/// lines.
constexpr std::int64_t kBeside = 2;

}  // namespace

TEST_SUITE("solvers/impulse/tiles") {
    TEST_CASE("what a tile may look at, no other of its phase may move") {
        struct Plane {
            std::size_t discs;
            double width, height;
        };
        for (const Plane& plane :
             {Plane{20'000, 200, 200}, Plane{40'000, 280, 280}, Plane{40'000, 2'000, 40},
              Plane{40'000, 40, 2'000}, Plane{300'000, 800, 800}, Plane{17'000, 190, 190}}) {
            CAPTURE(plane.discs);
            CAPTURE(plane.width);
            const Crowd crowd(plane.discs, plane.width, plane.height);
            Tiles tiles;
            tiles.begin(crowd.grid, plane.discs);
            const std::int64_t lines = tiles.line_of(1e9) + 1;
            std::size_t both = 0, looked_at = 0, own = 0, tiles_seen = 0;
            for (std::size_t phase = 0; phase < tiles.phases(); ++phase)
                for (std::size_t n = 0; n < tiles.tiles_of(phase); ++n) {
                    const std::size_t tile = tiles.tile(phase, n);
                    CHECK(tiles.phase_of(tile) == phase);
                    ++tiles_seen;
                    const TileReach& reach = tiles.reach(tile);
                    for (std::int64_t line = 0; line < lines; ++line) {
                        const double y =
                            (static_cast<double>(line) + 0.5) / static_cast<double>(lines) * plane.height;
                        if (tiles.tile_of({1, y}) == tile)
                            ++own, looked_at += reach.may_look(line - 1, line + 1);
                        if (!reach.may_look(line - 1, line + 1)) continue;
                        for (std::size_t other = 0; other < tiles.tiles_of(phase); ++other) {
                            if (other == n) continue;
                            const TileReach& of_other = tiles.reach(tiles.tile(phase, other));
                            for (std::int64_t at = line - 1 - kBeside; at <= line + 1 + kBeside; ++at)
                                both += of_other.owns((at + lines) % lines);
                        }
                    }
                }
            CHECK(both == 0);
            CHECK(tiles_seen == tiles.count());
            CHECK(own == static_cast<std::size_t>(lines));
            CHECK(looked_at == own);  // nothing is left for the end
        }
    }

    TEST_CASE("a batch that is read beyond a line ends where the tile may look") {
        // Lines with few discs: a batch spans several.
        const Crowd crowd(20'000, 12, 40'000);
        Tiles tiles;
        tiles.begin(crowd.grid, crowd.count);
        const GridLevel<float>& level = crowd.grid.level(0);
        REQUIRE(crowd.grid.level_count() == 1);
        if (level.numbering.wraps) return;
        std::size_t wrong = 0, looked_at = 0;
        const std::int64_t lines = level.cells / level.width;
        for (std::size_t tile = 0; tile < tiles.count(); ++tile)
            for (std::int64_t line = 1; line + 4 < lines; ++line) {
                if (!tiles.reach(tile).may_look(line - 1, line + 1)) continue;
                ++looked_at;
                const auto last =
                    static_cast<std::size_t>(level.bodies.cell_begin[(line + 2) * level.width]) + 15;
                if (last >= level.places) continue;
                const std::int64_t of_last = level.bodies.cell[last] / level.width;
                for (std::size_t other = tile % 2; other < tiles.count(); other += 2)
                    wrong += other != tile && tiles.reach(other).owns(of_last);
            }
        CHECK(wrong == 0);
        CHECK(looked_at > 1000);
    }

    TEST_CASE_TEMPLATE(
        "discs that cross many tiles in a step keep energy and momentum, and meet what they hit", Real, float,
        double) {
        Scene scene;
        std::mt19937 random(5);
        constexpr int kSide = 150;
        for (int i = 0; i < kSide; ++i)
            for (int k = 0; k < kSide; ++k) {
                Body body{.shape = Disc{0.4}, .position = {1.5 * i, 1.5 * k}, .material = {.restitution = 1}};
                body.velocity = {static_cast<double>(random() % 1000) * 1e-3 - 0.5,
                                 static_cast<double>(random() % 1000) * 1e-3 - 0.5};
                if ((i * kSide + k) % 1000 == 500) body.velocity = {0.1, i % 2 == 0 ? 6'000.0 : -6'000.0};
                scene.add(body);
            }
        scene.accuracy.solver = Solver::impulse;
        BasicWorld<Real> world(scene, {.threads = 2}), alone(scene, {.threads = 1});
        const auto energy = [&] {
            double sum = 0;
            const auto bodies = world.bodies();
            for (std::size_t i = 0; i < bodies.count; ++i)
                sum += static_cast<double>(bodies.velocity_x[i]) * static_cast<double>(bodies.velocity_x[i]) +
                       static_cast<double>(bodies.velocity_y[i]) * static_cast<double>(bodies.velocity_y[i]);
            return sum;
        };
        const double before = energy();
        for (int step = 0; step < 4; ++step) world.step(0.01), alone.step(0.01);
        CHECK(std::fabs(energy() / before - 1) < 1e4 * std::numeric_limits<Real>::epsilon());
        CHECK(world.state_hash() == alone.state_hash());
        CHECK(world.profile().impacts > 500);
        CHECK(world.profile().unresolved_impacts == 0);
        CHECK(world.profile().impacts == alone.profile().impacts);
    }

    TEST_CASE("the ledger of a gas in tiles closes, whatever the number of threads") {
        Scene scene;
        constexpr int kSide = 150;
        std::mt19937 random(6);
        for (int i = 0; i < kSide; ++i)
            for (int k = 0; k < kSide; ++k) {
                Body body{.shape = Disc{0.5}, .position = {1.3 * i, 1.3 * k}, .material = {.restitution = 1}};
                body.velocity = {static_cast<double>(random() % 1000) * 6e-3 - 3,
                                 static_cast<double>(random() % 1000) * 6e-3 - 3};
                body.material.friction = 0.4, body.material.restitution = 0.9;
                scene.add(body);
            }
        scene.walls.emplace();
        scene.walls->min = {-0.6, -0.6}, scene.walls->max = {1.3 * kSide - 0.7, 1.3 * kSide - 0.7};
        scene.accuracy.solver = Solver::impulse;
        WorldOptions one{.threads = 1}, two{.threads = 2};
        one.effects.ledger = two.effects.ledger = true;
        World64 world(scene, two), alone(scene, one);
        for (int step = 0; step < 6; ++step) world.step(1.0 / 60), alone.step(1.0 / 60);
        const Ledger of_two = world.ledger(), of_one = alone.ledger();
        const EnergyByCause &two_causes = of_two.energy_by_cause, &one_causes = of_one.energy_by_cause;
        CHECK(two_causes.restitution == one_causes.restitution);
        CHECK(two_causes.friction == one_causes.friction);
        CHECK(of_two.wall_impulse == of_one.wall_impulse);
        CHECK(one_causes.restitution < 0);
        CHECK(one_causes.friction < 0);
        CHECK(of_one.wall_impulse > 0);
        CHECK(std::fabs(two_causes.unexplained) < 1e-10 * of_two.initial.kinetic);
    }
}

}  // namespace test_tiles
