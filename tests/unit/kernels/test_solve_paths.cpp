// Contacts along paths against the laws that they must obey, and one instruction set against the other.
#include "isa/select_isa.hpp"
#include "kernels/manifolds/manifold_arguments.hpp"
#include "kernels/paths/path_arguments.hpp"
#include "math/random.hpp"
#include "state/columns/column.hpp"
#include "support/drawn_link.hpp"
#include "support/equal_bits.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace test_solve_paths {

using namespace carom;
using carom::test::have_equal_bits;

namespace {

/// 16 paths of one bundle over random bodies, in random motion; some shorter than others, some end on what
/// nothing moves.
template <class Real>
struct RandomPaths {
    static constexpr double kH = 1.0 / 240;
    std::size_t length;
    std::vector<std::size_t> lengths;
    Column<PathLink<Real>> links;
    std::array<std::size_t, 2> first_link{};
    Column<std::int32_t> heads;
    Column<Real> velocity, displacement, turn, restless;
    std::uint8_t is_slender = 0;
    Column<std::byte> scratch;

    RandomPaths(std::uint64_t seed, std::size_t longest, double friction) : length(longest) {
        Random random(seed);
        const auto draw = [&](double low, double high) {
            return static_cast<Real>(low + (high - low) * static_cast<double>(random.next() % 10001) * 1e-4);
        };
        const std::size_t rows = kPathLanes * (length + 1) + 1;
        const auto still = static_cast<std::int32_t>(rows - 1);
        links.resize(length), heads.resize(kPathLanes);
        velocity.resize(4 * rows), displacement.resize(2 * rows), turn.resize(rows);
        restless.resize(kPathLanes);
        scratch.resize(path_scratch_bytes(length));
        first_link = {0, length};
        for (std::size_t lane = 0; lane < kPathLanes; ++lane) {
            lengths.push_back(1 + random.next() % length);
            if (lane == 0) lengths.back() = length;
            auto row = static_cast<std::int32_t>(lane * (length + 1));
            const auto add_body = [&](std::int32_t at, bool moves) {
                for (std::size_t k = 0; k < 3; ++k)
                    velocity[4 * static_cast<std::size_t>(at) + k] = moves ? draw(-1, 1) : Real(0);
                velocity[4 * static_cast<std::size_t>(at) + 3] = moves ? draw(0.5, 2) : Real(0);
            };
            add_body(row, true), heads[lane] = row;
            for (std::size_t i = 0; i < length; ++i) {
                PathLink<Real>& link = links[i];
                link.separation1[lane] = link.separation2[lane] = static_cast<Real>(kNoPoint);
                link.body[lane] = still;
                if (i >= lengths[lane]) continue;
                link.body[lane] = ++row;
                add_body(row, i + 1 < lengths[lane] || lane % 3 != 0);
                const double angle = static_cast<double>(draw(-0.7, 0.7));
                carom::test::draw_contact(link, lane, angle, static_cast<Real>(friction), draw);
            }
        }
    }

    SolvePaths<Real> arguments() {
        SolvePaths<Real> k{};
        k.links = links.data(), k.first_link = first_link.data(), k.heads = heads.data();
        k.velocity = velocity.data(), k.displacement = displacement.data(), k.turn = turn.data();
        k.restless = restless.data(), k.is_slender = &is_slender;
        k.h = static_cast<Real>(kH), k.inverse_h = static_cast<Real>(1 / kH);
        k.recovery = Real(0.05), k.push = 6, k.velocity_tolerance = Real(1e-5);
        k.bold_iterations = 4, k.most_iterations = k.most_of_slender = 60;
        k.tries_pieces = true, k.sweeps_of_unsettled = 0;
        k.scratch = scratch.data();
        return k;
    }

    std::size_t near_row(std::size_t i, std::size_t lane) const {
        return static_cast<std::size_t>(i == 0 ? heads[lane] : links[i - 1].body[lane]);
    }
    /// Relative velocities of a link: of both points along the normal, of both along the tangent [m/s].
    std::array<double, 3> relative(std::size_t i, std::size_t lane) const {
        const PathLink<Real>& link = links[i];
        const Real *a = &velocity[4 * near_row(i, lane)],
                   *b = &velocity[4 * static_cast<std::size_t>(link.body[lane])];
        const double nx = link.normal_x[lane], ny = link.normal_y[lane], dx = b[0] - a[0], dy = b[1] - a[1];
        return {dx * nx + dy * ny + b[2] * link.far1[lane] - a[2] * link.near1[lane],
                dx * nx + dy * ny + b[2] * link.far2[lane] - a[2] * link.near2[lane],
                dy * nx - dx * ny + b[2] * link.far_t[lane] - a[2] * link.near_t[lane]};
    }
};

/// Bundles one behind the other.
template <class Real>
struct ManyPaths {
    Column<PathLink<Real>> links;
    std::vector<std::size_t> first_link{0};
    Column<std::int32_t> heads;
    Column<Real> velocity, displacement, turn, restless;
    std::vector<std::uint8_t> is_slender;
    Column<std::byte> scratch;

    explicit ManyPaths(const std::vector<RandomPaths<Real>>& bundles) {
        std::size_t longest = 0;
        const auto append = [](auto& to, const auto& from) {
            const std::size_t before = to.size();
            to.resize(before + from.size());
            std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(before));
        };
        for (const RandomPaths<Real>& bundle : bundles) {
            const auto first_row = static_cast<std::int32_t>(turn.size());
            append(links, bundle.links), append(heads, bundle.heads);
            for (std::size_t i = first_link.back(); i < links.size(); ++i)
                for (std::int32_t& row : links[i].body) row += first_row;
            for (std::size_t i = heads.size() - kPathLanes; i < heads.size(); ++i) heads[i] += first_row;
            append(velocity, bundle.velocity), append(displacement, bundle.displacement);
            append(turn, bundle.turn), append(restless, bundle.restless);
            first_link.push_back(links.size()), is_slender.push_back(bundle.is_slender);
            longest = std::max(longest, bundle.length);
        }
        scratch.resize(path_scratch_bytes(longest));
    }
    SolvePaths<Real> arguments(SolvePaths<Real> k) {
        k.links = links.data(), k.first_link = first_link.data(), k.heads = heads.data();
        k.velocity = velocity.data(), k.displacement = displacement.data(), k.turn = turn.data();
        k.restless = restless.data(), k.is_slender = is_slender.data(), k.scratch = scratch.data();
        return k;
    }
};

/// The largest violation of a contact's laws in a settled path [m/s, and impulses in m/s].
template <class Real>
double largest_violation(const RandomPaths<Real>& paths, const std::vector<bool>& settled) {
    double worst = 0;
    const auto note = [&](double violation) { worst = std::max(worst, violation); };
    for (std::size_t lane = 0; lane < kPathLanes; ++lane) {
        if (!settled[lane]) continue;
        for (std::size_t i = 0; i < paths.lengths[lane]; ++i) {
            const PathLink<Real>& link = paths.links[i];
            const auto [v1, v2, vt] = paths.relative(i, lane);
            const std::array<double, 2> excess{v1 - link.floor1[lane], v2 - link.floor2[lane]},
                normal{link.normal1[lane], link.normal2[lane]};
            for (std::size_t k = 0; k < 2; ++k)
                note(-normal[k]), note(-excess[k]), note(std::min(normal[k], excess[k]));
            const double limit = link.friction[lane] * (normal[0] + normal[1]), tangent = link.tangent[lane];
            note(std::fabs(tangent) - limit);
            // It slips only against its friction, and with all of it.
            if (std::fabs(tangent) < limit - 1e-4)
                note(std::fabs(vt));
            else
                note(tangent * vt > 0 ? std::min(std::fabs(vt), std::fabs(tangent)) : 0);
        }
    }
    return worst;
}

/// 16 times the same path: what nothing moves, over a body of 1 kg, over a slope.
/// @param drive   m/s, of what nothing moves, down to the body
/// @param slope   rad, of what lies below the body
/// @param rises   m/s, of that, up to the body
/// @param weight  kg, of that; infinite: nothing moves it
template <class Real>
RandomPaths<Real> pressed_on_a_slope(double drive, double slope, double rises, double weight) {
    RandomPaths<Real> paths(1, 2, 0);
    for (std::size_t lane = 0; lane < kPathLanes; ++lane) {
        paths.lengths[lane] = 2;
        const auto head = static_cast<std::size_t>(paths.heads[lane]);
        const auto set = [&](std::size_t row, double vy, double inverse_mass) {
            Real* record = &paths.velocity[4 * row];
            record[0] = record[2] = 0;
            record[1] = static_cast<Real>(vy), record[3] = static_cast<Real>(inverse_mass);
        };
        set(head, -drive, 0), set(head + 1, 0, 1), set(head + 2, rises, 1 / weight);
        for (std::size_t i = 0; i < 2; ++i) {
            PathLink<Real>& link = paths.links[i];
            const double angle = i == 0 ? 0 : slope;
            link.body[lane] = static_cast<std::int32_t>(head + i + 1);
            link.normal_x[lane] = static_cast<Real>(std::sin(angle));
            link.normal_y[lane] = static_cast<Real>(-std::cos(angle));
            for (auto* lever : {&link.near1, &link.near2, &link.near_t, &link.far1, &link.far2, &link.far_t})
                (*lever)[lane] = 0;
            link.separation1[lane] = 0, link.separation2[lane] = static_cast<Real>(kNoPoint);
            link.friction[lane] = 0, link.thickness[lane] = 1;
            link.normal1[lane] = link.normal2[lane] = link.tangent[lane] = 0;
        }
    }
    return paths;
}

}  // namespace

TEST_SUITE("kernels/paths/solve_paths") {
    // A body under what comes down at 1 m/s slides out along a slope of .2 rad at 1 / tan(.2) = 4.9 m/s,
    // along one of 45 degrees at 1 m/s: docs/decisions/0068-what-stirs-shapes.md.
    TEST_CASE_TEMPLATE("what drives a path bounds its exact solve", Real, float, double) {
        constexpr double kInfinite = std::numeric_limits<double>::infinity(), kHalfRight = 0.785, kFlat = 0.2;
        const auto& kernels = runnable_kernel_tables().front()->of<Real>();
        const auto is_solved = [&](double drive, double slope, double rises, double weight, Real fall = 0) {
            RandomPaths<Real> paths = pressed_on_a_slope<Real>(drive, slope, rises, weight);
            SolvePaths<Real> k = paths.arguments();
            k.fall = fall;
            return kernels.convex->paths.solve(k, 0, 1).unsettled == 0;
        };
        CHECK(is_solved(1, kHalfRight, 0, 1e6));
        CHECK_FALSE(is_solved(1, kFlat, 0, 1e6));
        CHECK_FALSE(is_solved(1, kHalfRight, 0, kInfinite));  // a squeeze
        CHECK(is_solved(0, kFlat, 1, 1e6));                   // nothing drives it
        // What gravity adds to the path in a substep it may take up beside however slow a plate.
        CHECK_FALSE(is_solved(1e-3, kFlat, 1, 1e6));
        CHECK(is_solved(1e-3, kFlat, 1, 1e6, 2));
    }
    TEST_CASE_TEMPLATE("contacts along a path obey their laws all at once", Real, float, double) {
        const auto& kernels = runnable_kernel_tables().front()->of<Real>();
        std::size_t solved = 0, unsettled = 0;
        for (std::uint64_t seed = 1; seed <= 60; ++seed)
            for (const double friction : {0.0, 0.3, 0.8}) {
                RandomPaths<Real> paths(seed, 1 + seed % 16, friction);
                std::vector<bool> settled(kPathLanes, true);
                // A path that does not settle keeps what it had: told by bits that nothing changed.
                RandomPaths<Real> was(seed, 1 + seed % 16, friction);
                unsettled += kernels.convex->paths.solve(paths.arguments(), 0, 1).unsettled;
                for (std::size_t lane = 0; lane < kPathLanes; ++lane) {
                    const auto head = 4 * static_cast<std::size_t>(paths.heads[lane]);
                    settled[lane] =
                        !std::equal(&paths.velocity[head], &paths.velocity[head] + 3, &was.velocity[head]);
                    solved += settled[lane];
                }
                // The kernel makes rows stiffer by 1e-5, and impulses here are a few m/s.
                const double tolerance = std::is_same_v<Real, float> ? 3e-4 : 2e-4;
                CHECK(largest_violation(paths, settled) < tolerance);
            }
        CHECK(solved > 2500);
        CHECK(unsettled < 120);
    }
    TEST_CASE_TEMPLATE("a bundle of which no path was fast is left out, but not one that is slender", Real,
                       float, double) {
        const auto& kernels = runnable_kernel_tables().front()->of<Real>();
        const auto is_left_out = [&](Real resting_speed, bool is_slender, bool is_slow) {
            RandomPaths<Real> paths(5, 8, 0.5);
            const Column<Real> before = paths.velocity;
            paths.is_slender = is_slender ? 1 : 0;
            for (std::size_t lane = 0; lane < kPathLanes; ++lane) paths.restless[lane] = Real(0.1);
            if (!is_slow) paths.restless[kPathLanes - 1] = 2;
            SolvePaths<Real> k = paths.arguments();
            k.resting_speed = resting_speed;
            kernels.convex->paths.solve(k, 0, 1);
            return have_equal_bits(before, paths.velocity);
        };
        CHECK(is_left_out(1, false, true));
        CHECK_FALSE(is_left_out(0, false, true));
        CHECK_FALSE(is_left_out(1, true, true));
        CHECK_FALSE(is_left_out(1, false, false));
        // The slow lanes of a bundle that is not left out are solved with the fast one, whatever the width of
        // a batch, though the first of them may be slow once they are solved.
        for (const KernelTables* tables : runnable_kernel_tables()) {
            RandomPaths<Real> whole(5, 8, 0.5), paths(5, 8, 0.5);
            for (std::size_t lane = 0; lane < kPathLanes; ++lane) paths.restless[lane] = Real(0.1);
            paths.restless[0] = 200;
            SolvePaths<Real> k = paths.arguments();
            k.resting_speed = 100;
            tables->of<Real>().convex->paths.solve(k, 0, 1);
            tables->of<Real>().convex->paths.solve(whole.arguments(), 0, 1);
            CHECK(have_equal_bits(whole.velocity, paths.velocity));
        }
        // What was solved says how fast it was: here up to several m/s, and a path that did not settle never
        // rests.
        RandomPaths<Real> paths(5, 8, 0.5);
        SolvePaths<Real> k = paths.arguments();
        k.most_iterations = 1;
        const std::size_t unsettled = kernels.convex->paths.solve(k, 0, 1).unsettled;
        REQUIRE(unsettled > 0);
        CHECK(std::ranges::count(paths.restless, static_cast<Real>(kUnsettled)) ==
              static_cast<std::ptrdiff_t>(unsettled));
        CHECK(std::ranges::all_of(paths.restless, [](Real speed) { return speed > Real(0.1); }));
    }
    TEST_CASE_TEMPLATE("a slender bundle has iterations of its own", Real, float, double) {
        const auto& kernels = runnable_kernel_tables().front()->of<Real>();
        const auto unsettled = [&](bool is_slender) {
            RandomPaths<Real> paths(5, 8, 0.5);
            paths.is_slender = is_slender ? 1 : 0;
            SolvePaths<Real> k = paths.arguments();
            k.most_iterations = 1;
            return kernels.convex->paths.solve(k, 0, 1).unsettled;
        };
        CHECK(unsettled(false) > 0);
        CHECK(unsettled(true) == 0);
    }
    TEST_CASE_TEMPLATE("contacts that are carried on follow what their bodies have come", Real, float,
                       double) {
        for (const KernelTables* tables : runnable_kernel_tables()) {
            RandomPaths<Real> paths(3, 12, 0.5);
            const RandomPaths<Real> before = paths;
            Random random(9);
            const std::size_t rows = paths.turn.size();
            Column<Real> come(2 * rows), turned(rows);
            for (std::size_t i = 0; i + 1 < rows; ++i)  // the last row is at rest
                for (Real* value : {&come[2 * i], &come[2 * i + 1], &turned[i]})
                    *value = static_cast<Real>(1e-6 * static_cast<double>(random.next() % 2001) - 1e-3);
            SolvePaths<Real> k = paths.arguments();
            k.come = come.data(), k.turned = turned.data();
            tables->of<Real>().convex->paths.carry(k, 0, 1);
            double worst = 0;
            for (std::size_t lane = 0; lane < kPathLanes; ++lane)
                for (std::size_t i = 0; i < paths.lengths[lane]; ++i) {
                    const PathLink<Real>&link = paths.links[i], &old = before.links[i];
                    const std::size_t a = paths.near_row(i, lane),
                                      b = static_cast<std::size_t>(link.body[lane]);
                    const double dx = static_cast<double>(come[2 * b]) - come[2 * a],
                                 dy = static_cast<double>(come[2 * b + 1]) - come[2 * a + 1],
                                 along = dx * old.normal_x[lane] + dy * old.normal_y[lane];
                    const double opened1 = along + turned[b] * old.far1[lane] - turned[a] * old.near1[lane],
                                 opened2 = along + turned[b] * old.far2[lane] - turned[a] * old.near2[lane];
                    worst =
                        std::max({worst, std::fabs(link.separation1[lane] - old.separation1[lane] - opened1),
                                  std::fabs(link.separation2[lane] - old.separation2[lane] - opened2)});
                }
            CHECK(worst < 2e-9);  // m, round-off in single precision of separations of 2 mm
            CHECK(have_equal_bits(paths.velocity, before.velocity));
        }
    }
    TEST_CASE_TEMPLATE("paths that do not settle come to the same in a batch of their own", Real, float,
                       double) {
        std::vector<RandomPaths<Real>> bundles;
        for (const std::size_t length : {16U, 16U, 16U, 9U, 9U, 16U})
            bundles.emplace_back(100 + bundles.size(), length, 0.5);
        for (const KernelTables* tables : runnable_kernel_tables())
            for (const bool tries_pieces : {true, false}) {
                const auto& kernels = tables->of<Real>().convex->paths;
                ManyPaths<Real> together(bundles), apart(bundles);
                SolvePaths<Real> k = bundles.front().arguments();
                k.most_iterations = k.most_of_slender = 3, k.tries_pieces = tries_pieces;
                k.sweeps_of_unsettled = 2;
                const std::size_t unsettled =
                    kernels.solve(together.arguments(k), 0, bundles.size()).unsettled;
                std::size_t of_each = 0, with_some = 0;
                for (std::size_t bundle = 0; bundle < bundles.size(); ++bundle) {
                    const std::size_t of_this =
                        kernels.solve(apart.arguments(k), bundle, bundle + 1).unsettled;
                    of_each += of_this, with_some += of_this > 0 ? 1 : 0;
                }
                CHECK(with_some == bundles.size());
                CHECK(unsettled == of_each);
                CHECK(have_equal_bits(together.velocity, apart.velocity));
                CHECK(have_equal_bits(together.restless, apart.restless));
                CHECK(have_equal_bits(together.links, apart.links));
            }
    }
    TEST_CASE_TEMPLATE("every instruction set gives the same bits", Real, float, double) {
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
            RandomPaths<Real> first(seed, 1 + seed % 16, 0.5);
            bool is_first = true;
            PathCounts first_counts;
            for (const KernelTables* tables : runnable_kernel_tables()) {
                RandomPaths<Real> paths(seed, 1 + seed % 16, 0.5);
                SolvePaths<Real> k = paths.arguments();
                k.bold_iterations = 2, k.most_iterations = k.most_of_slender = 3,
                k.tries_pieces = seed % 2 == 0, k.sweeps_of_unsettled = 4;  // so that some do not settle
                const auto& kernels = tables->of<Real>().convex->paths;
                kernels.warm_start(k, 0, 1);
                const PathCounts counts = kernels.solve(k, 0, 1);
                kernels.sweep(k, 0, 1);
                if (is_first) {
                    first = paths, first_counts = counts, is_first = false;
                    continue;
                }
                CHECK(counts.unsettled == first_counts.unsettled);
                CHECK(have_equal_bits(first.velocity, paths.velocity));
                CHECK(have_equal_bits(first.displacement, paths.displacement));
                CHECK(have_equal_bits(first.turn, paths.turn));
                CHECK(have_equal_bits(first.restless, paths.restless));
                CHECK(have_equal_bits(first.links, paths.links));
            }
        }
    }
}

}  // namespace test_solve_paths
