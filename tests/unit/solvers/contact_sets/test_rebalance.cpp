// Impulses around a body that was removed, against statics: of columns in closed form, of piles body by body.
#include "solvers/contact_sets/rebalance.hpp"

#include "unit/solvers/contact_sets/contact_rows_bench.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace test_rebalance {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kFall = 0.04;  // m/s, what gravity adds in a substep
constexpr Vec2 kGain{0, -kFall};
constexpr Vector kDown{0, -1};

template <class Real>
using Touch = typename ContactRowsBench<Real>::Touch;

/// A triangular pile in a box, at rest: its contacts carry what statics asks for, to a small part of a
/// weight.
struct Pile {
    std::vector<RigidDisc> discs;
    std::vector<Vector> places;
    std::vector<Touch<double>> touches;

    Pile(int rows, int columns, double friction) {
        const long double height = std::sqrt(0.75L);
        for (int row = 0; row < rows; ++row)
            for (int i = 0; i < columns - row % 2; ++i) {
                places.push_back({static_cast<long double>(i) + (row % 2 == 0 ? 0 : 0.5L), height * row});
                discs.push_back(RigidDisc::of_mass(1 + 0.25 * ((row + 2 * i) % 3), 0.5));
            }
        for (std::size_t b = 0; b < discs.size(); ++b) {
            for (std::size_t a = 0; a < b; ++a) {
                const Vector d = places[b] - places[a];
                if (dot(d, d) < 1.01L)
                    touches.push_back(
                        {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), d, friction});
            }
            const auto row = static_cast<std::int32_t>(b);
            if (places[b].y == 0) touches.push_back({row, -1, kDown, friction});
            if (places[b].x == 0) touches.push_back({row, -1, {-1, 0}, friction});
            if (places[b].x == columns - 1) touches.push_back({row, -1, {1, 0}, friction});
        }
        rest();
    }

    /// Sweeps of the textbook's contacts until no velocity is left.
    void rest() {
        std::vector<RigidDisc> moving = discs;
        for (RigidDisc& d : moving) d.velocity = {0, -kFall};
        RigidDisc plane;
        std::vector<DiscContact> contacts;
        for (const Touch<double>& t : touches) {
            RigidDisc* b = t.b < 0 ? &plane : &moving[static_cast<std::size_t>(t.b)];
            contacts.push_back({&moving[static_cast<std::size_t>(t.a)], b, t.normal, t.friction});
        }
        for (int sweep = 0; sweep < 4000; ++sweep)
            for (DiscContact& c : contacts) c.solve_normal(), c.solve_friction();
        for (std::size_t i = 0; i < contacts.size(); ++i)
            touches[i].along = static_cast<double>(contacts[i].along),
            touches[i].tangent = static_cast<double>(contacts[i].tangent);
    }

    /// Takes the last disc's row for `gone`, as the solver does. @return those that it pressed on, sorted
    std::vector<LostContact> remove(std::int32_t gone) {
        const auto last = static_cast<std::int32_t>(discs.size() - 1);
        std::vector<LostContact> lost;
        std::vector<Touch<double>> kept;
        for (Touch<double> t : touches) {
            const auto renamed = [&](std::int32_t row) { return row == last ? gone : row; };
            if (t.a == gone || t.b == gone) {
                const std::int32_t other = t.a == gone ? t.b : t.a;
                if (other >= 0 && t.along > 0) lost.push_back({1000, renamed(other)});
                continue;
            }
            t.a = renamed(t.a), t.b = t.b < 0 ? t.b : renamed(t.b);
            kept.push_back(t);
        }
        touches = kept;
        discs[static_cast<std::size_t>(gone)] = discs.back();
        discs.pop_back();
        std::sort(lost.begin(), lost.end());
        return lost;
    }
};

/// What neither rest nor free fall explains, as a share of what is allowed of it: half a weight, and some of
/// what presses on a body. The most of all bodies.
template <class Real>
long double unevenness(ContactRowsBench<Real>& bench, const std::vector<long double>& pressed) {
    std::vector<Vector> sum(bench.discs.size());
    for (std::size_t row = 0; row < sum.size(); ++row)
        sum[row] = kFall / bench.discs[row].inverse_mass * kDown;
    for (std::size_t i = 0; i < bench.contacts.size(); ++i) {
        const DiscContact& c = bench.contacts[i];
        const Vector impulse = bench.along(i) * c.normal + bench.tangent(i) * turned(c.normal);
        Vector& of_a = sum[static_cast<std::size_t>(c.a - bench.discs.data())];
        of_a = of_a - impulse;
        if (c.b == &bench.plane) continue;
        Vector& of_b = sum[static_cast<std::size_t>(c.b - bench.discs.data())];
        of_b = of_b + impulse;
    }
    long double worst = 0;
    for (std::size_t row = 0; row < sum.size(); ++row) {
        const long double weight = kFall / bench.discs[row].inverse_mass;
        const long double falling = std::clamp(dot(sum[row], kDown), 0.0L, weight);
        const Vector excess = sum[row] - falling * kDown;
        worst = std::max(worst, std::sqrt(dot(excess, excess)) / (0.5L * weight + 0.002L * pressed[row]));
    }
    return worst;
}

/// N s, of all contacts of each body.
template <class Real>
std::vector<long double> pressure(ContactRowsBench<Real>& bench) {
    std::vector<long double> sum(bench.discs.size());
    for (std::size_t i = 0; i < bench.contacts.size(); ++i)
        for (const RigidDisc* disc : {bench.contacts[i].a, bench.contacts[i].b})
            if (disc != &bench.plane)
                sum[static_cast<std::size_t>(disc - bench.discs.data())] += std::hypot(
                    static_cast<long double>(bench.along(i)), static_cast<long double>(bench.tangent(i)));
    return sum;
}

template <class Real>
std::vector<Touch<Real>> converted(const std::vector<Touch<double>>& touches) {
    std::vector<Touch<Real>> list;
    for (const auto& t : touches)
        list.push_back({t.a, t.b, t.normal, t.friction, t.floor, t.along, t.tangent});
    return list;
}

}  // namespace

TEST_SUITE("solvers/contact_sets/rebalance") {
    TEST_CASE_TEMPLATE("where the top of a column is gone, each contact carries what is left above it", Real,
                       float, double) {
        constexpr std::int32_t kLeft = 6;
        constexpr double kTop = 12;  // kg, of what is gone
        std::vector<RigidDisc> discs;
        std::vector<Touch<Real>> touches;
        for (std::int32_t row = 0; row < kLeft; ++row) {
            discs.push_back(RigidDisc::of_mass(1, 0.5));
            touches.push_back({row, row - 1, kDown, 0, 0, (kLeft - row + kTop) * kFall});
        }
        ContactRowsBench<Real> bench(discs, touches);
        const LostContact lost[] = {{1000, kLeft - 1}};
        Rebalance<Real>().balance(lost, bench.pairs, bench.supports, bench.bodies, 0, 0, kGain);
        for (std::size_t i = 0; i < bench.contacts.size(); ++i) {
            const auto row = bench.contacts[i].a - bench.discs.data();
            CHECK(static_cast<double>(bench.along(i)) ==
                  doctest::Approx(static_cast<double>(kLeft - row) * kFall)
                      .epsilon(100 * std::numeric_limits<Real>::epsilon()));
        }
    }

    TEST_CASE_TEMPLATE(
        "where the middle of a column is gone, what is above falls and what is below carries itself", Real,
        float, double) {
        // Discs 0, 1 are below, 2, 3 and 4 above what was there: of 1 kg.
        std::vector<RigidDisc> discs(5, RigidDisc::of_mass(1, 0.5));
        const std::vector<Touch<Real>> touches{{0, -1, kDown, 0, 0, 6 * kFall},
                                               {1, 0, kDown, 0, 0, 5 * kFall},
                                               {3, 2, kDown, 0, 0, 2 * kFall},
                                               {4, 3, kDown, 0, 0, 1 * kFall}};
        ContactRowsBench<Real> bench(discs, touches);
        const LostContact lost[] = {{1000, 1}, {1000, 2}};
        const std::vector<long double> pressed = pressure(bench);
        CHECK(unevenness(bench, pressed) > 5);
        Rebalance<Real>().balance(lost, bench.pairs, bench.supports, bench.bodies, 0, 0, kGain);
        CHECK(unevenness(bench, pressed) < 1.01);
        for (std::size_t i = 0; i < bench.contacts.size(); ++i) CHECK(bench.along(i) >= 0);
    }

    TEST_CASE_TEMPLATE("no body of a pile is left with much more than one that falls, whichever is gone",
                       Real, float, double) {
        for (const double friction : {0.0, 0.5}) {
            const Pile whole(5, 6, friction);
            std::vector<RigidDisc> discs = whole.discs;
            ContactRowsBench<Real> at_rest(discs, converted<Real>(whole.touches));
            CHECK(unevenness(at_rest, pressure(at_rest)) < 0.01);
            int disturbed = 0;
            for (std::int32_t gone = 0; gone < static_cast<std::int32_t>(whole.discs.size()); ++gone) {
                CAPTURE(friction);
                CAPTURE(gone);
                Pile pile = whole;
                const std::vector<LostContact> lost = pile.remove(gone);
                ContactRowsBench<Real> bench(pile.discs, converted<Real>(pile.touches));
                const std::vector<long double> pressed = pressure(bench);
                disturbed += unevenness(bench, pressed) > 1.5;
                Rebalance<Real>().balance(lost, bench.pairs, bench.supports, bench.bodies, 0, 0, kGain);
                CHECK(unevenness(bench, pressed) < 1.01);
                std::size_t wrong = 0;
                for (std::size_t i = 0; i < bench.contacts.size(); ++i) {
                    const double limit = friction * static_cast<double>(bench.along(i));
                    wrong += bench.along(i) < 0 ||
                             std::fabs(static_cast<double>(bench.tangent(i))) > limit * (1 + 1e-6) + 1e-12;
                }
                CHECK(wrong == 0);
            }
            CHECK(disturbed > 10);
        }
    }

    TEST_CASE_TEMPLATE("a load goes far where a heavy body is gone, and not where a light one was struck",
                       Real, float, double) {
        constexpr std::int32_t kLeft = 6;
        constexpr double kBlow =
            12;  // impulse on the column's top, in what gravity gives to 1 kg in a substep
        for (const double mass : {1.0, kBlow}) {
            CAPTURE(mass);
            std::vector<RigidDisc> discs(kLeft, RigidDisc::of_mass(1, 0.5));
            std::vector<Touch<Real>> touches;
            for (std::int32_t row = 0; row < kLeft; ++row)
                touches.push_back({row, row - 1, kDown, 0, 0, (kLeft - row + kBlow) * kFall});
            ContactRowsBench<Real> bench(discs, touches);
            const LostContact lost[] = {{1000, kLeft - 1, true, {0, -kBlow * kFall}, mass}};
            CHECK(Rebalance<Real>().balance(lost, bench.pairs, bench.supports, bench.bodies, 0, 0, kGain) ==
                  (mass > 4));
        }
    }

    TEST_CASE_TEMPLATE("where nothing was lost nothing changes", Real, float, double) {
        const Pile pile(4, 5, 0.5);
        ContactRowsBench<Real> bench(pile.discs, converted<Real>(pile.touches));
        const Column<Real> pairs = bench.pairs.normal_impulse, supports = bench.supports.normal_impulse;
        Rebalance<Real>().balance({}, bench.pairs, bench.supports, bench.bodies, 0, 0, kGain);
        CHECK(std::equal(pairs.begin(), pairs.end(), bench.pairs.normal_impulse.begin()));
        CHECK(std::equal(supports.begin(), supports.end(), bench.supports.normal_impulse.begin()));
    }
}

}  // namespace test_rebalance
