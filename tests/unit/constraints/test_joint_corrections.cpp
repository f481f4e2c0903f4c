#include "constraints/joints/joint_system.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "constraints/coupled_impulses.hpp"

namespace test_joint_corrections {

using namespace carom;

namespace {

constexpr double kSubstep = 1.0 / 240;

SystemBody body_at(Vec2 position, double mass) {
    SystemBody body;
    body.pose = {position, {1, 0}, 0};
    body.inverse_mass = 1 / mass, body.inverse_inertia = body.seen_inverse_inertia = 12 / mass;
    return body;
}

struct Ends {
    std::int32_t a, b;  // 0: the world
    Vec2 anchor_a{}, anchor_b{};
};

/// Bodies that are welded together, or hinged.
struct System {
    std::vector<StoredJoint> stored;
    JointSystem system;

    System(const std::vector<SystemBody>& bodies, const std::vector<Ends>& joints,
           JointType type = JointType::weld)
        : stored(joints.size()) {
        system.bodies.emplace_back();
        system.bodies.insert(system.bodies.end(), bodies.begin(), bodies.end());
        for (std::size_t j = 0; j < joints.size(); ++j) {
            stored[j].type = type;
            stored[j].anchor_a = joints[j].anchor_a, stored[j].anchor_b = joints[j].anchor_b;
            JointSystem::Member member;
            member.joint = &stored[j], member.a = joints[j].a, member.b = joints[j].b;
            system.joints.push_back(member);
        }
        system.plan();
        system.set_substep(kSubstep);
        system.begin_step();
        system.prepare(JointSystem::Part::whole);
    }
    /// @param along  what a unit push gives the body; the other one gets the opposite
    void press(std::int32_t body, const JointSystem::Vector& along, double inverse_mass, double separation) {
        JointSystem::Load load;
        load.body = body, load.other = 7, load.along = along;
        load.other_along = {-along[0], -along[1], 0}, load.inverse_mass = inverse_mass;
        load.separation = separation;
        system.loads.push_back(load);
    }
    double sum_of_errors() const {
        double sum = 0;
        for (std::size_t j = 0; j < stored.size(); ++j) {
            const auto end = [&](std::int32_t number, Vec2 anchor) {
                const JointPose& pose = system.bodies[static_cast<std::size_t>(number)].pose;
                return number == 0 ? anchor : pose.position + rotate(rotation_by(pose.angle), anchor);
            };
            sum += length_squared(end(system.joints[j].b, stored[j].anchor_b) -
                                  end(system.joints[j].a, stored[j].anchor_a));
        }
        return sum;
    }
};

/// Bodies hinged in a row between two points of the world.
/// @param bend  m, by which every other body is beside the line
/// @param excess  m, by which the points are farther apart than the row is long
System row_of(int count, double bend, double excess) {
    std::vector<SystemBody> bodies;
    std::vector<Ends> joints;
    for (int i = 0; i < count; ++i) {
        bodies.push_back(body_at({i + 0.5, i % 2 * bend}, 1));
        joints.push_back({i, i + 1, i == 0 ? Vec2{} : Vec2{0.5, 0}, {-0.5, 0}});
    }
    joints.push_back({0, count, {count + excess, 0}, {0.5, 0}});
    return System(bodies, joints, JointType::revolute);
}

}  // namespace

TEST_SUITE("joint corrections") {
    TEST_CASE("a load is displaced with what it lies on") {
        System of_weld({body_at({0, -0.01}, 2)}, {{0, 1}});
        of_weld.press(1, {0, -1, 0}, 1e-3, 0);
        REQUIRE(of_weld.system.correct_positions(1e-9, 1));
        const double rise = of_weld.system.bodies[1].pose.position.y + 0.01;
        CHECK(rise > 5e-4);
        CHECK(std::fabs(1e-3 * of_weld.system.loads[0].push - rise) < 1e-12);
    }

    TEST_CASE("a body is not displaced into what nothing moves, but up to it") {
        for (const double gap : {0.0, 2e-4, 1.0}) {
            // Two bodies that are to be in one place, the second above the first, and a floor below the
            // second.
            System of_weld({body_at({0, -0.01}, 1), body_at({0, 0}, 1)}, {{1, 2}});
            of_weld.press(2, {0, 1, 0}, 0, gap);
            REQUIRE(of_weld.system.correct_positions(1e-9, 1));
            const double rise = of_weld.system.bodies[1].pose.position.y + 0.01,
                         fall = -of_weld.system.bodies[2].pose.position.y;
            CHECK(std::fabs(rise + fall - 1e-3) < 1e-12);  // a tenth, as something presses
            CHECK(std::fabs(fall - std::fmin(0.1 * gap, 5e-4)) < 1e-12);
        }
    }

    // A row that is nearly straight has no displacements that its rows tell of truly: they made the errors of
    // these up to a hundred times as large.
    TEST_CASE("corrections make no errors larger") {
        for (const int bodies : {6, 12, 24})
            for (const double bend : {1e-3, 0.01, 0.05})
                for (const double excess : {-0.1, 0.02, 0.3}) {
                    CAPTURE(bodies);
                    CAPTURE(bend);
                    CAPTURE(excess);
                    System row = row_of(bodies, bend, excess);
                    for (int i = 0; i < 20; ++i) {
                        const double before = row.sum_of_errors();
                        row.system.prepare(JointSystem::Part::whole);
                        row.system.correct_positions(1e-9, 1);
                        CHECK(row.sum_of_errors() < 1.1 * before + 1e-9);
                    }
                }
    }

    // Sweeps alone would take M / m of them.
    TEST_CASE("a motor of a light plate carries a heavy load, up to the most that it has") {
        constexpr double kPlate = 1, kLoad = 1e4, kFall = 0.1;  // kg, kg, m/s
        for (const double most : {HUGE_VAL, 700.0}) {
            CoupledImpulses impulses;  // of the load on the plate, and of the motor on the plate
            impulses.reset(2);
            impulses.inverse_mass(0, 0) = 1 / kPlate + 1 / kLoad, impulses.inverse_mass(1, 1) = 1 / kPlate;
            impulses.inverse_mass(0, 1) = impulses.inverse_mass(1, 0) = -1 / kPlate;
            impulses.lack = {0, kFall};  // both fall
            const std::vector<CoupledImpulses::Ends> ends{{-most, most}};
            impulses.solve(
                ends, [](std::size_t, double wanted) { return std::fmax(wanted, 0); }, 1e-9);
            const double exact = std::fmin(most, kFall * (kPlate + kLoad));
            CHECK(impulses.given[1] == doctest::Approx(exact).epsilon(1e-6));
            CHECK(impulses.given[0] == doctest::Approx(exact * kLoad / (kPlate + kLoad)).epsilon(1e-6));
        }
    }

    // Each sweep went over all rows: 6,000 looks here.
    TEST_CASE("coupled impulses that do not press cost next to nothing") {
        constexpr std::size_t kCount = 60, kPressing = 6, kPushed = 40;
        CoupledImpulses impulses;
        impulses.reset(kCount);
        for (std::size_t i = 0; i < kCount; ++i) impulses.inverse_mass(i, i) = 1, impulses.lack[i] = -10;
        for (std::size_t i = 0; i < kPressing; ++i) {
            impulses.lack[i] = 1;
            if (i == 0) continue;
            impulses.inverse_mass(i, i - 1) = impulses.inverse_mass(i - 1, i) = -0.5;
        }
        // One that the others push into what it is near to.
        impulses.inverse_mass(kPushed, 3) = impulses.inverse_mass(3, kPushed) = -0.25;
        impulses.lack[kPushed] = -1;
        std::vector<double> lack = impulses.lack;
        std::size_t looks = 0;
        impulses.solve([&](std::size_t, double wanted) { return ++looks, std::fmax(wanted, 0); }, 1e-9);
        CHECK(looks < kCount * 20);
        CHECK(impulses.given[kPushed] > 0.1);
        for (std::size_t i = 0; i < kCount; ++i) {
            double left = lack[i];
            for (std::size_t k = 0; k < kCount; ++k) left -= impulses.inverse_mass(i, k) * impulses.given[k];
            CHECK(impulses.lack[i] == doctest::Approx(left).epsilon(1e-9));
            CHECK(left < 1e-4);
            if (impulses.given[i] > 0) CHECK(left > -1e-4);
        }
    }

    TEST_CASE("coupled impulses are within their bounds and lack nothing between them") {
        std::mt19937 random(5);
        const auto number = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
        for (int draw = 0; draw < 300; ++draw) {
            constexpr std::size_t kCount = 5;
            const std::size_t motors = static_cast<std::size_t>(draw) % 3, first = kCount - motors;
            const std::vector<CoupledImpulses::Ends> ends(motors, {-0.3, 0.3});
            CoupledImpulses impulses;
            impulses.reset(kCount);
            double rows[kCount][kCount], lack[kCount];
            for (auto& row : rows)
                for (double& entry : row) entry = number();
            for (std::size_t i = 0; i < kCount; ++i) {
                impulses.lack[i] = lack[i] = number();
                for (std::size_t k = 0; k < kCount; ++k) {
                    for (std::size_t n = 0; n < kCount; ++n)
                        impulses.inverse_mass(i, k) += rows[i][n] * rows[k][n];
                    impulses.inverse_mass(i, k) += i == k ? 0.2 : 0;
                }
            }
            impulses.solve(
                ends, [](std::size_t, double wanted) { return std::fmax(wanted, 0); }, 0);
            for (std::size_t i = 0; i < kCount; ++i) {
                double left = lack[i];
                for (std::size_t k = 0; k < kCount; ++k)
                    left -= impulses.inverse_mass(i, k) * impulses.given[k];
                const double low = i < first ? 0 : -0.3, high = i < first ? HUGE_VAL : 0.3;
                CHECK(impulses.given[i] >= low);
                CHECK(impulses.given[i] <= high);
                if (impulses.given[i] < high) CHECK(left < 1e-9);
                if (impulses.given[i] > low) CHECK(left > -1e-9);
            }
        }
    }
}

}  // namespace test_joint_corrections
