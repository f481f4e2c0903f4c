// Impacts at one instant against the exact solution of their complementarity problem, and closed forms.
#include "solvers/impulse/impacts/simultaneous_impacts.hpp"

#include "support/complementarity.hpp"
#include "unit/solvers/impulse/flights_bench.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace test_simultaneous_impacts {

using namespace carom;
using namespace carom::test;

namespace {

/// Discs at random places that near each other, and meetings of those that approach; the normals are all that
/// counts, not whether they touch.
template <class Real>
struct Meetings : FlightsBench<Real> {
    using Disc = typename FlightsBench<Real>::Disc;
    std::vector<Meeting> meetings;

    Meetings(std::size_t count, std::size_t most, unsigned seed)
        : FlightsBench<Real>(draw_discs(count, seed)) {
        std::mt19937 random(seed);
        for (int tries = 0; tries < 1000 && meetings.size() < most; ++tries) {
            const auto a = static_cast<std::int32_t>(random() % count);
            const auto b = random() % 8 == 0 ? kBottom : static_cast<std::int32_t>(random() % count);
            const Meeting m{a, b};
            if (b >= a || std::find(meetings.begin(), meetings.end(), m) != meetings.end()) continue;
            if (this->inverse_mass(a) + (b < 0 ? 0 : this->inverse_mass(b)) == 0) continue;
            if (this->normal_velocity(m) < -1e-3) meetings.push_back(m);
        }
    }

    static std::vector<Disc> draw_discs(std::size_t count, unsigned seed) {
        std::mt19937 random(seed);
        const auto draw = [&](double low, double high) {
            return low + (high - low) * static_cast<double>(random() % 10001) * 1e-4;
        };
        std::vector<Disc> drawn;
        for (std::size_t i = 0; i < count; ++i) {
            const Vec2 x{draw(-3, 3), draw(0, 6)}, to_middle = Vec2{0, 3} - x;
            drawn.push_back({x, 0.3 * to_middle + Vec2{draw(-1, 1), draw(-1, 1)}, draw(0.5, 4), draw(0.25, 1),
                             i % 6 == 5});
        }
        return drawn;
    }
};

}  // namespace

TEST_SUITE("solvers/impulse/simultaneous_impacts") {
    TEST_CASE_TEMPLATE("impulses solve all impacts at once, and momentum and work are in the books", Real,
                       float, double) {
        constexpr double kRounding = 100 * std::numeric_limits<Real>::epsilon();
        SimultaneousImpacts<Real> together;  // one for all: it must forget
        std::vector<std::int32_t> places(7, -1);
        together.begin(places);
        std::size_t pushing = 0, idle = 0;
        for (unsigned seed = 1; seed <= 30; ++seed)
            for (const double restitution : {0.0, 0.6, 1.0}) {
                CAPTURE(seed);
                CAPTURE(restitution);
                Meetings<Real> bench(7, 1 + seed % 9, seed);
                const std::vector<Meeting>& meetings = bench.meetings;
                Complementarity problem(meetings.size());
                std::vector<double> before;
                for (std::size_t i = 0; i < meetings.size(); ++i) {
                    before.push_back(bench.normal_velocity(meetings[i]));
                    problem.b(i) = (1 + restitution) * before[i];
                    for (std::size_t j = 0; j < meetings.size(); ++j)
                        problem.a(i, j) = bench.coupling(meetings[i], meetings[j]);
                }
                const std::vector<long double> exact = problem.solve();
                REQUIRE(exact.size() == meetings.size());
                const Vec2 momentum_before = bench.momentum();
                const double energy_before = bench.energy();

                together.clear();
                for (std::size_t i = 0; i < meetings.size(); ++i)
                    together.add(bench.flights, meetings[i], bench.flights.encounter(meetings[i], 0), 0,
                                 -restitution * before[i]);
                together.carry_out(bench.flights);

                double worst = 0, work = 0;
                for (std::size_t i = 0; i < meetings.size(); ++i) {
                    double expected = before[i];
                    for (std::size_t j = 0; j < meetings.size(); ++j)
                        expected += static_cast<double>(exact[j]) * bench.coupling(meetings[j], meetings[i]);
                    worst = std::fmax(worst, std::fabs(bench.normal_velocity(meetings[i]) - expected));
                    work += 0.5 * static_cast<double>(exact[i]) * (before[i] + expected);
                    CHECK(together.impacts()[i].impulse >= 0);
                    CHECK(std::fabs(together.impacts()[i].normal_velocity_after - expected) < 1e-10);
                    pushing += exact[i] > 0, idle += exact[i] == 0;
                }
                CHECK(worst < kRounding);
                const Vec2 from_outside = bench.books.wall_momentum + bench.books.immovable_momentum;
                const Vec2 unexplained = bench.momentum() - momentum_before - from_outside;
                CHECK(std::fabs(unexplained.x) + std::fabs(unexplained.y) < 10 * kRounding);
                if (bench.books.drive == 0)  // else an immovable disc moves here
                    CHECK(std::fabs(bench.energy() - energy_before - work) < 10 * kRounding);
                CHECK(bench.books.restitution == doctest::Approx(work).epsilon(1e-9).scale(1));
                if (restitution == 1) CHECK(std::fabs(work) < 1e-9);
            }
        CHECK(pushing > 100);
        CHECK(idle > 10);  // some part because of the others
    }

    TEST_CASE_TEMPLATE("a ball that breaks a pair comes back with a fifth of its speed", Real, float,
                       double) {
        const double half = 0.5, side = std::sqrt(0.75);
        FlightsBench<Real> bench({{{0, 10}, {2, 0}}, {{side, 10 + half}, {}}, {{side, 10 - half}, {}}});
        SimultaneousImpacts<Real> together;
        std::vector<std::int32_t> places(bench.discs.size(), -1);
        together.begin(places);
        for (const std::int32_t struck : {1, 2}) {
            const Meeting m{0, struck};
            together.add(bench.flights, m, bench.flights.encounter(m, 0), 0, 2 * side);
        }
        together.carry_out(bench.flights);
        const double allowed = 10 * std::numeric_limits<Real>::epsilon();
        CHECK(std::fabs(bench.flights.flight(0).velocity.x + 2.0 / 5) < allowed);
        CHECK(std::fabs(bench.flights.flight(0).velocity.y) < allowed);
        const double speed = 2 * 2 * std::sqrt(3.0) / 5;
        for (const std::int32_t struck : {1, 2}) {
            const Vec2 v = bench.flights.flight(struck).velocity;
            CHECK(std::fabs(v.x - side * speed) < allowed);
            CHECK(std::fabs(v.y - (struck == 1 ? half : -half) * speed) < allowed);
        }
    }

    TEST_CASE_TEMPLATE("bodies fly on from where the impact was, late in the substep as well", Real, float,
                       double) {
        const double s = 0.01;
        FlightsBench<Real> bench({{{0, 10}, {3, 1}, 1}, {{1 + 4 * s, 10}, {-1, 1}, 3}});
        SimultaneousImpacts<Real> together;
        std::vector<std::int32_t> places(bench.discs.size(), -1);
        together.begin(places);
        const Meeting m{0, 1};
        together.add(bench.flights, m, bench.flights.encounter(m, s), s, 4);
        together.carry_out(bench.flights);
        // Elastic, masses 1 and 3, speeds 3 and -1 along x: they leave with -3 and 1.
        const double allowed = 50 * std::numeric_limits<Real>::epsilon();
        for (const double later : {0.0, 0.005}) {
            const Vec2 a = position_at(bench.flights.flight(0), s + later, 0),
                       b = position_at(bench.flights.flight(1), s + later, 0);
            CHECK(std::fabs(a.x - (3 * s - 3 * later)) < allowed);
            CHECK(std::fabs(b.x - (1 + 3 * s + later)) < allowed);
            CHECK(std::fabs(a.y - (10 + s + later)) < allowed);
        }
    }
}

}  // namespace test_simultaneous_impacts
