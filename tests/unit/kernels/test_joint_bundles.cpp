// Crowds of mechanisms by lanes: sweeps give each of them the bits of sweeps over its joints one by one, and
// the start of a step what formulas for one joint in double precision say.
#include "isa/select_isa.hpp"
#include "math/rotation.hpp"
#include "math/vec2_math.hpp"
#include "state/columns/column.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

namespace test_joint_bundles {

using namespace carom;

namespace {

enum Kind : std::size_t { kHinges = 2, kAngles = 5 };  // as KernelTable::joints has them

/// A mechanism is a trunk with two arms of two limbs.
constexpr std::size_t kBodies = 5, kJoints = 4;
constexpr std::array<std::array<std::int32_t, 2>, kJoints> kJoined{{{0, 1}, {0, 3}, {1, 2}, {4, 3}}};
constexpr std::size_t kMechanisms = 21;  // a whole bundle and a part of one

/// Columns of joints of one kind.
template <class Real>
struct Columns {
    Column<std::int32_t> row_a, row_b, of_bundle_a, of_bundle_b;
    std::vector<RowOrder> order;
    std::array<Column<Real>, 31> numbers;

    explicit Columns(std::size_t places) : order(places / kJointBlock, RowOrder::any) {
        for (Column<std::int32_t>* column : {&row_a, &row_b, &of_bundle_a, &of_bundle_b})
            column->resize(places);
        for (Column<Real>& column : numbers) column.resize(places);
    }
    JointColumns<Real> joints(bool are_of_bundle) {
        std::array<Real*, 31> to{};
        for (std::size_t i = 0; i < to.size(); ++i) to[i] = numbers[i].data();
        JointColumns<Real> columns{};
        columns.a = are_of_bundle ? of_bundle_a.data() : row_a.data();
        columns.b = are_of_bundle ? of_bundle_b.data() : row_b.data();
        columns.order = order.data();
        Real** at[] = {
            &columns.start_x,       &columns.start_y,       &columns.length,        &columns.impulse_x,
            &columns.impulse_y,     &columns.normal_x,      &columns.normal_y,      &columns.per_length,
            &columns.start_arm_a_x, &columns.start_arm_a_y, &columns.start_arm_b_x, &columns.start_arm_b_y,
            &columns.arm_a_x,       &columns.arm_a_y,       &columns.arm_b_x,       &columns.arm_b_y,
            &columns.per_rim_a,     &columns.per_rim_b,     &columns.seen_a,        &columns.seen_b,
            &columns.impulse_z,     &columns.impulse_w,     &columns.value,         &columns.alpha,
            &columns.gamma,         &columns.lower,         &columns.upper,         &columns.lower_rate,
            &columns.upper_rate,    &columns.speed,         &columns.most};
        for (std::size_t i = 0; i < to.size(); ++i) *at[i] = to[i];
        return columns;
    }
};

/// Mechanisms whose bodies lie anywhere in memory, in motion and off their joints.
template <class Real>
struct Crowd {
    std::vector<JointBundle> bundles;
    std::vector<std::int32_t> rows;  // [bodies of all bundles][kJointBlock]
    Columns<Real> hinges, angles;
    Column<Real> velocity, displacement, turn, position_x, position_y, angle;
    bool has_drives = true;  // told to kernels

    Crowd() : hinges(2 * kJoints * kJointBlock), angles(2 * kJoints * kJointBlock) {
        std::mt19937 random(11);
        const auto draw = [&](double low, double high) {
            return static_cast<Real>(low + (high - low) * static_cast<double>(random()) / 4294967296.0);
        };
        std::vector<std::int32_t> order(kMechanisms * kBodies);
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::int32_t>(i);
        std::shuffle(order.begin(), order.end(), random);
        const std::size_t all = padded(order.size() + 2);  // and a row at rest for each bundle
        velocity.resize(4 * all), displacement.resize(2 * all), turn.resize(all);
        for (Column<Real>* column : {&position_x, &position_y, &angle}) column->resize(all);
        for (std::size_t row = 0; row < order.size(); ++row) {
            for (std::size_t k = 0; k < 3; ++k) velocity[4 * row + k] = draw(-3, 3);
            velocity[4 * row + 3] = draw(0.5, 5) * (row % 9 == 4 ? -1 : 1);  // some do not turn
            for (std::size_t k = 0; k < 2; ++k) displacement[2 * row + k] = draw(-0.02, 0.02);
            turn[row] = draw(-0.05, 0.05);
            position_x[row] = draw(-50, 50), position_y[row] = draw(-50, 50), angle[row] = draw(-7, 7);
        }
        for (std::size_t bundle = 0; bundle < 2; ++bundle) {
            const std::size_t first = bundle * kJoints * kJointBlock,
                              mechanisms = std::min(kMechanisms - bundle * kJointBlock, kJointBlock);
            bundles.push_back({mechanisms, kBodies, bundle * kBodies, kJoints, first, kJoints, first});
            const auto row_of = [&](std::size_t mechanism, std::size_t body) {
                const std::size_t number = (bundle * kJointBlock + mechanism) * kBodies + body;
                return mechanism < mechanisms ? order[number]
                                              : static_cast<std::int32_t>(order.size() + bundle);
            };
            for (std::size_t body = 0; body < kBodies; ++body)
                for (std::size_t lane = 0; lane < kJointBlock; ++lane) rows.push_back(row_of(lane, body));
            for (Columns<Real>* columns : {&hinges, &angles})
                for (std::size_t j = 0; j < kJoints; ++j)
                    for (std::size_t lane = 0; lane < kJointBlock; ++lane) {
                        const std::size_t at = first + kJointBlock * j + lane;
                        const auto [a, b] = kJoined[j];
                        columns->row_a[at] = row_of(lane, static_cast<std::size_t>(a));
                        columns->row_b[at] = row_of(lane, static_cast<std::size_t>(b));
                        columns->of_bundle_a[at] = a, columns->of_bundle_b[at] = b;
                        if (lane < mechanisms) fill(*columns, at, draw);
                    }
        }
    }
    template <class Draw>
    static void fill(Columns<Real>& columns, std::size_t at, const Draw& draw) {
        for (Column<Real>& column : columns.numbers) column[at] = draw(-0.3, 0.3);
        const JointColumns<Real> joints = columns.joints(false);
        joints.per_rim_a[at] = draw(2, 9), joints.per_rim_b[at] = draw(2, 9);
        joints.seen_a[at] = draw(0.5, 1), joints.seen_b[at] = Real(1);
        joints.lower[at] = draw(-0.2, 0), joints.upper[at] = draw(0, 0.2);
        joints.alpha[at] = joints.gamma[at] = Real(0);
        joints.most[at] = draw(0, 0.01), joints.lower_rate[at] = joints.upper_rate[at] = Real(0);
        joints.impulse_z[at] = draw(0, 0.2), joints.impulse_w[at] = draw(-0.2, 0);
    }
    SweepJoints<Real> sweep(Columns<Real>& columns, bool are_of_bundle) {
        SweepJoints<Real> k{};
        k.joints = columns.joints(are_of_bundle);
        k.velocity = velocity.data(), k.displacement = displacement.data(), k.turn = turn.data();
        k.h = Real(1.0 / 240), k.half_h = Real(1.0 / 480), k.per_h = Real(240);
        k.has_springs = has_drives, k.has_motors = has_drives;
        k.recovery = Real(0.4), k.most = Real(0.3), k.over_relaxation = Real(1);
        return k;
    }
    /// Everything that sweeps write, of bodies and joints that there are.
    std::vector<Real> written() {
        std::vector<Real> all;
        for (std::size_t row = 0; row < kMechanisms * kBodies; ++row) {
            for (std::size_t k = 0; k < 4; ++k) all.push_back(velocity[4 * row + k]);
            for (std::size_t k = 0; k < 2; ++k) all.push_back(displacement[2 * row + k]);
            all.push_back(turn[row]);
        }
        for (Columns<Real>* columns : {&hinges, &angles})
            for (Column<Real>& column : columns->numbers)
                for (const JointBundle& bundle : bundles)
                    for (std::size_t j = 0; j < kJoints; ++j)
                        for (std::size_t lane = 0; lane < bundle.mechanisms; ++lane)
                            all.push_back(column[bundle.first_hinge + kJointBlock * j + lane]);
        return all;
    }
};

/// Two sweeps, joint by joint, by the kernels for joints that lie anywhere.
template <class Real>
void sweep_one_by_one(Crowd<Real>& crowd, bool gives, bool begins) {
    const KernelTable<Real>& kernels = runnable_kernel_tables().front()->of<Real>();
    REQUIRE(kernels.isa == "scalar");
    const SweepJoints<Real> hinges = crowd.sweep(crowd.hinges, false),
                            angles = crowd.sweep(crowd.angles, false);
    using Sweep = typename JointKernels<Real>::Sweep;
    const auto run = [&](Sweep JointKernels<Real>::*sweep) {
        for (const JointBundle& bundle : crowd.bundles)
            for (const auto& [kind, k] : {std::pair{kHinges, &hinges}, {kAngles, &angles}})
                for (std::size_t j = 0; j < kJoints; ++j)
                    for (std::size_t lane = 0; lane < bundle.mechanisms; ++lane) {
                        const std::size_t at = bundle.first_hinge + kJointBlock * j + lane;
                        (kernels.joints[kind].*sweep)(*k, at, at + 1);
                    }
    };
    if (gives) run(&JointKernels<Real>::give);
    run(begins ? &JointKernels<Real>::first : &JointKernels<Real>::next);
    run(&JointKernels<Real>::next);
}

}  // namespace

TEST_SUITE("kernels/joint bundles") {
    TEST_CASE_TEMPLATE("a mechanism in a bundle is swept as joint by joint", Real, float, double) {
        for (const KernelTables* tables : runnable_kernel_tables())
            for (const int sweep : {0, 1, 2}) {  // of a step, of a substep, of a turn
                const bool gives = sweep == 0, begins = sweep < 2;
                CAPTURE(tables->of<Real>().isa);
                CAPTURE(gives);
                CAPTURE(begins);
                Crowd<Real> in_bundles, one_by_one;
                const std::vector<Real> before = in_bundles.written();
                SweepBundles<Real> k{in_bundles.sweep(in_bundles.hinges, true),
                                     in_bundles.sweep(in_bundles.angles, true),
                                     in_bundles.bundles.data(),
                                     in_bundles.rows.data(),
                                     gives,
                                     begins};
                tables->of<Real>().sweep_bundles(k, 0, in_bundles.bundles.size());
                sweep_one_by_one(one_by_one, gives, begins);
                const std::vector<Real> swept = in_bundles.written(), expected = one_by_one.written();
                REQUIRE(swept.size() == expected.size());
                CHECK(std::memcmp(swept.data(), expected.data(), swept.size() * sizeof(Real)) == 0);
                CHECK(swept != before);
                // The rows of lanes without a mechanism stay at rest.
                for (std::size_t i = 4 * kMechanisms * kBodies; i < in_bundles.velocity.size(); ++i)
                    CHECK(in_bundles.velocity[i] == Real(0));
            }
    }

    TEST_CASE_TEMPLATE("springs and motors that no joint has are left out, with the same velocities", Real,
                       float, double) {
        for (const KernelTables* tables : runnable_kernel_tables()) {
            CAPTURE(tables->of<Real>().isa);
            std::array<std::vector<Real>, 2> velocities;
            for (const bool has_drives : {false, true}) {
                Crowd<Real> crowd;
                crowd.has_drives = has_drives;
                const JointColumns<Real> angles = crowd.angles.joints(true);
                for (std::size_t at = 0; at < crowd.angles.row_a.size(); ++at)
                    angles.impulse_x[at] = angles.impulse_y[at] = angles.most[at] = Real(0);
                const SweepBundles<Real> k{crowd.sweep(crowd.hinges, true),
                                           crowd.sweep(crowd.angles, true),
                                           crowd.bundles.data(),
                                           crowd.rows.data(),
                                           true,
                                           true};
                tables->of<Real>().sweep_bundles(k, 0, crowd.bundles.size());
                velocities[has_drives ? 1 : 0].assign(crowd.velocity.begin(), crowd.velocity.end());
            }
            CHECK(velocities[0] == velocities[1]);
        }
    }

    TEST_CASE_TEMPLATE("a mechanism in a bundle begins a step as its joints do, one by one", Real, float,
                       double) {
        constexpr double kLeast = 0.02;  // s
        for (const KernelTables* tables : runnable_kernel_tables()) {
            CAPTURE(tables->of<Real>().isa);
            Crowd<Real> crowd;
            std::mt19937 random(5);
            const auto draw = [&](double low, double high) {
                return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
            };
            const std::size_t places = crowd.hinges.row_a.size();
            std::array<Column<double>, 5> fixed;  // anchors of a and b, angles that count as 0
            for (Column<double>& column : fixed) {
                column.resize(places);
                for (double& number : column) number = draw(-0.4, 0.4);
            }
            Column<double> inertia, longest;
            inertia.resize(crowd.rows.size()), longest.resize(crowd.bundles.size());
            for (double& number : inertia) number = draw(0.0005, 0.003);
            BeginBundles<Real> k{};
            k.hinges = crowd.hinges.joints(true), k.angles = crowd.angles.joints(true);
            k.bundles = crowd.bundles.data(), k.rows = crowd.rows.data();
            k.position_x = crowd.position_x.data(), k.position_y = crowd.position_y.data();
            k.angle = crowd.angle.data(), k.inertia = inertia.data();
            k.anchor_a_x = fixed[0].data(), k.anchor_a_y = fixed[1].data();
            k.anchor_b_x = fixed[2].data(), k.anchor_b_y = fixed[3].data();
            k.angle_at_zero = fixed[4].data(), k.least_inertia = kLeast, k.longest = longest.data();
            tables->of<Real>().begin_bundles(k, 0, crowd.bundles.size());
            std::size_t stiff = 0;
            for (std::size_t n = 0; n < crowd.bundles.size(); ++n) {
                const JointBundle& bundle = crowd.bundles[n];
                double most = 0;
                for (std::size_t lane = 0; lane < bundle.mechanisms; ++lane) {
                    std::array<double, kBodies> moment{};
                    const auto row_of = [&](std::int32_t body) {
                        return static_cast<std::size_t>(
                            crowd.rows[(bundle.first_body + static_cast<std::size_t>(body)) * kJointBlock +
                                       lane]);
                    };
                    const auto place_of = [&](std::int32_t body) {
                        const std::size_t row = row_of(body);
                        return Vec2{crowd.position_x[row], crowd.position_y[row]};
                    };
                    const auto turn_of = [&](std::int32_t body) {
                        return static_cast<double>(crowd.angle[row_of(body)]);
                    };
                    for (std::size_t j = 0; j < kJoints; ++j) {
                        const std::size_t at = bundle.first_hinge + kJointBlock * j + lane;
                        const auto [a, b] = kJoined[j];
                        const Vec2 apart = place_of(b) - place_of(a),
                                   arm_a = rotate(rotation_by(turn_of(a)), {fixed[0][at], fixed[1][at]}),
                                   arm_b = rotate(rotation_by(turn_of(b)), {fixed[2][at], fixed[3][at]}),
                                   pull{k.hinges.impulse_x[at], k.hinges.impulse_y[at]};
                        CHECK(k.hinges.start_x[at] == static_cast<Real>(apart.x));
                        CHECK(k.hinges.start_y[at] == static_cast<Real>(apart.y));
                        CHECK(k.hinges.start_arm_a_x[at] == static_cast<Real>(arm_a.x));
                        CHECK(k.hinges.start_arm_a_y[at] == static_cast<Real>(arm_a.y));
                        CHECK(k.hinges.start_arm_b_x[at] == static_cast<Real>(arm_b.x));
                        CHECK(k.hinges.start_arm_b_y[at] == static_cast<Real>(arm_b.y));
                        CHECK(k.angles.start_x[at] ==
                              static_cast<Real>(turn_of(b) - turn_of(a) - fixed[4][at]));
                        for (const double part : {arm_a.x, arm_a.y, arm_b.x, arm_b.y})
                            most = std::fmax(most, std::fabs(part));
                        moment[static_cast<std::size_t>(a)] -= dot(arm_a, pull);
                        moment[static_cast<std::size_t>(b)] += dot(arm_b, pull);
                    }
                    const auto seen = [&](std::int32_t body) {
                        const auto number = static_cast<std::size_t>(body);
                        const double own = inertia[(bundle.first_body + number) * kJointBlock + lane],
                                     least = kLeast * moment[number];
                        stiff += least > own;
                        return static_cast<Real>(least > own ? own / least : 1);
                    };
                    for (std::size_t j = 0; j < kJoints; ++j) {
                        const std::size_t at = bundle.first_hinge + kJointBlock * j + lane;
                        for (const JointColumns<Real>* joints : {&k.hinges, &k.angles}) {
                            CHECK(joints->seen_a[at] == seen(kJoined[j][0]));
                            CHECK(joints->seen_b[at] == seen(kJoined[j][1]));
                        }
                    }
                }
                CHECK(longest[n] == most);
            }
            CHECK(stiff > 0);  // of bodies that joints turn back harder than their inertia
        }
    }
}

}  // namespace test_joint_bundles
