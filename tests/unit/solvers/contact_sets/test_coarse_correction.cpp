// The correction of loads on a coarse grid, on its own: a triangular lattice of discs that touch, with random
// loads that push and stick.
#include "solvers/contact_sets/coarse_correction.hpp"

#include "isa/select_isa.hpp"
#include "support/report.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace test_coarse_correction {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kRadius = 0.5, kFriction = 0.5;
constexpr std::size_t kRoughKernels = 1;  // of KernelTable::contacts: with friction, all bodies turn
constexpr std::size_t kAlong = 48, kDiscs = kAlong * kAlong;
constexpr Vec2 kGain{0, -10.0 / 240};  // m/s

struct Totals {
    double momentum_x = 0, momentum_y = 0, angular_momentum = 0, energy = 0;
};

/// Discs of several masses, contacts with their three neighbours above and to the right, a colour for each
/// direction and parity. Behind the discs is the row of the padding.
template <class Real>
struct LoadedLattice {
    Column<Real> motion, velocity, normal_x, normal_y, separation, floor, reach, normal_impulse,
        friction_impulse;
    Column<std::int32_t> a, b;

    explicit LoadedLattice(unsigned seed) {
        std::mt19937 random(seed);
        const auto number = [&] { return static_cast<double>(random() % 100001) * 1e-5; };
        const std::size_t rows = padded(kDiscs + 1);
        motion.resize(4 * rows), velocity.resize(4 * rows);
        std::fill(motion.begin(), motion.end(), Real(0));
        std::fill(velocity.begin(), velocity.end(), Real(0));
        for (std::size_t row = 0; row < kDiscs; ++row) {
            const auto i = static_cast<double>(row % kAlong), j = static_cast<double>(row / kAlong);
            motion[4 * row] = static_cast<Real>(i + 0.5 * static_cast<double>(row / kAlong % 2));
            motion[4 * row + 1] = static_cast<Real>(j * 0.5 * std::sqrt(3.0));
            velocity[4 * row + 3] = static_cast<Real>(1 / (0.5 + number()));
        }
        for (std::size_t direction = 0; direction < 3; ++direction)
            for (std::size_t parity = 0; parity < 2; ++parity) add_colour(direction, parity);
        for (std::size_t c = 0; c < a.size(); ++c) {
            const bool is_padding = static_cast<std::size_t>(a[c]) == kDiscs;
            const double push = is_padding ? 0 : std::fmax(number() - 0.2, 0);  // some do not push
            normal_impulse.push_back(static_cast<Real>(push));
            friction_impulse.push_back(static_cast<Real>(push * kFriction * (2 * number() - 1)));
        }
    }

    Vec2 place(std::size_t row) const { return {motion[4 * row], motion[4 * row + 1]}; }

    void add_colour(std::size_t direction, std::size_t parity) {
        const auto add = [&](std::size_t of_a, std::size_t of_b) {
            a.push_back(static_cast<std::int32_t>(of_a)), b.push_back(static_cast<std::int32_t>(of_b));
            const bool is_padding = of_a == kDiscs;
            const Vec2 d = is_padding ? Vec2{1, 0} : place(of_b) - place(of_a);
            const double distance = std::sqrt(length_squared(d));
            normal_x.push_back(static_cast<Real>(d.x / distance));
            normal_y.push_back(static_cast<Real>(d.y / distance));
            reach.push_back(static_cast<Real>(2 * kRadius));
            separation.push_back(Real(0)), floor.push_back(Real(0));
        };
        for (std::size_t row = 0; row < kDiscs; ++row) {
            const std::size_t i = row % kAlong, j = row / kAlong;
            if ((direction == 0 ? i : j) % 2 != parity) continue;
            const bool is_shifted = j % 2 == 1;
            if (direction == 0 && i + 1 < kAlong) add(row, row + 1);
            if (direction == 0 || j + 1 == kAlong) continue;
            const std::size_t above = row + kAlong - (is_shifted ? 0 : 1) + (direction - 1);
            if (above >= (j + 1) * kAlong && above < (j + 2) * kAlong) add(row, above);
        }
        while (a.size() % kContactBlock != 0) add(kDiscs, kDiscs);
    }

    Totals totals() const {
        Totals sum;
        for (std::size_t row = 0; row < kDiscs; ++row) {
            const Real* record = velocity.data() + 4 * row;
            const double m = 1 / static_cast<double>(record[3]), rim = record[2];
            const Vec2 v{record[0], record[1]};
            sum.momentum_x += m * v.x, sum.momentum_y += m * v.y;
            sum.angular_momentum += m * (cross(place(row), v) + 0.5 * kRadius * rim);
            sum.energy += 0.5 * m * (length_squared(v) + 0.5 * rim * rim);
        }
        return sum;
    }

    /// @return whether there was anything to be done
    bool correct(const KernelTable<Real>& kernels, CoarseCorrection<Real>& coarse) {
        SolveContacts<Real> k{};
        k.contacts.a = a.data(), k.contacts.b = b.data();
        k.contacts.normal_x = normal_x.data(), k.contacts.normal_y = normal_y.data();
        k.contacts.separation = separation.data(), k.contacts.floor = floor.data();
        k.contacts.normal_impulse = normal_impulse.data();
        k.contacts.friction_impulse = friction_impulse.data();
        k.velocity = velocity.data(), k.reach = reach.data();
        coarse.begin(velocity.size() / 4);
        k.load = coarse.load(), k.stress = coarse.stress(), k.scale = coarse.scale();
        kernels.contacts[kRoughKernels].sum_loads_pairs(k, 0, a.size());
        if (!coarse.find_scale(kDiscs, motion.data(), velocity.data(), kRadius, kGain, Executor{}))
            return false;
        kernels.contacts[kRoughKernels].scale_loads_pairs(k, 0, a.size());
        return true;
    }
};

/// Everybody nears the middle, besides a random part, and spins.
template <class Real>
void close_in(LoadedLattice<Real>& lattice, double rate, double noise, unsigned seed) {
    std::mt19937 random(seed);
    const auto number = [&] { return noise * (static_cast<double>(random() % 100001) * 2e-5 - 1); };
    for (std::size_t row = 0; row < kDiscs; ++row) {
        const Vec2 from_middle = lattice.place(row) - Vec2{0.5 * kAlong, 0.43 * kAlong};
        lattice.velocity[4 * row] = static_cast<Real>(-rate * from_middle.x + number());
        lattice.velocity[4 * row + 1] = static_cast<Real>(-rate * from_middle.y + number());
        lattice.velocity[4 * row + 2] = static_cast<Real>(number());
    }
}

template <class Real>
const KernelTable<Real>& scalar_kernels() {
    return runnable_kernel_tables().front()->of<Real>();
}

}  // namespace

TEST_SUITE("solvers/contact_sets/coarse_correction") {
    TEST_CASE_TEMPLATE("momentum and angular momentum are kept, kinetic energy does not grow", Real, float,
                       double) {
        const double allowed = sizeof(Real) == 4 ? 3e-6 : 1e-14;
        for (unsigned seed = 1; seed <= 20; ++seed) {
            CAPTURE(seed);
            LoadedLattice<Real> lattice(seed);
            close_in(lattice, seed % 4 == 0 ? 0 : 0.003 * seed, 0.01 * (seed % 5), seed);
            const Totals before = lattice.totals();
            CoarseCorrection<Real> coarse;
            REQUIRE(lattice.correct(scalar_kernels<Real>(), coarse));
            const Totals after = lattice.totals();
            const double momentum = std::sqrt(2 * before.energy * kDiscs);
            CHECK(std::fabs(after.momentum_x - before.momentum_x) <= allowed * momentum);
            CHECK(std::fabs(after.momentum_y - before.momentum_y) <= allowed * momentum);
            CHECK(std::fabs(after.angular_momentum - before.angular_momentum) <= allowed * momentum * kAlong);
            CHECK(after.energy <= before.energy * (1 + allowed));
        }
    }

    TEST_CASE_TEMPLATE("what nears the middle as a whole is stopped", Real, float, double) {
        LoadedLattice<Real> lattice(1);
        std::fill(lattice.friction_impulse.begin(), lattice.friction_impulse.end(), Real(0));
        // Under a pressure that is the same everywhere inside.
        for (std::size_t c = 0; c < lattice.a.size(); ++c)
            if (static_cast<std::size_t>(lattice.a[c]) < kDiscs) lattice.normal_impulse[c] = Real(0.1);
        for (std::size_t row = 0; row < kDiscs; ++row) lattice.velocity[4 * row + 3] = Real(1);
        close_in(lattice, 0.001, 0, 1);
        const double before = lattice.totals().energy;
        CoarseCorrection<Real> coarse;
        REQUIRE(lattice.correct(scalar_kernels<Real>(), coarse));
        const double left = lattice.totals().energy / before;
        report("energy left: ", 100 * left, " %");
        CHECK(left < 0.3);
    }

    TEST_CASE_TEMPLATE("what moves and turns without getting nearer is left alone", Real, float, double) {
        LoadedLattice<Real> lattice(2);
        constexpr double kSpin = 0.3;
        for (std::size_t row = 0; row < kDiscs; ++row) {
            const Vec2 at = lattice.place(row);
            lattice.velocity[4 * row] = static_cast<Real>(2 - kSpin * at.y);
            lattice.velocity[4 * row + 1] = static_cast<Real>(1 + kSpin * at.x);
            lattice.velocity[4 * row + 2] = static_cast<Real>(kSpin * kRadius);
        }
        const Column<Real> before = lattice.velocity;
        CoarseCorrection<Real> coarse;
        REQUIRE(lattice.correct(scalar_kernels<Real>(), coarse));
        double off = 0;
        for (std::size_t i = 0; i < before.size(); ++i)
            off = std::fmax(off, std::fabs(static_cast<double>(lattice.velocity[i] - before[i])));
        report("off by ", off, " m/s");
        CHECK(off < (sizeof(Real) == 4 ? 1e-4 : 1e-12));
    }

    TEST_CASE_TEMPLATE("contacts push, and friction stays within its limit", Real, float, double) {
        LoadedLattice<Real> lattice(3);
        close_in(lattice, -0.5, 0.5, 3);  // apart, so that loads become less
        CoarseCorrection<Real> coarse;
        const Column<Real> before = lattice.normal_impulse;
        REQUIRE(lattice.correct(scalar_kernels<Real>(), coarse));
        double least = 1;
        for (std::size_t c = 0; c < before.size(); ++c) {
            if (!(before[c] > 0)) continue;
            const double normal = lattice.normal_impulse[c];
            least = std::fmin(least, normal / static_cast<double>(before[c]));
            CHECK(normal > 0);
            CHECK(std::fabs(static_cast<double>(lattice.friction_impulse[c])) <=
                  kFriction * normal * (1 + 1e-6));
        }
        CHECK(least < 0.5);  // else nothing was tried
    }

    TEST_CASE_TEMPLATE("discs that do not push are left alone", Real, float, double) {
        LoadedLattice<Real> lattice(4);
        for (Column<Real>* impulses : {&lattice.normal_impulse, &lattice.friction_impulse})
            std::fill(impulses->begin(), impulses->end(), Real(0));
        close_in(lattice, 0.01, 0, 4);
        CoarseCorrection<Real> coarse;
        CHECK(!lattice.correct(scalar_kernels<Real>(), coarse));
    }

    TEST_CASE_TEMPLATE("every instruction set gives the same bits", Real, float, double) {
        LoadedLattice<Real> expected(5);
        close_in(expected, 0.01, 0.01, 5);
        const LoadedLattice<Real> start = expected;
        CoarseCorrection<Real> coarse;
        expected.correct(scalar_kernels<Real>(), coarse);
        for (const KernelTables* tables : runnable_kernel_tables()) {
            CAPTURE(tables->of<Real>().isa);
            LoadedLattice<Real> actual = start;
            CoarseCorrection<Real> own;
            actual.correct(tables->of<Real>(), own);
            CHECK(std::ranges::equal(actual.velocity, expected.velocity));
            CHECK(std::ranges::equal(actual.normal_impulse, expected.normal_impulse));
            CHECK(std::ranges::equal(actual.friction_impulse, expected.friction_impulse));
        }
    }

    TEST_CASE("a correction that does little is followed by longer and longer pauses") {
        LoadedLattice<double> lattice(6);  // at rest
        CoarseCorrection<double> coarse;
        int steps = 0, last = 0;
        std::vector<int> pauses;
        while (pauses.size() < 6) {
            ++steps;
            if (!coarse.is_due(kDiscs, 4)) continue;
            pauses.push_back(steps - last), last = steps;
            lattice.correct(scalar_kernels<double>(), coarse);
        }
        for (std::size_t i = 1; i < pauses.size(); ++i)
            CHECK((pauses[i] == 2 * pauses[i - 1] || pauses[i] == pauses.back()));
        CHECK(pauses.front() < pauses.back());
        CHECK(pauses[4] == pauses[5]);  // they do not grow for ever
        LoadedLattice<double> moving(6);
        for (std::size_t c = 0; c < moving.a.size(); ++c) {  // loads that balance, as in a pile
            moving.normal_impulse[c] = static_cast<std::size_t>(moving.a[c]) < kDiscs ? 1 : 0;
            moving.friction_impulse[c] = 0;
        }
        close_in(moving, 0.01, 0, 6);
        moving.correct(scalar_kernels<double>(), coarse);
        CHECK(!coarse.is_due(kDiscs, 4));
        CHECK(coarse.is_due(kDiscs, 4));
        CHECK(coarse.kept() == 1.0 / 8);
        CHECK(!coarse.is_due(100, 64));  // too few bodies
    }
}

}  // namespace test_coarse_correction
