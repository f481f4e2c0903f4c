#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "isa/select_isa.hpp"
#include "state/columns/column.hpp"

namespace test_flight {

using namespace carom;

namespace {

constexpr std::size_t kMostRows = 5 * kRowPadding;

/// Random columns; a fixed seed, so that every instruction set sees the same.
template <class Real>
struct Columns {
    Column<Real> x, y, vx, vy, built_x, built_y, reach, radius, motion;
    Column<std::int32_t> a, b;

    explicit Columns(std::size_t rows) {
        std::mt19937 random(5);
        const auto number = [&](double low, double high) {
            return static_cast<Real>(low + (high - low) * static_cast<double>(random() % 100001) * 1e-5);
        };
        for (Column<Real>* column : {&x, &y, &vx, &vy, &built_x, &built_y, &reach, &radius})
            column->resize(rows);
        motion.resize(4 * padded(rows));
        a.resize(rows), b.resize(rows);
        for (std::size_t i = 0; i < rows; ++i) {
            x[i] = number(0, 9), y[i] = number(0, 9), vx[i] = number(-20, 20), vy[i] = number(-20, 20);
            built_x[i] = x[i] + number(-0.2, 0.2), built_y[i] = y[i] + number(-0.2, 0.2);
            radius[i] = number(0.1, 0.6), reach[i] = radius[i] + number(0.1, 0.6);
            a[i] = static_cast<std::int32_t>(random() % rows),
            b[i] = static_cast<std::int32_t>(random() % rows);
        }
        for (std::size_t i = 0; i < rows; ++i) {
            const Real record[] = {x[i], y[i], vx[i], vy[i]};
            for (std::size_t k = 0; k < 4; ++k) motion[4 * i + k] = record[k];
        }
    }
};

/// A list of row numbers with a sentinel after the room that a kernel may use.
struct Listed {
    std::vector<std::int32_t> numbers = std::vector<std::int32_t>(kMostRows + kRowPadding + 1, kUntouched);
    static constexpr std::int32_t kUntouched = -12345;

    std::vector<std::int32_t> first(std::size_t count) const {
        return {numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(count)};
    }
};

template <class Real>
struct Begun {
    Listed wall, displaced, lost;
    FlightCounts<Real> counts;
    std::vector<Real> motion;
};

template <class Real>
Begun<Real> begin(const KernelTable<Real>& kernels, Columns<Real> columns, std::size_t rows, bool uniform) {
    Begun<Real> begun;
    BeginFlight<Real> k{};
    k.position_x = columns.x.data(), k.position_y = columns.y.data();
    k.velocity_x = columns.vx.data(), k.velocity_y = columns.vy.data();
    k.built_x = columns.built_x.data(), k.built_y = columns.built_y.data();
    k.reach = columns.reach.data();
    k.radius = uniform ? nullptr : columns.radius.data(), k.uniform_radius = Real(0.3);
    k.s = Real(0.016), k.fall_y = Real(-0.001), k.gain_y = Real(-0.16), k.bend_y = Real(0.0007);
    k.max_x = k.max_y = 9;
    k.touch_ratio = 1, k.largest_position = 100, k.largest_speed = Real(19.5);
    k.motion = columns.motion.data();
    k.wall_rows = begun.wall.numbers.data(), k.displaced_rows = begun.displaced.numbers.data();
    k.lost_rows = begun.lost.numbers.data();
    begun.counts = (uniform ? kernels.begin_flight_uniform_radius : kernels.begin_flight)(k, 0, padded(rows));
    begun.motion.assign(columns.motion.begin(), columns.motion.begin() + 4 * rows);
    CHECK(begun.wall.numbers.back() == Listed::kUntouched);
    return begun;
}

}  // namespace

TEST_SUITE("kernels/flight") {
    TEST_CASE_TEMPLATE("begin_flight lists the same rows on every instruction set, for every length", Real,
                       float, double) {
        for (std::size_t rows = 1; rows <= kMostRows; rows += 3)
            for (const bool uniform : {false, true}) {
                const Columns<Real> columns(rows);
                const auto tables = runnable_kernel_tables();
                const Begun<Real> expected = begin(tables.front()->of<Real>(), columns, rows, uniform);
                for (const KernelTables* table : tables) {
                    CAPTURE(table->of<Real>().isa);
                    CAPTURE(rows);
                    const Begun<Real> actual = begin(table->of<Real>(), columns, rows, uniform);
                    CHECK(actual.counts.fastest_squared == expected.counts.fastest_squared);
                    CHECK(actual.motion == expected.motion);
                    CHECK(actual.wall.first(actual.counts.wall) == expected.wall.first(expected.counts.wall));
                    CHECK(actual.displaced.first(actual.counts.displaced) ==
                          expected.displaced.first(expected.counts.displaced));
                    CHECK(actual.lost.first(actual.counts.lost) == expected.lost.first(expected.counts.lost));
                }
            }
    }

    TEST_CASE_TEMPLATE(
        "begin_flight lists rows that reach a wall, leave their margin or the limits, and no others", Real,
        float, double) {
        constexpr std::size_t kRows = 64;
        const Columns<Real> columns(kRows);
        const Begun<Real> begun = begin(runnable_kernel_tables().back()->of<Real>(), columns, kRows, false);
        std::vector<std::int32_t> wall, displaced, lost;
        double fastest = 0;
        for (std::size_t i = 0; i < kRows; ++i) {
            const double x = columns.x[i], y = columns.y[i], vx = columns.vx[i], vy = columns.vy[i];
            const double end_x = x + vx * 0.016, end_y = y + vy * 0.016 - 0.001, r = columns.radius[i];
            const double moved = std::hypot(end_x - columns.built_x[i], end_y - columns.built_y[i]);
            const auto row = static_cast<std::int32_t>(i);
            if (std::min(x, end_x) < r || std::max(x, end_x) > 9 - r || std::min(y, end_y) < r + 0.0007 ||
                std::max(y, end_y) > 9 - r - 0.0007)
                wall.push_back(row);
            if (moved > columns.reach[i] - r) displaced.push_back(row);
            if (std::fabs(vx) > 19.5 || std::fabs(vy - 0.16) > 19.5) lost.push_back(row);
            fastest = std::max(fastest, vx * vx + vy * vy);
        }
        CHECK(begun.wall.first(begun.counts.wall) == wall);
        CHECK(begun.displaced.first(begun.counts.displaced) == displaced);
        CHECK(begun.lost.first(begun.counts.lost) == lost);
        CHECK(begun.counts.fastest_squared == doctest::Approx(fastest));
        CHECK(!wall.empty());
        CHECK(!displaced.empty());
        CHECK(!lost.empty());
    }

    TEST_CASE_TEMPLATE("a state that is no number is listed as lost", Real, float, double) {
        Columns<Real> columns(kRowPadding);
        columns.vx[3] = std::numeric_limits<Real>::quiet_NaN();
        columns.y[5] = std::numeric_limits<Real>::infinity();
        for (const KernelTables* table : runnable_kernel_tables()) {
            const Begun<Real> begun = begin(table->of<Real>(), columns, kRowPadding, false);
            const auto lost = begun.lost.first(begun.counts.lost);
            CHECK(std::count(lost.begin(), lost.end(), 3) == 1);
            CHECK(std::count(lost.begin(), lost.end(), 5) == 1);
        }
    }

    TEST_CASE_TEMPLATE("find_impacts lists exactly the pairs that come near, on every instruction set", Real,
                       float, double) {
        constexpr std::size_t kPairs = kMostRows;
        const Columns<Real> columns(kPairs);
        std::vector<std::int32_t> expected;
        for (std::size_t p = 0; p < kPairs; ++p) {
            const auto a = static_cast<std::size_t>(columns.a[p]), b = static_cast<std::size_t>(columns.b[p]);
            const double dx = columns.x[b] - columns.x[a], dy = columns.y[b] - columns.y[a];
            const double vx = columns.vx[b] - columns.vx[a], vy = columns.vy[b] - columns.vy[a];
            const double reach = columns.radius[a] + columns.radius[b], s = 0.3;
            double least = std::hypot(dx, dy);  // on the way, sampled finely
            const bool approaches = dx * vx + dy * vy < 0;
            const bool near = least < reach - 0.01;
            for (int i = 0; i <= 20000; ++i)
                least = std::min(least, std::hypot(dx + vx * s * i / 20000, dy + vy * s * i / 20000));
            if (near || (approaches && least < reach + 0.02))
                expected.push_back(static_cast<std::int32_t>(p));
        }
        CHECK(expected.size() >= 4);
        CHECK(expected.size() < kPairs);
        for (const KernelTables* table : runnable_kernel_tables()) {
            CAPTURE(table->of<Real>().isa);
            Listed found;
            const FindImpacts<Real> k{columns.motion.data(),
                                      columns.a.data(),
                                      columns.b.data(),
                                      columns.radius.data(),
                                      Real(0),
                                      Real(0.3),
                                      Real(0.02),
                                      Real(-0.01),
                                      found.numbers.data()};
            CHECK(found.first(table->of<Real>().find_impacts(k, 0, kPairs)) == expected);
        }
    }

    TEST_CASE_TEMPLATE("end_flight and advance_rotation give the scalar bits on every instruction set", Real,
                       float, double) {
        for (std::size_t rows = 1; rows <= kMostRows; rows += 5) {
            const Columns<Real> columns(rows);
            std::vector<std::vector<Real>> results;
            for (const KernelTables* table : runnable_kernel_tables()) {
                const KernelTable<Real>& kernels = table->of<Real>();
                Column<Real> x(rows), y(rows), vx(rows), vy(rows), angle = columns.x, spin = columns.vx;
                constexpr Real kUnit = std::numeric_limits<Real>::epsilon();
                kernels.end_flight({columns.motion.data(), Real(0.016), Real(0.02), Real(0.1), Real(-0.2),
                                    Real(0.3), Real(-0.4), x.data(), y.data(), vx.data(), vy.data(),
                                    Real(0.3) * kUnit, Real(-0.4) * kUnit},
                                   0, padded(rows));
                kernels.advance_rotation({angle.data(), spin.data(), Real(0.016), Real(0.9)}, 0,
                                         padded(rows));
                std::vector<Real>& result = results.emplace_back();
                for (const Column<Real>* column : {&x, &y, &vx, &vy, &angle, &spin})
                    result.insert(result.end(), column->begin(), column->begin() + rows);
                CHECK(result == results.front());
            }
            CHECK(results.front()[0] == columns.x[0] + columns.vx[0] * Real(0.016) + Real(0.1));
        }
    }
}

}  // namespace test_flight
