#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "broadphase/grid/uniform_grid.hpp"
#include "isa/select_isa.hpp"
#include "state/columns/column.hpp"

namespace test_find_impacts_near {

using namespace carom;

namespace {

constexpr double kReach = 0.9;  // m, of every body in the grid
constexpr std::int32_t kUntouched = -12345;

enum class Met { no, yes, rounding_decides };

/// Bodies in some clusters, which have moved somewhat since the grid was built.
template <class Real>
struct Crowd {
    Column<Real> x, y, reach, radius, motion;

    Crowd(std::size_t bodies, std::size_t clusters, double extent) {
        std::mt19937 random(29);
        const auto number = [&](double low, double high) {
            return std::uniform_real_distribution<double>(low, high)(random);
        };
        for (Column<Real>* column : {&x, &y, &reach, &radius}) column->resize(bodies);
        motion.resize(4 * (bodies + 1));
        for (std::size_t i = 0; i < bodies; ++i) {
            const double centre = extent * static_cast<double>(i % clusters);
            x[i] = static_cast<Real>(centre + number(0, 9)),
            y[i] = static_cast<Real>(centre / 3 + number(0, 9));
            reach[i] = static_cast<Real>(kReach), radius[i] = static_cast<Real>(number(0.2, 0.5));
            const double record[] = {static_cast<double>(x[i]) + number(-0.2, 0.2),
                                     static_cast<double>(y[i]) + number(-0.2, 0.2), number(-9, 9),
                                     number(-9, 9)};
            for (std::size_t k = 0; k < 4; ++k) motion[4 * i + k] = static_cast<Real>(record[k]);
        }
    }
    GridInput<Real> input() const { return {x.size(), x.data(), y.data(), reach.data(), nullptr}; }

    /// From the nearest point of the way, in long double.
    Met meets(std::size_t a, std::size_t b, long double radii, long double from, long double until) const {
        const auto of = [&](std::size_t body, std::size_t k) {
            return static_cast<long double>(motion[4 * body + k]);
        };
        const long double dx = of(b, 0) - of(a, 0), dy = of(b, 1) - of(a, 1);
        const long double vx = of(b, 2) - of(a, 2), vy = of(b, 3) - of(a, 3);
        const auto approach = [&](long double s) { return (dx + s * vx) * vx + (dy + s * vy) * vy; };
        const long double nearest = -(dx * vx + dy * vy) / (vx * vx + vy * vy);  // s, of the straight way
        const long double s = std::fmin(std::fmax(nearest, from), until);
        const long double least = std::hypot(dx + s * vx, dy + s * vy);
        if (std::fabs(least - radii) < 2e-4L || std::fabs(approach(from)) < 1e-4L)
            return Met::rounding_decides;
        return approach(from) < 0 && least < radii ? Met::yes : Met::no;
    }
};

template <class Real>
std::vector<std::int32_t> found_near(const KernelTable<Real>& kernels, const UniformGrid<Real>& grid,
                                     const Crowd<Real>& crowd, std::size_t row, double reach, bool uniform) {
    std::vector<std::int32_t> found(2048 + 1, kUntouched);
    const FindImpactsNear<Real> k{crowd.x[row],
                                  crowd.y[row],
                                  static_cast<Real>(reach),
                                  crowd.motion.data(),
                                  static_cast<std::int32_t>(row),
                                  uniform ? nullptr : crowd.radius.data(),
                                  Real(0.4),
                                  Real(0.01),
                                  Real(0.05),
                                  Real(0),
                                  found.data(),
                                  2048};
    const auto kernel = uniform ? kernels.find_impacts_near_uniform_radius : kernels.find_impacts_near;
    const std::size_t count = kernel(grid.level(0), k);
    REQUIRE(count <= 2048);
    CHECK(found.back() == kUntouched);
    found.resize(count);
    return found;
}

struct Layout {
    std::size_t bodies, clusters;
    double extent;  // m, between clusters
    double reach;   // m, how far a query looks
};

}  // namespace

TEST_SUITE("kernels/find_impacts_near") {
    TEST_CASE_TEMPLATE(
        "a body finds whom it meets, in a plane that folds or not, near or far, and on every "
        "instruction set the same in the same order",
        Real, float, double) {
        // Bodies have moved by up to .28 m and fly up to .9 m (a diagonal way in .05 s): reach .5 + .28
        // + 1.1.
        for (const Layout& layout : {Layout{90, 1, 0, 0.9}, Layout{200, 1, 0, 1.9}, Layout{200, 4, 1e5, 0.9},
                                     Layout{200, 4, 1e3, 1.9}})
            for (const bool uniform : {false, true}) {
                CAPTURE(layout.bodies);
                CAPTURE(layout.extent);
                const Crowd<Real> crowd(layout.bodies, layout.clusters, layout.extent);
                std::size_t met = 0, wrong = 0;
                std::vector<std::vector<std::int32_t>> first;
                for (const KernelTables* tables : runnable_kernel_tables()) {
                    const KernelTable<Real>& kernels = tables->of<Real>();
                    CAPTURE(kernels.isa);
                    UniformGrid<Real> grid;
                    grid.build(crowd.input(), kernels, Executor(1));
                    std::vector<std::vector<std::int32_t>> all;
                    for (std::size_t row = 0; row < layout.bodies; ++row)
                        all.push_back(found_near(kernels, grid, crowd, row, layout.reach, uniform));
                    if (first.empty()) first = all;
                    CHECK(all == first);
                }
                for (std::size_t a = 0; a < layout.bodies; ++a)
                    for (std::size_t b = 0; b < layout.bodies; ++b) {
                        const long double radii =
                            uniform ? 0.8L : static_cast<long double>(crowd.radius[a] + crowd.radius[b]);
                        const Met expected = a == b ? Met::no : crowd.meets(a, b, radii, 0.01L, 0.05L);
                        // Only bodies that were within reach when the grid was built must be found.
                        const bool must = expected == Met::yes &&
                                          std::hypot(crowd.x[b] - crowd.x[a], crowd.y[b] - crowd.y[a]) <
                                              layout.reach + kReach;
                        const bool is_found = std::count(first[a].begin(), first[a].end(), b) == 1;
                        met += must;
                        wrong += (must && !is_found) || (expected == Met::no && is_found);
                    }
                CHECK(wrong == 0);
                CHECK(met > layout.bodies / 2);
            }
    }

    TEST_CASE_TEMPLATE("a list too short for the cells' bodies is refused", Real, float, double) {
        const Crowd<Real> crowd(200, 1, 0);
        std::vector<std::int32_t> found(4, kUntouched);
        for (const KernelTables* tables : runnable_kernel_tables()) {
            UniformGrid<Real> grid;
            grid.build(crowd.input(), tables->of<Real>(), Executor(1));
            const FindImpactsNear<Real> k{Real(4),    Real(4), Real(0.9),    crowd.motion.data(),
                                          0,          nullptr, Real(0.4),    Real(0),
                                          Real(0.05), Real(0), found.data(), 3};
            CHECK(tables->of<Real>().find_impacts_near_uniform_radius(grid.level(0), k) == kNoRoom);
            CHECK(found[3] == kUntouched);
        }
    }
}

}  // namespace test_find_impacts_near
