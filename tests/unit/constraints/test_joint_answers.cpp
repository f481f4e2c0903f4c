#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "constraints/joints/free_rows.hpp"
#include "constraints/joints/joint_system.hpp"

namespace test_joint_answers {

using namespace carom;

namespace {

void add_link(JointSystem& system, Vec2 at, int number) {
    SystemBody body;
    body.pose = {at, {1, 0}, 0};
    body.inverse_mass = 1 + 0.1 * number;
    body.inverse_inertia = body.seen_inverse_inertia = 12 * body.inverse_mass;
    system.bodies.push_back(body);
}

void add_hinge(JointSystem& system, StoredJoint& joint, int a, int b, Vec2 at) {
    joint.type = JointType::revolute;
    joint.anchor_a = at - system.bodies[static_cast<std::size_t>(a)].pose.position;
    joint.anchor_b = at - system.bodies[static_cast<std::size_t>(b)].pose.position;
    JointSystem::Member member;
    member.joint = &joint, member.a = a, member.b = b;
    system.joints.push_back(member);
}

/// Plans the system, and prepares a substep of 1/240 s.
void prepare(JointSystem& system) {
    system.plan();
    system.set_substep(1.0 / 240);
    system.begin_step();
    system.prepare(JointSystem::Part::whole);
}

/// Rows of a random matrix that is positive definite.
struct Matrix {
    std::size_t count;
    std::vector<double> entries;

    explicit Matrix(std::size_t rows_and_columns) : count(rows_and_columns), entries(count * count, 0) {
        std::mt19937 random(static_cast<unsigned>(count));
        std::vector<double> rows(count * count);
        for (double& entry : rows) entry = static_cast<double>(random()) / 4294967296.0 - 0.5;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t k = 0; k < count; ++k) {
                for (std::size_t n = 0; n < count; ++n)
                    entries[i * count + k] += rows[i * count + n] * rows[k * count + n];
                entries[i * count + k] += i == k ? 0.2 : 0;
            }
    }
};

/// A ring of links that are hinged to each other, all of them free, which begin with no velocity.
struct Ring {
    std::vector<StoredJoint> stored;
    JointSystem system;

    /// @param more  links across it
    Ring(int links, int more) {
        constexpr double kRadius = 1;  // m
        const auto corner = [&](double i) {
            const double angle = 6.28318530717958647693 * i / links;
            return Vec2{kRadius * std::cos(angle), kRadius * std::sin(angle)};
        };
        system.bodies.emplace_back();
        for (int i = 0; i < links; ++i) {
            add_link(system, 0.5 * (corner(i) + corner(i + 1)), i);
        }
        stored.resize(static_cast<std::size_t>(links + more));
        for (int j = 0; j < links + more; ++j) {
            const int a = 1 + (j < links ? j : j - links),
                      b = 1 + (j < links ? (j + 1) % links : (j - links + links / 2) % links);
            const Vec2 at = corner(j < links ? j + 1 : j - links + 0.5);
            StoredJoint& joint = stored[static_cast<std::size_t>(j)];
            add_hinge(system, joint, a, b, at);
        }
        prepare(system);
    }
};

/// Links in a row, hinged to each other and to the world at both ends, as far apart as the chain is long; a
/// motor turns the second one.
struct TautChain {
    std::vector<StoredJoint> stored;
    JointSystem system;

    explicit TautChain(int links) {
        system.bodies.emplace_back();
        for (int i = 0; i < links; ++i) {
            add_link(system, Vec2{i + 0.5, 0}, i);
        }
        stored.resize(static_cast<std::size_t>(links + 1));
        for (int j = 0; j <= links; ++j) {
            const int a = j, b = j < links ? j + 1 : 0;
            const Vec2 at{static_cast<double>(j), 0};
            StoredJoint& joint = stored[static_cast<std::size_t>(j)];
            add_hinge(system, joint, a, b, at);
            joint.has_motor = j == 1, joint.motor_speed = 3, joint.max_motor = 5;
        }
        prepare(system);
    }
    /// Solves the chain for links that are as fast as this across it, a blow that grows along it [m/s].
    void solve(double blow) {
        for (std::size_t i = 1; i < system.bodies.size(); ++i)
            system.bodies[i].velocity = {0, blow * static_cast<double>(i)}, system.bodies[i].spin = 0;
        system.solve_curved(2);
    }
};

}  // namespace

TEST_SUITE("unit: joint answers") {
    TEST_CASE("a system that forgets what it gave solves other velocities as if it had solved none before") {
        TautChain once(4), twice(4);
        once.solve(0.5);
        twice.solve(40);
        REQUIRE(twice.system.held() > 2 * once.system.held());
        twice.system.forget_impulses();
        twice.solve(0.5);
        CHECK(twice.system.held() == once.system.held());
        for (std::size_t i = 1; i < once.system.bodies.size(); ++i) {
            const SystemBody &expected = once.system.bodies[i], &found = twice.system.bodies[i];
            CHECK(found.velocity.x == expected.velocity.x);
            CHECK(found.velocity.y == expected.velocity.y);
            CHECK(found.spin == expected.spin);
        }
        for (std::size_t j = 0; j < once.system.joints.size(); ++j)
            for (std::size_t k = 0; k < 3; ++k)
                CHECK(twice.system.joints[j].impulse[k] == once.system.joints[j].impulse[k]);
    }

    TEST_CASE("free rows are solved one by one and side by side") {
        for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{48}}) {
            const Matrix matrix(count);
            const std::vector<double> alone(count, 1);
            std::vector<std::size_t> rows;
            for (std::size_t i = 0; i<count; i += count> 4 && i % 3 == 1 ? 2 : 1) rows.push_back(i);
            FreeRows free;
            free.factor(matrix.entries, count, rows, alone, 0);
            CHECK(free.are_independent());
            constexpr std::size_t kSides = 5;
            std::vector<double> sides(rows.size() * kSides);
            for (std::size_t i = 0; i < sides.size(); ++i) sides[i] = std::sin(1.0 + static_cast<double>(i));
            const std::vector<double> asked = sides;
            free.solve(sides, kSides);
            for (std::size_t s = 0; s < kSides; ++s) {
                std::vector<double> one(rows.size());
                for (std::size_t i = 0; i < rows.size(); ++i) one[i] = asked[i * kSides + s];
                free.solve(one, 1);
                for (std::size_t i = 0; i < rows.size(); ++i) {
                    CHECK(sides[i * kSides + s] == one[i]);
                    double product = 0;
                    for (std::size_t k = 0; k < rows.size(); ++k)
                        product += matrix.entries[rows[i] * count + rows[k]] * one[k];
                    CHECK(product == doctest::Approx(asked[i * kSides + s]).epsilon(1e-9));
                }
            }
        }
    }

    TEST_CASE("free rows of which two say the same are not independent") {
        std::vector<double> matrix{1, 1, 1, 1};
        FreeRows free;
        const std::vector<std::size_t> rows{0, 1};
        const std::vector<double> alone{1, 1};
        free.factor(matrix, 2, rows, alone, 1e-9);
        CHECK_FALSE(free.are_independent());
        matrix[3] = 2;
        free.factor(matrix, 2, rows, alone, 1e-9);
        CHECK(free.are_independent());
    }

    TEST_CASE("rows that begin as those before keep what is known of them, and have the same factors") {
        constexpr std::size_t kCount = 24;
        const Matrix matrix(kCount);
        const std::vector<double> alone(kCount, 1);
        std::vector<std::size_t> rows;
        for (std::size_t i = 0; i < kCount; ++i) rows.push_back(i);
        FreeRows kept;
        kept.factor(matrix.entries, kCount, rows, alone, 1e-9);
        // Rows go and come back, as those of motors and limits do; the first and all of them, too.
        for (const std::vector<std::size_t>& without : std::vector<std::vector<std::size_t>>{
                 {20}, {20, 23}, {23}, {}, {17}, {0}, {}, {3, 4, 5, 11}, {22}}) {
            rows.clear();
            for (std::size_t i = 0; i < kCount; ++i)
                if (!std::ranges::count(without, i)) rows.push_back(i);
            FreeRows anew;
            anew.factor(matrix.entries, kCount, rows, alone, 1e-9);
            kept.factor(matrix.entries, kCount, rows, alone, 1e-9, true);
            CHECK(kept.are_independent() == anew.are_independent());
            for (const std::size_t sides : {std::size_t{1}, std::size_t{3}}) {
                std::vector<double> x(rows.size() * sides);
                for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(1.0 + static_cast<double>(i));
                std::vector<double> y = x;
                kept.solve(x, sides), anew.solve(y, sides);
                CHECK(x == y);  // every bit
            }
        }
    }

    // Chains across a ring close further loops; two hinges between the same links say what the others say.
    TEST_CASE("unit impulses that are answered at once are answered as each of them alone") {
        for (const int more : {0, 1, 3}) {
            CAPTURE(more);
            Ring ring(12, more);
            const std::vector<std::size_t> asked{3, 7, 12};
            ring.system.find_answers(asked, JointSystem::Drives::no_motors);
            std::vector<JointSystem::Vector> at_once;
            for (std::size_t side = 0; side < 3 * asked.size(); ++side)
                for (const std::size_t body : asked) at_once.push_back(ring.system.answer_to(side, body));
            std::size_t next = 0;
            for (std::size_t side = 0; side < 3 * asked.size(); ++side) {
                JointSystem::Blow blow{asked[side / 3], {}};
                blow.impulse[side % 3] = 1;
                ring.system.answer({&blow, 1}, JointSystem::Drives::no_motors);
                for (const std::size_t body : asked) {
                    const JointSystem::Vector &one = ring.system.answer_of(body), &other = at_once[next++];
                    for (std::size_t c = 0; c < 3; ++c) CHECK(std::fabs(one[c] - other[c]) < 1e-9);
                }
            }
        }
    }

    // What a push on one body does to another is what one on that does to this.
    TEST_CASE("answers of a ring are symmetric, and an impulse moves it as a whole") {
        Ring ring(12, 0);
        std::vector<std::size_t> all;
        for (std::size_t body = 1; body <= 12; ++body) all.push_back(body);
        ring.system.find_answers(all, JointSystem::Drives::no_motors);
        for (std::size_t side = 0; side < 36; ++side) {
            double momentum = 0;
            for (std::size_t other = 0; other < 36; ++other) {
                const double there = ring.system.answer_to(side, all[other / 3])[other % 3],
                             here = ring.system.answer_to(other, all[side / 3])[side % 3];
                CHECK(std::fabs(there - here) < 1e-9);
                if (other % 3 == 0) momentum += there / ring.system.bodies[all[other / 3]].inverse_mass;
            }
            CHECK(std::fabs(momentum - (side % 3 == 0 ? 1 : 0)) < 1e-9);
        }
    }
}

}  // namespace test_joint_answers
