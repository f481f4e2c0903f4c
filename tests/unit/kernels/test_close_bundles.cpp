// Hinges that are open, closed by displacement, a mechanism a lane: against the least displacement that a
// dense system in double precision finds.
#include "isa/select_isa.hpp"
#include "math/rotation.hpp"
#include "math/vec2_math.hpp"
#include "solvers/joints/joint_bundles.hpp"
#include "state/columns/column.hpp"
#include "support/draw.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <utility>
#include <vector>

namespace test_close_bundles {

using namespace carom;

namespace {

/// A trunk with two arms of two limbs; the last hinge has its parent as b, the second has no part about its
/// angle.
constexpr std::size_t kBodies = 5, kHinges = 4, kAngles = 3;
constexpr std::array<std::array<std::int32_t, 2>, kHinges> kJoined{{{0, 1}, {0, 3}, {1, 2}, {4, 3}}};
constexpr std::array<JointBranch, kHinges> kTree{
    {{.hinge = 0, .angle = 0, .parent = 0, .child = 1, .parent_is_a = true},
     {.hinge = 1, .angle = -1, .parent = 0, .child = 3, .parent_is_a = true},
     {.hinge = 2, .angle = 1, .parent = 1, .child = 2, .parent_is_a = true},
     {.hinge = 3, .angle = 2, .parent = 3, .child = 4, .parent_is_a = false}}};
constexpr std::array<std::size_t, kAngles> kHingeOfAngle{0, 2, 3};
constexpr std::size_t kMechanisms = 21;  // a whole bundle and a part of one
constexpr double kNoEnd = 1e30;

/// Solves a x = b by elimination.
std::vector<double> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
    const std::size_t n = b.size();
    for (std::size_t i = 0; i < n; ++i) {
        std::size_t pivot = i;
        for (std::size_t r = i + 1; r < n; ++r)
            if (std::fabs(a[r][i]) > std::fabs(a[pivot][i])) pivot = r;
        std::swap(a[i], a[pivot]), std::swap(b[i], b[pivot]);
        for (std::size_t r = i + 1; r < n; ++r) {
            const double by = a[r][i] / a[i][i];
            for (std::size_t c = i; c < n; ++c) a[r][c] -= by * a[i][c];
            b[r] -= by * b[i];
        }
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t c = i + 1; c < n; ++c) b[i] -= a[i][c] * b[c];
        b[i] /= a[i][i];
    }
    return b;
}

/// Mechanisms whose hinges are open, some of them with both ends of their angle in one, which are held as
/// welds are; every ninth body does not turn.
template <class Real>
struct Crowd {
    std::vector<JointBundle> bundles;
    std::vector<std::int32_t> rows;  // [bodies of all bundles][kJointBlock]
    Column<std::int32_t> hinge_a, hinge_b;
    enum : std::size_t {
        kStartX,
        kStartY,
        kArmAX,
        kArmAY,
        kArmBX,
        kArmBY,
        kPerRimA,
        kPerRimB,
        kNumbers = 12
    };
    std::array<Column<Real>, kNumbers> hinges;  // and room for the arms of now
    Column<Real> angle, lower, upper;           // of angles
    Column<Real> velocity, displacement, turn, inverse_rim;

    /// @param open  m, of each component of a gap at most
    explicit Crowd(double open) {
        std::mt19937 random(3);
        const auto draw = [&](double low, double high) {
            return static_cast<Real>(low + (high - low) * static_cast<double>(random()) / 4294967296.0);
        };
        const std::size_t all = padded(kMechanisms * kBodies + 2);  // and a row at rest for each bundle
        velocity.resize(4 * all), displacement.resize(2 * all), turn.resize(all), inverse_rim.resize(all);
        std::vector<std::int32_t> order(kMechanisms * kBodies);
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::int32_t>(i);
        std::shuffle(order.begin(), order.end(), random);
        for (std::size_t row = 0; row < order.size(); ++row) {
            velocity[4 * row + 3] = draw(0.5, 5) * static_cast<Real>(row % 9 == 4 ? -1 : 1);
            for (std::size_t k = 0; k < 2; ++k) displacement[2 * row + k] = draw(-0.02, 0.02);
            inverse_rim[row] = draw(4, 9), turn[row] = draw(-0.02, 0.02);
        }
        for (Column<Real>& column : hinges) column.resize(2 * kHinges * kJointBlock);
        hinge_a.resize(2 * kHinges * kJointBlock), hinge_b.resize(2 * kHinges * kJointBlock);
        for (Column<Real>* column : {&angle, &lower, &upper}) column->resize(2 * kAngles * kJointBlock);
        for (std::size_t bundle = 0; bundle < 2; ++bundle) {
            const std::size_t mechanisms = std::min(kMechanisms - bundle * kJointBlock, kJointBlock);
            bundles.push_back({.mechanisms = mechanisms,
                               .bodies = kBodies,
                               .first_body = bundle * kBodies,
                               .hinges = kHinges,
                               .first_hinge = bundle * kHinges * kJointBlock,
                               .angles = kAngles,
                               .first_angle = bundle * kAngles * kJointBlock,
                               .branches = kHinges,
                               .first_branch = 0});
            for (std::size_t body = 0; body < kBodies; ++body)
                for (std::size_t lane = 0; lane < kJointBlock; ++lane)
                    rows.push_back(lane < mechanisms ? order[(bundle * kJointBlock + lane) * kBodies + body]
                                                     : static_cast<std::int32_t>(order.size() + bundle));
            for (std::size_t lane = 0; lane < kJointBlock; ++lane) {
                for (std::size_t j = 0; j < kHinges; ++j) {
                    const std::size_t at = (bundle * kHinges + j) * kJointBlock + lane;
                    hinge_a[at] = kJoined[j][0], hinge_b[at] = kJoined[j][1];
                    if (lane < mechanisms) add_hinge(bundle * kJointBlock + lane, j, at, open, draw);
                    // As the start of a step leaves lanes without a mechanism.
                    if (lane >= mechanisms) hinges[kStartX][at] = hinges[kStartY][at] = Real(0.3);
                }
                for (std::size_t j = 0; j < kAngles && lane < mechanisms; ++j) {
                    const std::size_t at = (bundle * kAngles + j) * kJointBlock + lane;
                    angle[at] = draw(-1, 1), lower[at] = draw(-1, 1);
                    upper[at] = draw(-1, 1) > Real(0.5) ? lower[at] : static_cast<Real>(kNoEnd);
                }
            }
        }
    }
    std::size_t row(std::size_t mechanism, std::size_t body) const {
        return static_cast<std::size_t>(
            rows[(mechanism / kJointBlock * kBodies + body) * kJointBlock + mechanism % kJointBlock]);
    }
    static std::size_t place(std::size_t mechanism, std::size_t j, std::size_t of_each) {
        return (mechanism / kJointBlock * of_each + j) * kJointBlock + mechanism % kJointBlock;
    }
    template <class Draw>
    void add_hinge(std::size_t mechanism, std::size_t j, std::size_t at, double open, const Draw& draw) {
        for (const std::size_t arm : {kArmAX, kArmAY, kArmBX, kArmBY})
            hinges[arm][at] = draw(0.05, 0.3) * static_cast<Real>(random_sign(at + arm));
        hinges[kPerRimA][at] = inverse_rim[row(mechanism, static_cast<std::size_t>(kJoined[j][0]))];
        hinges[kPerRimB][at] = inverse_rim[row(mechanism, static_cast<std::size_t>(kJoined[j][1]))];
        const Vec2 gap = gap_of(mechanism, j);
        hinges[kStartX][at] = static_cast<Real>(-gap.x) + draw(-open, open);
        hinges[kStartY][at] = static_cast<Real>(-gap.y) + draw(-open, open);
    }
    static double random_sign(std::size_t number) { return number % 3 == 0 ? -1 : 1; }
    double turned(std::size_t row) const {
        return static_cast<double>(turn[row]) * static_cast<double>(inverse_rim[row]);
    }
    std::array<Vec2, 2> arms_of(std::size_t mechanism, std::size_t j) const {
        const std::size_t at = place(mechanism, j, kHinges);
        const auto arm = [&](std::size_t side, std::size_t x) {
            const double by = turned(row(mechanism, static_cast<std::size_t>(kJoined[j][side])));
            return rotate(rotation_by(by), Vec2{hinges[x][at], hinges[x + 1][at]});
        };
        return {arm(0, kArmAX), arm(1, kArmBX)};
    }
    /// From a's anchor to b's [m].
    Vec2 gap_of(std::size_t mechanism, std::size_t j) const {
        const std::size_t at = place(mechanism, j, kHinges);
        const auto moved = [&](std::size_t side) {
            const std::size_t of = row(mechanism, static_cast<std::size_t>(kJoined[j][side]));
            return Vec2{displacement[2 * of], displacement[2 * of + 1]};
        };
        const auto [a, b] = arms_of(mechanism, j);
        return Vec2{hinges[kStartX][at], hinges[kStartY][at]} + moved(1) - moved(0) + b - a;
    }
    double limb_of(std::size_t mechanism, std::size_t j) const {
        const auto [a, b] = arms_of(mechanism, j);
        return std::sqrt(length_squared(a)) + std::sqrt(length_squared(b));
    }
    bool is_held(std::size_t mechanism, std::size_t j) const {
        const std::size_t at = place(mechanism, j, kAngles);
        return lower[at] == upper[at];
    }
    /// The least displacement, weighed by mass, of all that close the hinges of a mechanism and turn no joint
    /// that is held: x, y [m] and turn [rad] of each body.
    std::vector<double> least_displacement(std::size_t mechanism) const {
        std::vector<std::vector<double>> rows_of;  // of the conditions, by unknown
        std::vector<double> wanted;
        for (std::size_t j = 0; j < kHinges; ++j) {
            const auto [a, b] = arms_of(mechanism, j);
            const Vec2 gap = gap_of(mechanism, j);
            for (const bool is_x : {true, false}) {
                std::vector<double> row(3 * kBodies);
                const auto body_a = 3 * static_cast<std::size_t>(kJoined[j][0]),
                           body_b = 3 * static_cast<std::size_t>(kJoined[j][1]);
                row[body_b + (is_x ? 0 : 1)] = 1, row[body_a + (is_x ? 0 : 1)] = -1;
                row[body_b + 2] = is_x ? -b.y : b.x, row[body_a + 2] = is_x ? a.y : -a.x;
                rows_of.push_back(row), wanted.push_back(is_x ? -gap.x : -gap.y);
            }
        }
        for (std::size_t j = 0; j < kAngles; ++j) {
            if (!is_held(mechanism, j)) continue;
            std::vector<double> row(3 * kBodies);
            row[3 * static_cast<std::size_t>(kJoined[kHingeOfAngle[j]][1]) + 2] = 1;
            row[3 * static_cast<std::size_t>(kJoined[kHingeOfAngle[j]][0]) + 2] = -1;
            rows_of.push_back(row), wanted.push_back(0);
        }
        std::vector<double> inverse(3 * kBodies);
        for (std::size_t body = 0; body < kBodies; ++body) {
            const std::size_t of = row(mechanism, body);
            const double w = velocity[4 * of + 3], per_rim = inverse_rim[of];
            inverse[3 * body] = inverse[3 * body + 1] = std::fabs(w);
            // Both of a held angle that do not turn: no system has a solution where nothing gives way.
            inverse[3 * body + 2] = w > 0 ? 2 * w * per_rim * per_rim : 1e-30;
        }
        std::vector<std::vector<double>> matrix(wanted.size(), std::vector<double>(wanted.size()));
        for (std::size_t i = 0; i < wanted.size(); ++i)
            for (std::size_t k = 0; k < wanted.size(); ++k)
                for (std::size_t u = 0; u < inverse.size(); ++u)
                    matrix[i][k] += rows_of[i][u] * inverse[u] * rows_of[k][u];
        const std::vector<double> push = solve(matrix, wanted);
        std::vector<double> least(inverse.size());
        for (std::size_t u = 0; u < inverse.size(); ++u)
            for (std::size_t i = 0; i < wanted.size(); ++i) least[u] += inverse[u] * rows_of[i][u] * push[i];
        return least;
    }
    CloseBundles<Real> arguments() {
        CloseBundles<Real> k{};
        JointColumns<Real>& of = k.hinges.joints;
        of.a = hinge_a.data(), of.b = hinge_b.data();
        Real** const to[] = {&of.start_x,       &of.start_y,       &of.start_arm_a_x, &of.start_arm_a_y,
                             &of.start_arm_b_x, &of.start_arm_b_y, &of.per_rim_a,     &of.per_rim_b,
                             &of.arm_a_x,       &of.arm_a_y,       &of.arm_b_x,       &of.arm_b_y};
        for (std::size_t i = 0; i < kNumbers; ++i) *to[i] = hinges[i].data();
        of.seen_a = of.per_rim_a, of.seen_b = of.per_rim_b;  // are loaded, no more
        k.hinges.velocity = velocity.data(), k.hinges.displacement = displacement.data();
        k.hinges.turn = turn.data();
        k.angles.start_x = angle.data(), k.angles.lower = lower.data(), k.angles.upper = upper.data();
        k.bundles = bundles.data(), k.rows = rows.data(), k.branches = kTree.data();
        return k;
    }
    std::vector<Real> places() const {
        std::vector<Real> all(displacement.begin(), displacement.end());
        all.insert(all.end(), turn.begin(), turn.end());
        return all;
    }
};

}  // namespace

TEST_SUITE("kernels/close bundles") {
    TEST_CASE_TEMPLATE("hinges of a tree are closed by the least displacement, all at once", Real, float,
                       double) {
        const double near = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-14;
        std::vector<Real> bits;
        for (const KernelTables* tables : runnable_kernel_tables()) {
            CAPTURE(tables->of<Real>().isa);
            Crowd<Real> crowd(0.03);
            const Crowd<Real> before = crowd;
            CloseBundles<Real> k = crowd.arguments();
            k.rounds = 1;
            CHECK(tables->of<Real>().close_bundles(k, 0, crowd.bundles.size()) == kMechanisms);
            std::size_t held = 0;
            for (std::size_t mechanism = 0; mechanism < kMechanisms; ++mechanism) {
                CAPTURE(mechanism);
                for (std::size_t j = 0; j < kAngles; ++j) held += before.is_held(mechanism, j);
                const std::vector<double> least = before.least_displacement(mechanism);
                for (std::size_t body = 0; body < kBodies; ++body) {
                    const std::size_t row = crowd.row(mechanism, body);
                    const auto moved = [&](std::size_t at) {
                        return static_cast<double>(crowd.displacement[at]) -
                               static_cast<double>(before.displacement[at]);
                    };
                    CHECK(std::fabs(moved(2 * row) - least[3 * body]) < near);
                    CHECK(std::fabs(moved(2 * row + 1) - least[3 * body + 1]) < near);
                    CHECK(std::fabs(crowd.turned(row) - before.turned(row) - least[3 * body + 2]) <
                          10 * near);
                }
            }
            CHECK(held > 0);
            CHECK(held < kMechanisms * kAngles);
            // The rows of lanes without a mechanism stay at rest.
            for (std::size_t i = 2 * kMechanisms * kBodies; i < crowd.displacement.size(); ++i)
                CHECK(crowd.displacement[i] == Real(0));
            const std::vector<Real> places = crowd.places();
            if (bits.empty()) bits = places;
            CHECK(std::memcmp(places.data(), bits.data(), bits.size() * sizeof(Real)) == 0);
        }
    }

    TEST_CASE_TEMPLATE("what is open by more than a share of a limb is closed up to one, nothing else moves",
                       Real, float, double) {
        std::vector<Real> bits;
        for (const KernelTables* tables : runnable_kernel_tables()) {
            CAPTURE(tables->of<Real>().isa);
            Crowd<Real> crowd(0.008);
            const Crowd<Real> before = crowd;
            constexpr double kOpen = 0.02, kLeft = 0.015;
            const auto widest = [](const Crowd<Real>& of, std::size_t mechanism) {
                double most = 0;
                for (std::size_t j = 0; j < kHinges; ++j)
                    most = std::fmax(
                        most, std::sqrt(length_squared(of.gap_of(mechanism, j))) / of.limb_of(mechanism, j));
                return most;
            };
            CloseBundles<Real> k = crowd.arguments();
            k.open = static_cast<Real>(kOpen), k.left = static_cast<Real>(kLeft), k.rounds = 3;
            const std::size_t closed = tables->of<Real>().close_bundles(k, 0, crowd.bundles.size());
            std::size_t open = 0;
            for (std::size_t mechanism = 0; mechanism < kMechanisms; ++mechanism) {
                CAPTURE(mechanism);
                CHECK(widest(crowd, mechanism) < kOpen * (1 + 1e-5));
                if (widest(before, mechanism) > kOpen) {
                    ++open;
                    CHECK(widest(crowd, mechanism) > kLeft * 0.5);
                    continue;
                }
                for (std::size_t body = 0; body < kBodies; ++body) {
                    const std::size_t row = crowd.row(mechanism, body);
                    CHECK(crowd.displacement[2 * row] == before.displacement[2 * row]);
                    CHECK(crowd.displacement[2 * row + 1] == before.displacement[2 * row + 1]);
                    CHECK(crowd.turn[row] == before.turn[row]);
                }
            }
            CHECK(closed == open);
            CHECK(open > 0);
            CHECK(open < kMechanisms);
            const std::vector<Real> places = crowd.places();
            if (bits.empty()) bits = places;
            CHECK(std::memcmp(places.data(), bits.data(), bits.size() * sizeof(Real)) == 0);
        }
    }

    TEST_CASE("hinges are a tree, parents before their children, unless they close a loop") {
        Mechanism chain;
        chain.rows = {5, 6, 7}, chain.hinges = {{3, 0, 1}, {4, 2, 1}}, chain.angles = {{4, 2, 1}};
        const std::vector<JointBranch> tree = chain.tree();
        REQUIRE(tree.size() == 2);
        CHECK(tree[0].hinge == 0);
        CHECK(tree[0].angle == -1);
        CHECK(tree[0].parent == 0);
        CHECK(tree[0].child == 1);
        CHECK(tree[0].parent_is_a);
        CHECK(tree[1].hinge == 1);
        CHECK(tree[1].angle == 0);
        CHECK(tree[1].parent == 1);
        CHECK(tree[1].child == 2);
        CHECK(!tree[1].parent_is_a);
        Mechanism loop = chain, twice = chain;
        loop.hinges.push_back({5, 0, 2});
        CHECK(loop.tree().empty());
        twice.hinges[1] = {4, 1, 0};  // the third body hangs on nothing
        CHECK(twice.tree().empty());
    }

    TEST_CASE("mechanisms that are no tree stay as they are") {
        for (const KernelTables* tables : runnable_kernel_tables()) {
            CAPTURE(tables->of<double>().isa);
            Crowd<double> crowd(0.03);
            const Crowd<double> before = crowd;
            crowd.bundles[0].branches = 0;
            CloseBundles<double> k = crowd.arguments();
            k.rounds = 3;
            CHECK(tables->of<double>().close_bundles(k, 0, 2) == kMechanisms - kJointBlock);
            for (std::size_t mechanism = 0; mechanism < kJointBlock; ++mechanism)
                for (std::size_t body = 0; body < kBodies; ++body) {
                    const std::size_t row = crowd.row(mechanism, body);
                    CHECK(crowd.displacement[2 * row] == before.displacement[2 * row]);
                    CHECK(crowd.turn[row] == before.turn[row]);
                }
        }
    }
}

}  // namespace test_close_bundles
