#include "broadphase/grid/uniform_grid.hpp"

#include "isa/select_isa.hpp"
#include "support/effort.hpp"

#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace test_uniform_grid {

using carom::CandidatePairs;
using carom::Column;
using carom::Executor;
using carom::GridInput;
using carom::KernelTable;
using carom::UniformGrid;

namespace {

/// A world as the broadphase sees it.
template <class Real>
struct Bodies {
    Column<Real> x, y, reach;
    Column<std::uint8_t> flags;

    void add(double at_x, double at_y, double with_reach, std::uint8_t with_flags = 0) {
        x.push_back(static_cast<Real>(at_x));
        y.push_back(static_cast<Real>(at_y));
        reach.push_back(static_cast<Real>(with_reach));
        flags.push_back(with_flags);
    }
    std::size_t count() const { return x.size(); }
    /// Bodies from the row `moving` on stand.
    GridInput<Real> input_with_standing(std::size_t moving, bool are_known) const {
        GridInput<Real> all = input();
        all.standing = count() - moving, all.is_standing_known = are_known;
        return all;
    }
    GridInput<Real> input() const { return {count(), x.data(), y.data(), reach.data(), flags.data()}; }
};

using Pair = std::pair<std::int32_t, std::int32_t>;

enum class Near { no, yes, rounding_decides };

/// Independent of the engine's formula: in long double, with a band where rounding in Real may decide either
/// way.
template <class Real>
Near is_near(const Bodies<Real>& bodies, std::size_t a, long double x, long double y, long double reach) {
    const long double dx = static_cast<long double>(bodies.x[a]) - x,
                      dy = static_cast<long double>(bodies.y[a]) - y;
    const long double limit = static_cast<long double>(bodies.reach[a]) + reach;
    const long double squared = dx * dx + dy * dy;
    const long double band =
        8 * static_cast<long double>(std::numeric_limits<Real>::epsilon()) * limit * limit;
    if (squared < limit * limit - band) return Near::yes;
    return squared > limit * limit + band ? Near::no : Near::rounding_decides;
}

template <class Real>
Near is_candidate(const Bodies<Real>& bodies, std::size_t a, std::size_t b) {
    if (((bodies.flags[a] | bodies.flags[b]) & carom::kDisabled) != 0) return Near::no;
    if ((bodies.flags[a] & bodies.flags[b] & carom::kImmovable) != 0) return Near::no;
    return is_near(bodies, a, static_cast<long double>(bodies.x[b]), static_cast<long double>(bodies.y[b]),
                   static_cast<long double>(bodies.reach[b]));
}

std::vector<Pair> listed(const CandidatePairs& pairs) {
    std::vector<Pair> list;
    for (std::size_t i = 0; i < pairs.count; ++i) list.emplace_back(pairs.a[i], pairs.b[i]);
    return list;
}

/// How many pairs are missing, should not be there or are found twice.
template <class Real>
std::size_t wrong_pairs(const Bodies<Real>& bodies, std::vector<Pair> found) {
    for (auto& [a, b] : found)
        if (a > b) std::swap(a, b);
    std::sort(found.begin(), found.end());
    const auto unique_end = std::unique(found.begin(), found.end());
    auto wrong = static_cast<std::size_t>(found.end() - unique_end);
    found.erase(unique_end, found.end());

    auto next = found.begin();
    for (std::size_t a = 0; a < bodies.count(); ++a)
        for (std::size_t b = a + 1; b < bodies.count(); ++b) {
            const bool is_found = next != found.end() && *next == Pair(a, b);
            if (is_found) ++next;
            const Near expected = is_candidate(bodies, a, b);
            if (expected != Near::rounding_decides && is_found != (expected == Near::yes)) ++wrong;
        }
    return wrong + static_cast<std::size_t>(found.end() - next);  // pairs of no two rows
}

template <class Real>
std::size_t wrong_neighbours(const Bodies<Real>& bodies, const UniformGrid<Real>& grid, Real x, Real y,
                             Real reach) {
    Column<std::int32_t> rows;
    const std::size_t count = grid.find_near(x, y, reach, rows);
    const std::set<std::int32_t> found(rows.begin(), rows.begin() + count);
    std::size_t wrong = count - found.size();
    for (std::size_t row = 0; row < bodies.count(); ++row) {
        Near expected = is_near(bodies, row, static_cast<long double>(x), static_cast<long double>(y),
                                static_cast<long double>(reach));
        if ((bodies.flags[row] & carom::kDisabled) != 0) expected = Near::no;
        const bool is_found = found.contains(static_cast<std::int32_t>(row));
        if (expected != Near::rounding_decides && is_found != (expected == Near::yes)) ++wrong;
    }
    return wrong;
}

struct World {
    std::string name;
    std::size_t count;
    double extent;         // m, side of the square they are spread over
    double smallest;       // m, reach
    double largest;        // m
    std::size_t clusters;  // 0: evenly spread
    bool flyer = false;
    bool crowd = false;  // every fourth body in one corner of one cell
};

const std::vector<World> kWorlds{
    {"one body", 1, 1, 1, 1, 0},
    {"two bodies", 2, 1, 1, 1, 0},
    {"seventeen bodies", 17, 8, .5, 1, 0},
    {"one size", 1500, 50, .65, .65, 0},
    {"a pile's sizes", 1500, 40, .4, .6, 0},
    {"sizes 1:10", 1500, 100, .2, 2, 0},
    {"sizes 1:1000", 1200, 100, .005, 5, 0},
    {"sizes 1:1000 with a flyer", 1200, 100, .005, 5, 0, true},
    {"clusters", 1500, 1e4, .3, .9, 7},
    {"clusters of sizes 1:100", 1000, 1e5, .02, 2, 5},
    {"all in one cell", 300, .5, 1, 1, 0},
    {"spread over 1e6 m", 1500, 1e6, 1, 30, 0},
    {"a flyer", 1500, 50, .65, .65, 0, true},
    {"no reach", 100, 10, 0, 0, 0},
    {"a crowd among few", 1500, 60, .65, .65, 0, false, true},
    {"a crowd, far from few", 1500, 5000, .65, .65, 0, false, true},
};

template <class Real>
Bodies<Real> make_bodies(const World& world, unsigned seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
    };
    Bodies<Real> bodies;
    for (std::size_t i = 0; i < world.count; ++i) {
        const double reach =
            world.smallest > 0 ? world.smallest * std::pow(world.largest / world.smallest, uniform(0, 1)) : 0;
        double x = uniform(-.3, .7) * world.extent, y = uniform(-.6, .4) * world.extent;
        if (world.clusters > 0) {
            const auto cluster = static_cast<double>(random() % world.clusters);
            x = std::cos(cluster) * world.extent + uniform(-1, 1) * 12 * world.largest;
            y = std::sin(cluster) * world.extent + uniform(-1, 1) * 12 * world.largest;
        }
        if (world.crowd && i % 4 == 0) x = uniform(3, 3.2), y = uniform(-3.2, -3);
        bodies.add(x, y, reach);
        if (i % 50 == 49) bodies.add(x, y, reach);  // coincident
    }
    if (world.flyer) bodies.add(1e8, -1e8, world.largest);
    return bodies;
}

template <class Real>
void check_world(const Bodies<Real>& bodies) {
    std::vector<Pair> expected;
    for (const carom::KernelTables* tables : carom::runnable_kernel_tables()) {
        const KernelTable<Real>& kernels = tables->of<Real>();
        CAPTURE(kernels.isa);
        const Executor executor(1);
        UniformGrid<Real> grid;
        grid.build(bodies.input(), kernels, executor);
        const std::vector<Pair> pairs = listed(grid.find_candidates(executor));
        if (tables == carom::runnable_kernel_tables().front()) {
            CHECK(wrong_pairs(bodies, pairs) == 0);
            expected = pairs;
        }
        CHECK(pairs == expected);  // the order too

        std::size_t wrong = 0;
        std::mt19937 random(17);
        for (int query = 0; query < 40; ++query) {
            const std::size_t row = random() % bodies.count(), other = random() % bodies.count();
            const Real shift = bodies.reach[other] * static_cast<Real>(query % 4);
            wrong += wrong_neighbours(bodies, grid, bodies.x[row] + shift, bodies.y[row] - shift,
                                      bodies.reach[other]);
        }
        // Larger than cells: those of folded planes are looked at line by line.
        for (const int times : {2, 3, 5, 9, 17})
            for (int query = 0; query < 8; ++query) {
                const std::size_t row = random() % bodies.count(), other = random() % bodies.count();
                wrong += wrong_neighbours(bodies, grid, bodies.x[row], bodies.y[row],
                                          static_cast<Real>(times) * bodies.reach[other]);
            }
        wrong += wrong_neighbours(bodies, grid, Real(3e7), Real(-2e7), Real(1));
        wrong += wrong_neighbours(bodies, grid, bodies.x[0], bodies.y[0], 40 * bodies.reach[0]);
        CHECK(wrong == 0);
    }
}

}  // namespace

TEST_SUITE("broadphase/uniform_grid") {
    TEST_CASE_TEMPLATE(
        "candidates and neighbours are those of brute force, in one order on every instruction set", Real,
        float, double) {
        for (const World& world : kWorlds)
            for (unsigned seed = 1; seed <= carom::test::scaled(2u, 1u); ++seed) {
                CAPTURE(world.name);
                CAPTURE(seed);
                check_world(make_bodies<Real>(world, seed));
            }
    }

    TEST_CASE("five thousand bodies of sizes 1:1000 give brute force's candidates") {
        check_world(make_bodies<float>({"", 5000, 300, .01, 10, 0}, 3));
        check_world(make_bodies<float>({"", 5000, 300, .01, 10, 0, true}, 3));
    }

    TEST_CASE("positions a whole number of folded planes apart share cells and are still told apart") {
        Bodies<float> bodies;
        for (std::size_t i = 0; i < 1000; ++i) {
            const double step = 1.3 * (1 + 1e-5) * 2001;  // m, cells of a plane folded for 1,000 bodies
            bodies.add(step * static_cast<double>(i % 30), step * static_cast<double>(i / 30), .65);
        }
        check_world(bodies);
    }

    TEST_CASE("sizes share a level where bodies hardly overlap, and do not where small ones crowd") {
        const auto levels = [](double extent_of_small) {
            Bodies<float> bodies = make_bodies<float>({"", 500, 20'000, 100, 100, 0}, 3);
            const Bodies<float> small = make_bodies<float>({"", 1500, extent_of_small, .65, .65, 0}, 4);
            for (std::size_t i = 0; i < small.count(); ++i)
                bodies.add(small.x[i], small.y[i], small.reach[i]);
            UniformGrid<float> grid;
            grid.build(bodies.input(), carom::select_kernels("auto").of<float>(), Executor(1));
            check_world(bodies);
            return grid.level_count();
        };
        CHECK(levels(20'000) == 1);
        CHECK(levels(60) == 2);
    }

    TEST_CASE("disabled bodies are in no pair, and two immovable ones are not a pair") {
        for (const double largest : {.65, 20.0}) {
            Bodies<float> bodies = make_bodies<float>({"", 1200, 50, .65, largest, 0}, 5);
            std::mt19937 random(1);
            for (std::uint8_t& flags : bodies.flags)
                flags = static_cast<std::uint8_t>(random() % 4 == 0 ? carom::kImmovable : 0);
            check_world(bodies);
            for (std::uint8_t& flags : bodies.flags)
                flags = static_cast<std::uint8_t>(random() % 5 == 0 ? flags | carom::kDisabled : flags);
            bodies.x[7] = std::numeric_limits<float>::quiet_NaN();
            bodies.y[8] = std::numeric_limits<float>::infinity();
            bodies.flags[7] = bodies.flags[8] = carom::kDisabled;
            check_world(bodies);
            for (std::uint8_t& flags : bodies.flags) flags = carom::kDisabled;
            check_world(bodies);
        }
    }

    TEST_CASE("a position that is not a number is in no pair and breaks nothing else") {
        Bodies<float> bodies = make_bodies<float>({"", 500, 30, .65, .65, 0}, 5);
        for (const float bad :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
              -std::numeric_limits<float>::infinity()}) {
            bodies.x[3] = bad;
            bodies.y[4] = bad;
            for (const carom::KernelTables* tables : carom::runnable_kernel_tables()) {
                UniformGrid<float> grid;
                grid.build(bodies.input(), tables->of<float>(), Executor(1));
                CHECK(wrong_pairs(bodies, listed(grid.find_candidates(Executor(1)))) == 0);
            }
        }
    }

    TEST_CASE("the order does not depend on the number of threads") {
        for (const double largest : {.5, 8.0}) {
            const Bodies<float> bodies = make_bodies<float>({"", 40'000, 280, .5, largest, 0}, 11);
            const KernelTable<float>& kernels = carom::select_kernels("auto").of<float>();
            UniformGrid<float> grid;
            grid.build(bodies.input(), kernels, Executor(1));
            const std::vector<Pair> expected = listed(grid.find_candidates(Executor(1)));
            const std::vector<std::int32_t> order(grid.order().begin(), grid.order().end());
            for (const int threads : {2, 3}) {
                const Executor executor(threads);
                grid.build(bodies.input(), kernels, executor);
                CHECK(listed(grid.find_candidates(executor)) == expected);
                CHECK(std::equal(order.begin(), order.end(), grid.order().begin(), grid.order().end()));
            }
        }
    }

    TEST_CASE("the order lists every row once, and pairs are padded with the row after the last") {
        Bodies<float> bodies = make_bodies<float>({"", 1000, 40, .3, 5, 0}, 5);
        bodies.flags[10] = bodies.flags[500] = carom::kDisabled;
        UniformGrid<float> grid;
        grid.build(bodies.input(), carom::select_kernels("auto").of<float>(), Executor(1));
        std::vector<std::int32_t> order(grid.order().begin(), grid.order().end());
        CHECK(order[order.size() - 2] == 10);
        CHECK(order.back() == 500);
        std::sort(order.begin(), order.end());
        bool complete = order.size() == bodies.count();
        for (std::size_t row = 0; row < order.size(); ++row)
            complete = complete && order[row] == static_cast<std::int32_t>(row);
        CHECK(complete);

        const CandidatePairs& pairs = grid.find_candidates(Executor(1));
        for (std::size_t i = pairs.count; i < carom::padded(pairs.count); ++i) {
            CHECK(pairs.a[i] == static_cast<std::int32_t>(bodies.count()));
            CHECK(pairs.b[i] == static_cast<std::int32_t>(bodies.count()));
        }
    }

    TEST_CASE("one body at 1e8 m costs no memory, and building again allocates none") {
        const KernelTable<float>& kernels = carom::select_kernels("auto").of<float>();
        const auto bytes_of = [&](bool flyer) {
            const Bodies<float> bodies = make_bodies<float>({"", 20'000, 200, .65, .65, 0, flyer}, 5);
            UniformGrid<float> grid;
            grid.build(bodies.input(), kernels, Executor(1));
            grid.find_candidates(Executor(1));
            const std::size_t bytes = grid.bytes();
            grid.build(bodies.input(), kernels, Executor(1));
            grid.find_candidates(Executor(1));
            CHECK(grid.bytes() == bytes);
            return static_cast<double>(bytes);
        };
        CHECK(bytes_of(true) < 1.2 * bytes_of(false));
    }

    TEST_CASE("positions at the build are kept by row") {
        const Bodies<double> bodies = make_bodies<double>({"", 100, 40, .3, 5, 0}, 5);
        UniformGrid<double> grid;
        grid.build(bodies.input(), carom::select_kernels("auto").of<double>(), Executor(1));
        CHECK(std::equal(bodies.x.begin(), bodies.x.end(), grid.built_x().begin()));
        CHECK(std::equal(bodies.y.begin(), bodies.y.end(), grid.built_y().begin()));
    }

    TEST_CASE("a world without bodies has no candidates") {
        UniformGrid<float> grid;
        grid.build({}, carom::select_kernels("auto").of<float>(), Executor(1));
        CHECK(grid.find_candidates(Executor(1)).count == 0);
        Column<std::int32_t> rows;
        CHECK(grid.find_near(0, 0, 1, rows) == 0);
    }

    TEST_CASE_TEMPLATE("standing bodies are found by all others, once they are known as well", Real, float,
                       double) {
        for (const World& world : kWorlds) {
            CAPTURE(world.name);
            Bodies<Real> bodies = make_bodies<Real>(world, 11);
            const std::size_t moving = bodies.count() / 3;
            for (std::size_t row = moving; row < bodies.count(); ++row) bodies.flags[row] = carom::kImmovable;
            if (moving > 2) bodies.flags[1] = carom::kImmovable, bodies.flags[2] = carom::kDisabled;
            const Executor executor(1);
            UniformGrid<Real> grid;
            const KernelTable<Real>& kernels = carom::runnable_kernel_tables().back()->of<Real>();
            for (const bool are_known : {false, true, true}) {
                grid.build(bodies.input_with_standing(moving, are_known), kernels, executor);
                CHECK(wrong_pairs(bodies, listed(grid.find_candidates(executor))) == 0);
                std::set<std::int32_t> order(grid.order().begin(), grid.order().end());
                CHECK(order.size() == bodies.count());
                for (std::size_t row = 0; row < bodies.count(); row += 37)
                    CHECK(wrong_neighbours(bodies, grid, bodies.x[row], bodies.y[row], bodies.reach[row]) ==
                          0);
                for (std::size_t row = 0; row < moving; ++row)  // the others move
                    bodies.x[row] =
                        static_cast<Real>(static_cast<double>(bodies.x[row]) * 0.8 + 0.1 * world.extent);
            }
        }
    }
}

}  // namespace test_uniform_grid
