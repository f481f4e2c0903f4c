// Contact forces of bodies at rest against statics, and against the exact solution in accelerations.
#include "solvers/impulse/impacts/resting_contacts.hpp"

#include "support/complementarity.hpp"
#include "unit/solvers/impulse/flights_bench.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace test_resting_contacts {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kGravity = 10;

template <class Real>
double normal_acceleration(const FlightsBench<Real>& bench, Meeting m) {
    return bench.relative(m, [&](std::int32_t row) { return bench.flights.acceleration(row); });
}

}  // namespace

TEST_SUITE("solvers/impulse/resting_contacts") {
    TEST_CASE_TEMPLATE("each contact of a column carries the weight above it, from any first guess", Real,
                       float, double) {
        for (const double guess : {0.0, 1.0, 1e4})
            for (const std::size_t count : {1u, 2u, 9u}) {
                std::vector<typename FlightsBench<Real>::Disc> discs;
                std::vector<PressedMeeting> contacts;
                for (std::size_t i = 0; i < count; ++i) {
                    discs.push_back(
                        {{0, 0.5 + static_cast<double>(i)}, {}, 1 + static_cast<double>(i * i % 5)});
                    const auto row = static_cast<std::int32_t>(i);
                    contacts.push_back({{row, i == 0 ? kBottom : row - 1}, guess});
                }
                FlightsBench<Real> bench(discs, {0, -kGravity});
                std::vector<std::int32_t> held;
                RestingContacts<Real>().hold(bench.flights, contacts, held);
                double above = 0;
                for (std::size_t i = count; i-- > 0;) {
                    above += discs[i].mass;
                    CHECK(contacts[i].force == doctest::Approx(above * kGravity).epsilon(1e-9));
                    CHECK(std::fabs(bench.flights.accelerations[i].y) < 1e-8);
                }
                // What the floor gives in a substep holds up the weight of all.
                CHECK(bench.books.wall_momentum.y ==
                      doctest::Approx(above * kGravity * bench.flights.end.t).epsilon(1e-9));
                std::vector<std::int32_t> rows(count);
                for (std::size_t i = 0; i < count; ++i) rows[i] = static_cast<std::int32_t>(i);
                CHECK(held == rows);
            }
    }

    TEST_CASE_TEMPLATE("forces push, and none pushes where bodies part", Real, float, double) {
        std::size_t pushing = 0, idle = 0;
        for (unsigned seed = 1; seed <= 30; ++seed) {
            CAPTURE(seed);
            std::mt19937 random(seed);
            const auto draw = [&](double low, double high) {
                return low + (high - low) * static_cast<double>(random() % 10001) * 1e-4;
            };
            std::vector<typename FlightsBench<Real>::Disc> discs;
            for (std::size_t i = 0; i < 7; ++i)
                discs.push_back({{draw(-3, 3), draw(0, 6)}, {}, draw(0.5, 4), 0.5, i == 6});
            FlightsBench<Real> bench(discs, {0, -kGravity});
            // Any normals will do: whether they touch is not asked here.
            std::vector<PressedMeeting> contacts;
            while (contacts.size() < 9) {
                const auto a = static_cast<std::int32_t>(random() % 6);
                const auto b = random() % 4 == 0 ? kBottom : static_cast<std::int32_t>(random() % 7);
                const auto is_same = [&](const PressedMeeting& p) {
                    return p.meeting == Meeting{a, b} || p.meeting == Meeting{b, a};
                };
                if (a != b && std::none_of(contacts.begin(), contacts.end(), is_same))
                    contacts.push_back({{a, b}, draw(0, 20)});
            }
            Complementarity problem(contacts.size());
            std::vector<double> unforced;
            for (std::size_t i = 0; i < contacts.size(); ++i) {
                unforced.push_back(normal_acceleration(bench, contacts[i].meeting));
                problem.b(i) = unforced[i];
                for (std::size_t j = 0; j < contacts.size(); ++j)
                    problem.a(i, j) = bench.coupling(contacts[i].meeting, contacts[j].meeting);
            }
            const std::vector<long double> exact = problem.solve();
            if (exact.empty()) continue;  // forces that are not unique
            std::vector<std::int32_t> held;
            RestingContacts<Real>().hold(bench.flights, contacts, held);
            double worst = 0;
            for (std::size_t i = 0; i < contacts.size(); ++i) {
                double expected = unforced[i];
                for (std::size_t j = 0; j < contacts.size(); ++j)
                    expected += static_cast<double>(exact[j]) *
                                bench.coupling(contacts[j].meeting, contacts[i].meeting);
                worst =
                    std::fmax(worst, std::fabs(normal_acceleration(bench, contacts[i].meeting) - expected));
                CHECK(contacts[i].force >= 0);
                pushing += exact[i] > 0, idle += exact[i] == 0;
            }
            CHECK(worst < 1e-6);
            CHECK(std::is_sorted(held.begin(), held.end()));
            CHECK(std::adjacent_find(held.begin(), held.end()) == held.end());
        }
        CHECK(pushing > 50);
        CHECK(idle > 50);
    }

    TEST_CASE_TEMPLATE("an approach is stopped without a bounce, and a slow separation is held", Real, float,
                       double) {
        for (const double speed : {-0.002, 1e-6}) {  // m/s, gravity adds 0.16 in the substep
            FlightsBench<Real> bench({{{0, 0.5}, {0.5, speed}}}, {0, -kGravity});
            std::vector<PressedMeeting> contacts{{{0, kBottom}, 0}};
            std::vector<std::int32_t> held;
            RestingContacts<Real>().hold(bench.flights, contacts, held);
            const Flight f = bench.flights.flight(0);
            const FlightClock& end = bench.flights.end;
            CHECK(f.velocity.x == 0.5);
            CHECK(std::fabs(velocity_at(f, end.s, 0).y) < 1e-9);  // at the end of the substep it rests
            CHECK(std::fabs(position_at(f, end.s, end.q).y - 0.5) < 1e-7);
        }
    }

    TEST_CASE_TEMPLATE(
        "what turns around a disc presses less by m v²/R, and leaves it when that is its weight", Real, float,
        double) {
        constexpr double kMass = 2, kReach = 4;
        for (const double speed : {0.0, 3.0, 6.0, 7.0}) {
            FlightsBench<Real> bench({{{0, 5}, {}, 1, 3.5, true}, {{0, 5 + kReach}, {speed, 0}, kMass, 0.5}},
                                     {0, -kGravity});
            std::vector<PressedMeeting> contacts{{{0, 1}, 5}};
            std::vector<std::int32_t> held;
            RestingContacts<Real>().hold(bench.flights, contacts, held);
            const double expected = std::fmax(0, kMass * (kGravity - speed * speed / kReach));
            CHECK(contacts[0].force == doctest::Approx(expected).epsilon(1e-9));
            CHECK(bench.flights.acceleration(1).y ==
                  doctest::Approx(expected / kMass - kGravity).epsilon(1e-9));
            CHECK(bench.flights.acceleration(0).y == 0);
        }
    }
}

}  // namespace test_resting_contacts
