// The solve to convergence of contacts between very different masses, against the laws of all contacts.
#include "solvers/contact_sets/local_solve.hpp"

#include "unit/solvers/contact_sets/contact_rows_bench.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace test_local_solve {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kFall = 0.04;  // m/s, what gravity adds in a substep

/// Solved means: the last sweep changed the impulse of no contact by more than its mass times a thousandth of
/// the fall. Each is then off by what its neighbours, up to five, have changed after it; an impulse along the
/// tangent changes the velocity there by 3 / m.
constexpr double kSolved = 30e-3 * kFall;

template <class Real>
using Touch = typename ContactRowsBench<Real>::Touch;

Vector unit(double angle) {  // from the vertical, downwards
    return {static_cast<float>(std::sin(angle)), static_cast<float>(-std::cos(angle))};
}

/// Discs that all fall, as at the start of a substep.
std::vector<RigidDisc> falling(const std::vector<double>& masses) {
    std::vector<RigidDisc> discs;
    for (const double mass : masses) {
        discs.push_back(RigidDisc::of_mass(mass, 0.5));
        discs.back().velocity = {0, -kFall};
    }
    return discs;
}

template <class Real>
void solve(ContactRowsBench<Real>& bench, LocalSolve<Real>& local) {
    local.find(bench.pairs, bench.inverse_mass, bench.discs.size());
    local.begin_step(bench.pairs, bench.supports);
    local.begin(bench.arguments(bench.pairs), bench.arguments(bench.supports), kFall);
    local.solve(bench.arguments(bench.pairs), bench.arguments(bench.supports), kFall);
}

template <class Real>
double violation(const ContactRowsBench<Real>& bench) {
    long double worst = 0;
    for (const DiscContact& c : bench.contacts) worst = std::max(worst, c.violation());
    return static_cast<double>(worst);
}

/// @param bench  before the solve
/// @param calls  until it is: each looks at 8,192 contacts at most, and the next one goes on from there
template <class Real>
void check_solved(ContactRowsBench<Real>& bench, int calls) {
    const Vector before = bench.momentum();
    CHECK(violation(bench) > 0.5 * kFall);
    LocalSolve<Real> local;
    for (int call = 0; call < calls; ++call) solve(bench, local);
    bench.read_back();
    CHECK(violation(bench) < kSolved);
    Vector from_plane, after = bench.momentum();
    long double heaviest = 0;
    for (std::size_t i = bench.pair_count; i < bench.contacts.size(); ++i) {
        const DiscContact& c = bench.contacts[i];
        from_plane = from_plane - (c.along * c.normal + c.tangent * turned(c.normal));
    }
    for (const RigidDisc& d : bench.discs) heaviest = std::max(heaviest, 1 / d.inverse_mass);
    const long double allowed = 20 * std::numeric_limits<Real>::epsilon() * heaviest;
    CHECK(std::fabs(after.x - before.x - from_plane.x) < allowed);
    CHECK(std::fabs(after.y - before.y - from_plane.y) < allowed);
}

}  // namespace

TEST_SUITE("solvers/contact_sets/local_solve") {
    TEST_CASE_TEMPLATE("a light disc under a heavy one carries its weight", Real, float, double) {
        for (const double ratio : {11.0, 1e3, 1e6}) {
            CAPTURE(ratio);
            const std::vector<Touch<Real>> touches{{0, -1, unit(0)}, {1, 0, unit(0)}};
            ContactRowsBench<Real> bench(falling({1, ratio}), touches);
            check_solved(bench, ratio > 1e5 ? 10 : 1);
            CHECK(static_cast<double>(bench.along(0)) == doctest::Approx(ratio * kFall).epsilon(2e-3));
            CHECK(static_cast<double>(bench.along(1)) == doctest::Approx((1 + ratio) * kFall).epsilon(2e-3));
        }
    }

    TEST_CASE_TEMPLATE("a heavy disc on many light ones, and those beside and below these, are all solved",
                       Real, float, double) {
        for (const double friction : {0.0, 0.25})
            for (unsigned seed = 1; seed <= (friction > 0 ? 7u : 8u); ++seed) {
                CAPTURE(friction);
                CAPTURE(seed);
                std::mt19937 random(seed);
                const auto draw = [&](double low, double high) {
                    return low + (high - low) * static_cast<double>(random() % 10001) * 1e-4;
                };
                std::vector<double> masses{std::exp2(4 + 2 * static_cast<double>(seed))};
                for (int i = 0; i < 9; ++i) masses.push_back(draw(0.7, 1.4));
                std::vector<Touch<Real>> touches;
                const auto add = [&](std::int32_t a, std::int32_t b, double angle) {
                    touches.push_back({a, b, unit(angle), friction, -0.1 * kFall * draw(0, 1)});
                };
                // Three bear the heavy one, each stands on two of the others, which stand on the floor.
                for (const std::int32_t light : {1, 2, 3}) add(0, light, draw(-0.5, 0.5));
                for (const std::int32_t light : {1, 2, 3}) {
                    add(light, 3 + light, draw(-0.6, -0.2)), add(light, 6 + light, draw(0.2, 0.6));
                    add(3 + light, -1, 0), add(6 + light, -1, 0);
                }
                add(4, 8, 1.5), add(5, 9, -1.5);
                ContactRowsBench<Real> bench(falling(masses), touches);
                check_solved(bench, friction > 0 ? 40 : 1);
            }
    }

    TEST_CASE_TEMPLATE("masses that differ by no more than ten are left to the sweeps", Real, float, double) {
        const std::vector<Touch<Real>> touches{{0, -1, unit(0)}, {1, 0, unit(0)}};
        ContactRowsBench<Real> bench(falling({1, 9.5}), touches);
        const Column<Real> before = bench.velocity;
        LocalSolve<Real> local;
        solve(bench, local);
        CHECK(std::equal(before.begin(), before.end(), bench.velocity.begin()));
        CHECK(bench.along(0) == 0);
    }

    TEST_CASE_TEMPLATE(
        "pairs that cannot touch in this step, and bodies far from any heavy one, stay as they are", Real,
        float, double) {
        // Discs 4 and 5 are on each other and on nothing else; pairs of another block are not live.
        const std::vector<Touch<Real>> touches{
            {0, -1, unit(0)}, {1, 0, unit(0)}, {4, -1, unit(0)}, {5, 4, unit(0)}};
        ContactRowsBench<Real> bench(falling({1, 100, 1, 1, 1, 1}), touches);
        const Column<Real> before = bench.velocity;
        LocalSolve<Real> local;
        solve(bench, local);
        CHECK(std::equal(before.begin() + 8, before.end(), bench.velocity.begin() + 8));
        CHECK(bench.velocity[1] != before[1]);

        ContactRowsBench<Real> apart(falling({1, 100}), {{0, -1, unit(0)}, {1, 0, unit(0)}});
        std::fill(apart.pairs.is_live.begin(), apart.pairs.is_live.end(), std::uint8_t{0});
        const Column<Real> falling_on = apart.velocity;
        solve(apart, local);
        CHECK(std::equal(falling_on.begin(), falling_on.end(), apart.velocity.begin()));
    }

    TEST_CASE_TEMPLATE("grains in the gaps of balls are solved one by one, without sweeps", Real, float,
                       double) {
        constexpr double kRest = 1e6;  // kg, of balls that lie still
        for (const double friction : {0.0, 0.3})
            for (const double ratio : {1e3, 1e6}) {
                CAPTURE(friction);
                CAPTURE(ratio);
                std::vector<RigidDisc> discs;
                std::vector<Touch<Real>> touches;
                const double gaps[] = {0.5, 0.3, 0.2, 0.15};  // rad, between a surface and the vertical
                for (std::int32_t gap = 0; gap < 4; ++gap) {
                    discs.push_back(RigidDisc::of_mass(kRest / ratio, 0.01));
                    discs.back().velocity = {0, -kFall};
                    for (int side = 0; side < 2; ++side) discs.push_back(RigidDisc::of_mass(kRest, 0.5));
                    const double angle = std::numbers::pi / 2 - gaps[gap];
                    touches.push_back({3 * gap, 3 * gap + 1, unit(-angle), friction});
                    touches.push_back({3 * gap, 3 * gap + 2, unit(angle), friction});
                }
                ContactRowsBench<Real> bench(discs, touches);
                const Vector before = bench.momentum();
                LocalSolve<Real> local;
                local.find(bench.pairs, bench.inverse_mass, bench.discs.size());
                local.begin_step(bench.pairs, bench.supports);
                CHECK(local.begin(bench.arguments(bench.pairs), bench.arguments(bench.supports), kFall) == 0);
                local.solve(bench.arguments(bench.pairs), bench.arguments(bench.supports), kFall);
                bench.read_back();
                // Off by .05 each; a tangential impulse counts three times, as above.
                CHECK(violation(bench) < 0.15 * kFall);
                const Vector after = bench.momentum();
                CHECK(std::fabs(after.y - before.y) < 20 * std::numeric_limits<Real>::epsilon() * kRest);
                for (std::int32_t gap = 0; gap < 4; ++gap) {
                    CAPTURE(gaps[gap]);
                    const auto at = static_cast<std::size_t>(gap);
                    const double weight = kRest / ratio * kFall;
                    const double held =
                        2 * std::sin(gaps[at]) * static_cast<double>(bench.along(2 * at)) +
                        (friction > 0
                             ? 2 * std::cos(gaps[at]) * std::fabs(static_cast<double>(bench.tangent(2 * at)))
                             : 0);
                    CHECK(held == doctest::Approx(weight).epsilon(0.1));
                }
            }
    }

    TEST_CASE_TEMPLATE("grains that balls close on faster than gravity moves them are left to sweeps", Real,
                       float, double) {
        // The first is solved. In the narrow gap the grain would be shot out at nine times the speed at which
        // the balls close; in the wide one it would not, but is struck.
        struct Case {
            double closing, gap;  // falls, rad
            std::size_t left;
        };
        for (const Case& of : {Case{0.5, 0.4, 0}, {1, 0.1, 2}, {30, 0.8, 2}}) {
            CAPTURE(of.closing);
            CAPTURE(of.gap);
            std::vector<RigidDisc> discs{RigidDisc::of_mass(1, 0.01), RigidDisc::of_mass(1e3, 0.5),
                                         RigidDisc::of_mass(1e3, 0.5)};
            discs[1].velocity = {of.closing * kFall, 0}, discs[2].velocity = {-of.closing * kFall, 0};
            const double angle = std::numbers::pi / 2 - of.gap;
            ContactRowsBench<Real> bench(discs, {{0, 1, unit(-angle), 0.0}, {0, 2, unit(angle), 0.0}});
            LocalSolve<Real> local;
            local.find(bench.pairs, bench.inverse_mass, bench.discs.size());
            local.begin_step(bench.pairs, bench.supports);
            const std::size_t left =
                local.begin(bench.arguments(bench.pairs), bench.arguments(bench.supports), kFall);
            CHECK(left == of.left);
        }
    }

    TEST_CASE_TEMPLATE("what is solved already stays as it is", Real, float, double) {
        std::vector<RigidDisc> discs = falling({1, 100});
        for (RigidDisc& d : discs) d.velocity = {};
        ContactRowsBench<Real> bench(
            discs, {{0, -1, unit(0), 0.5, 0, 101 * kFall}, {1, 0, unit(0), 0.5, 0, 100 * kFall}});
        LocalSolve<Real> local;
        solve(bench, local);
        CHECK(bench.along(1) == static_cast<Real>(101 * kFall));
        CHECK(bench.along(0) == static_cast<Real>(100 * kFall));
        for (std::size_t row = 0; row < 2; ++row) CHECK(bench.velocity[4 * row + 1] == 0);
    }
}

}  // namespace test_local_solve
