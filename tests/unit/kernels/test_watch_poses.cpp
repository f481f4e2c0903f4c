// How far bodies have come and whether their contacts hold, and which bodies are thrown: kernels of every
// instruction set against the definitions, row by row in double precision.
#include "isa/select_isa.hpp"
#include "state/columns/column.hpp"
#include "support/draw.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

namespace test_watch_poses {

using namespace carom;
using carom::test::Draw;

namespace {

constexpr std::size_t kRows = 1000;
constexpr double kStep = 1.0 / 64, kShare = 1e-3, kArc = 1e-6, kWay = 0.25;

/// Rows of which some stand, some move by much, some turn alone, and some have just come.
template <class Real>
struct Rows {
    Column<Real> x, y, angle, velocity_x, velocity_y, spin, radius, rim, thinnest;
    Column<Real> pose, last_angle, base, come, turned, moved, way;
    Column<std::uint8_t> has_moved;

    explicit Rows(bool turns) {
        Draw draw(3);
        const std::size_t room = padded(kRows);
        for (Column<Real>* column : {&x, &y, &angle, &velocity_x, &velocity_y, &spin, &radius, &rim,
                                     &thinnest, &last_angle, &turned, &moved, &way})
            column->resize(room);
        pose.resize(4 * room), base.resize(4 * room), come.resize(2 * room), has_moved.resize(room);
        const auto real = [](double value) { return static_cast<Real>(value); };
        for (std::size_t row = 0; row < kRows; ++row) {
            x[row] = real(draw(-1, 1)), y[row] = real(draw(-1, 1));
            radius[row] = real(draw(0.2, 1)), rim[row] = real(draw(0.1, 0.8));
            angle[row] = real(turns ? draw(-1, 1) : 0);
            thinnest[row] = real(draw.chance(0.1) ? 0 : draw(0.1, 0.5));
            const double far = draw.chance(0.3) ? 1e-2 : 1e-5, turn = !turns             ? 0
                                                                      : draw.chance(0.3) ? 0.1
                                                                                         : 2e-4;
            const auto near = [&](Real value, double by) {
                return real(static_cast<double>(value) + draw(-by, by));
            };
            pose[4 * row] = near(x[row], far), pose[4 * row + 1] = near(y[row], far);
            base[4 * row] = near(x[row], far), base[4 * row + 1] = near(y[row], far);
            base[4 * row + 2] = near(angle[row], turn);
            last_angle[row] = draw.chance(0.5) ? angle[row] : near(angle[row], turn);
            pose[4 * row + 2] = 1;
            const double speed = draw.chance(0.2) ? 20 : 0.1;
            velocity_x[row] = real(draw(-speed, speed)), velocity_y[row] = real(draw(-speed, speed));
            spin[row] = real(draw(-speed, speed));
        }
    }
    WatchPoses<Real> arguments(bool turns) {
        const auto real = [](double value) { return static_cast<Real>(value); };
        WatchPoses<Real> k{};
        k.x = x.data(), k.y = y.data(), k.velocity_x = velocity_x.data(), k.velocity_y = velocity_y.data();
        if (turns) k.angle = angle.data(), k.spin = spin.data();
        k.radius = turns ? radius.data() : nullptr, k.rim = turns ? rim.data() : nullptr;
        k.uniform_radius = k.uniform_rim = real(0.5), k.thinnest = thinnest.data(), k.dt = real(kStep);
        k.carried_share = real(kShare), k.carried_arc = real(kArc), k.carried_way = real(kWay);
        k.pose = pose.data(), k.last_angle = last_angle.data(), k.base = base.data(), k.come = come.data();
        k.turned = turned.data(), k.moved = moved.data(), k.way = way.data(), k.has_moved = has_moved.data();
        return k;
    }
};

bool is_near(double value, double expected, double precision) {
    return std::abs(value - expected) <= precision * (1 + std::abs(expected));
}

}  // namespace

TEST_SUITE("kernels/watch poses") {
    TEST_CASE_TEMPLATE("bodies have moved where one of the three bounds is passed", Real, float, double) {
        const double precision = sizeof(Real) == sizeof(float) ? 2e-6 : 1e-13;
        for (const bool turns : {false, true}) {
            CAPTURE(turns);
            const Rows<Real> before(turns);
            std::vector<Rows<Real>> of_all;
            for (const KernelTables* tables : runnable_kernel_tables()) {
                Rows<Real>& now = of_all.emplace_back(turns);
                const auto kernel = tables->of<Real>().convex->watch_poses;
                CHECK(kernel(now.arguments(turns), 0, 512) == turns);
                kernel(now.arguments(turns), 512, padded(kRows));
                CHECK(kernel(now.arguments(turns), 0, 16) == false);  // no angle is new any more
            }
            Rows<Real> once(turns);
            runnable_kernel_tables().front()->of<Real>().convex->watch_poses(once.arguments(turns), 0,
                                                                             padded(kRows));
            std::size_t moved = 0, still = 0, close = 0;
            for (std::size_t row = 0; row < kRows; ++row) {
                CAPTURE(row);
                const auto of = [&](const Column<Real>& column) { return static_cast<double>(column[row]); };
                const double radius = turns ? of(before.radius) : 0.5, rim = turns ? of(before.rim) : 0.5,
                             angle = turns ? of(before.angle) : 0, spin = turns ? of(before.spin) : 0;
                const auto pose = [&](std::size_t k) {
                    return static_cast<double>(before.pose[4 * row + k]);
                };
                const auto base = [&](std::size_t k) {
                    return static_cast<double>(before.base[4 * row + k]);
                };
                const double come_x = of(before.x) - pose(0), come_y = of(before.y) - pose(1),
                             turned = angle - of(before.last_angle);
                REQUIRE(is_near(once.come[2 * row], come_x, precision));
                REQUIRE(is_near(once.come[2 * row + 1], come_y, precision));
                REQUIRE(is_near(once.turned[row], rim * turned, precision));
                REQUIRE(is_near(once.moved[row],
                                std::abs(come_x) + std::abs(come_y) + radius * std::abs(turned), precision));
                const double way = kStep * (std::abs(of(before.velocity_x)) +
                                            std::abs(of(before.velocity_y)) + radius * std::abs(spin));
                REQUIRE(is_near(once.way[row], way, precision));
                REQUIRE(once.pose[4 * row] == before.x[row]);
                REQUIRE(once.pose[4 * row + 1] == before.y[row]);
                REQUIRE(once.pose[4 * row + 2] == 1);
                const double thinnest = of(before.thinnest), turn = angle - base(2);
                const std::array<double, 3> excess{
                    std::abs(of(before.x) - base(0)) + std::abs(of(before.y) - base(1)) - kShare * thinnest,
                    radius * turn * turn - kArc * thinnest, way - kWay * thinnest};
                bool is_still = true, is_close = false;  // too close to a bound for this precision to tell
                const std::array<double, 3> bounds{kShare * thinnest, kArc * thinnest, kWay * thinnest};
                for (std::size_t k = 0; k < excess.size(); ++k)
                    is_still &= excess[k] <= 0, is_close |= std::abs(excess[k]) < 0.01 * bounds[k];
                if (is_close) {
                    ++close;
                    continue;
                }
                (is_still ? still : moved) += 1;
                REQUIRE((once.has_moved[row] != 0) == !is_still);
                const bool keeps_base = is_still && thinnest > 0;
                REQUIRE(once.base[4 * row] == (keeps_base ? before.base[4 * row] : before.x[row]));
                REQUIRE(static_cast<double>(once.base[4 * row + 2]) == (keeps_base ? base(2) : angle));
            }
            CHECK(moved > 100);
            CHECK(still > 100);
            CHECK(close < kRows / 20);
            for (Rows<Real>& other : of_all)
                for (std::size_t row = 0; row < kRows; ++row) {
                    REQUIRE(other.has_moved[row] <= 1);
                    if (row < 16) continue;  // was looked at twice
                    REQUIRE(other.has_moved[row] == once.has_moved[row]);
                    REQUIRE(other.moved[row] == once.moved[row]);
                    REQUIRE(other.way[row] == once.way[row]);
                    REQUIRE(other.turned[row] == once.turned[row]);
                    for (std::size_t k = 0; k < 4; ++k)
                        REQUIRE(other.base[4 * row + k] == once.base[4 * row + k]);
                }
        }
    }

    TEST_CASE_TEMPLATE("bodies are thrown that are many times as fast as they were", Real, float, double) {
        Draw draw(9);
        const auto real = [](double value) { return static_cast<Real>(value); };
        Column<Real> velocity(4 * padded(kRows)), start_x(padded(kRows)), start_y(padded(kRows)),
            start_rim(padded(kRows)), inradius(padded(kRows)), joined(padded(kRows));
        for (std::size_t row = 0; row < kRows; ++row) {
            const double speed = draw.chance(0.5) ? 10 : 0.01;
            for (std::size_t k = 0; k < 3; ++k) velocity[4 * row + k] = real(draw(-speed, speed));
            start_x[row] = real(draw(-0.1, 0.1)), start_y[row] = real(draw(-0.1, 0.1));
            start_rim[row] = real(draw(-0.1, 0.1)), inradius[row] = real(draw(0.1, 1));
            joined[row] = draw.chance(0.2) ? Real(1) : Real(0);
        }
        std::size_t all = 0;
        for (const bool has_joints : {false, true}) {
            std::vector<std::uint8_t> expected(padded(kRows));
            for (std::size_t row = 0; row < kRows; ++row) {
                const auto of = [&](const Column<Real>& column) {
                    return std::abs(static_cast<double>(column[row]));
                };
                double speed = 0;
                for (std::size_t k = 0; k < 3; ++k)
                    speed += std::abs(static_cast<double>(velocity[4 * row + k]));
                const double before = of(start_x) + of(start_y) + of(start_rim);
                expected[row] = speed > 64 * (before + 0.03125) + 0.0625 * of(inradius) &&
                                !(has_joints && joined[row] > 0);
                all += expected[row];
            }
            for (const KernelTables* tables : runnable_kernel_tables()) {
                std::vector<std::uint8_t> found(padded(kRows), 7);
                const FindThrown<Real> k{velocity.data(),
                                         {start_x.data(), start_y.data(), start_rim.data()},
                                         inradius.data(),
                                         0,
                                         has_joints ? joined.data() : nullptr,
                                         Real(64),
                                         Real(0.03125),
                                         Real(0.0625),
                                         found.data()};
                CHECK(tables->of<Real>().convex->find_thrown(k, 0, padded(kRows)));
                CHECK(found == expected);
                const FindThrown<Real> none = [&] {
                    FindThrown<Real> slow = k;
                    slow.times = Real(1e6);
                    return slow;
                }();
                CHECK_FALSE(tables->of<Real>().convex->find_thrown(none, 0, padded(kRows)));
                CHECK(found == std::vector<std::uint8_t>(padded(kRows)));
            }
        }
        CHECK(all > 100);
        CHECK(all < kRows);
    }
}

}  // namespace test_watch_poses
