// Sums of the ledger over bodies and contacts, against sums in double precision by the formulas of mechanics.
#include "isa/select_isa.hpp"
#include "state/columns/column.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace test_sum_work {

using namespace carom;

namespace {

constexpr std::size_t kBodies = 500, kContacts = 1000;
constexpr double kUniformMass = 3;  // kg

/// Bodies with random velocities at the start and at the end of a substep, some of which nothing moves, and
/// contacts with random impulses.
template <class Real>
struct Substep {
    Column<Real> velocity, start_x, start_y, start_rim, mass, mean;
    Column<std::int32_t> a, b;
    Column<Real> normal_x, normal_y, normal, friction, rolling, share;
    Column<Real> surface_normal, surface_tangent, surface_rolling;

    Substep() {
        std::mt19937 random(11);
        const auto draw = [&](double low, double high) {
            return static_cast<Real>(low + (high - low) * static_cast<double>(random()) / 4294967296.0);
        };
        velocity.resize(4 * padded(kBodies)), mean.resize(4 * padded(kBodies));
        for (Column<Real>* column : {&start_x, &start_y, &start_rim, &mass}) column->resize(padded(kBodies));
        for (std::size_t row = 0; row < kBodies; ++row) {
            mass[row] = draw(0.5, 5);
            for (std::size_t k = 0; k < 3; ++k) velocity[4 * row + k] = draw(-4, 4);
            velocity[4 * row + 3] = row % 7 == 3 ? Real(0) : (row % 5 == 2 ? -1 : 1) / mass[row];
            start_x[row] = draw(-4, 4), start_y[row] = draw(-4, 4), start_rim[row] = draw(-4, 4);
        }
        a.resize(kContacts), b.resize(kContacts);
        for (Column<Real>* column : {&normal_x, &normal_y, &normal, &friction, &rolling, &share,
                                     &surface_normal, &surface_tangent, &surface_rolling})
            column->resize(padded(kContacts));
        for (std::size_t i = 0; i < kContacts; ++i) {
            a[i] = static_cast<std::int32_t>(random() % kBodies);
            b[i] = static_cast<std::int32_t>(random() % kBodies);
            const double angle = static_cast<double>(draw(0, 6));
            normal_x[i] = static_cast<Real>(std::cos(angle)),
            normal_y[i] = static_cast<Real>(std::sin(angle));
            normal[i] = draw(0, 2), friction[i] = draw(-1, 1), rolling[i] = draw(-1, 1);
            share[i] = draw(0.2, 0.8);
            surface_normal[i] = draw(-1, 1), surface_tangent[i] = draw(-1, 1);
            surface_rolling[i] = draw(-1, 1);
        }
    }
    bool moves(std::size_t row) const { return velocity[4 * row + 3] != 0; }
    FlightSums average(const KernelTable<Real>& kernels, bool turns, bool drags, bool is_uniform) {
        const TakeMeans<Real> k{velocity.data(),
                                {start_x.data(), start_y.data(), turns ? start_rim.data() : nullptr},
                                is_uniform ? nullptr : mass.data(),
                                static_cast<Real>(kUniformMass),
                                mean.data()};
        FlightSums sums;
        kernels.take_means[(turns ? 1 : 0) + (drags ? 2 : 0)](k, 0, padded(kBodies), sums);
        return sums;
    }
    WorkSums work(const KernelTable<Real>& kernels, std::size_t variant, bool are_pairs) {
        SolveContacts<Real> k{};
        k.velocity = mean.data();
        k.contacts.a = a.data(), k.contacts.b = are_pairs ? b.data() : nullptr;
        k.contacts.normal_x = normal_x.data(), k.contacts.normal_y = normal_y.data();
        k.contacts.normal_impulse = normal.data(), k.contacts.friction_impulse = friction.data();
        k.contacts.rolling_impulse = rolling.data(), k.contacts.rolling_share = share.data();
        k.contacts.surface_normal = surface_normal.data(),
        k.contacts.surface_tangent = surface_tangent.data();
        k.contacts.surface_rolling = surface_rolling.data();
        WorkSums sums;
        const ContactKernels<Real>& of = kernels.contacts[variant];
        const auto kernel = are_pairs ? of.sum_work_pairs : of.sum_work_supports;
        kernel(k, 0, 16, sums), kernel(k, 16, kContacts, sums);
        return sums;
    }
    double mean_of(std::size_t row, std::size_t k) const {
        const Real start = k == 0 ? start_x[row] : k == 1 ? start_y[row] : start_rim[row];
        return 0.5 * (static_cast<double>(start) + static_cast<double>(velocity[4 * row + k]));
    }
    /// Work of the normal impulses, and of the tangential ones and those of rolling [J]: force times way of
    /// the points that touch, on both bodies.
    std::array<double, 2> work_by_formula(bool is_rolling, bool are_pairs) const {
        std::array<double, 2> sum{};
        for (std::size_t i = 0; i < kContacts; ++i) {
            const double nx = normal_x[i], ny = normal_y[i], of_a = share[i];
            const auto body = [&](std::int32_t of) {
                const auto row = static_cast<std::size_t>(of);
                return std::array<double, 3>{mean_of(row, 0), mean_of(row, 1), mean_of(row, 2)};
            };
            const auto of_a_body = body(a[i]);
            double along_n = -(of_a_body[0] * nx + of_a_body[1] * ny),
                   along_t = -(of_a_body[1] * nx - of_a_body[0] * ny) - of_a_body[2],
                   roll = -of_a * of_a_body[2];
            if (are_pairs) {
                const auto other = body(b[i]);
                along_n += other[0] * nx + other[1] * ny;
                along_t += other[1] * nx - other[0] * ny - other[2], roll += (1 - of_a) * other[2];
            } else {
                along_n += static_cast<double>(surface_normal[i]);
                along_t += static_cast<double>(surface_tangent[i]);
                roll += static_cast<double>(surface_rolling[i]);
            }
            sum[0] += static_cast<double>(normal[i]) * along_n;
            sum[1] += static_cast<double>(friction[i]) * along_t;
            if (is_rolling) sum[1] += static_cast<double>(rolling[i]) * roll;
        }
        return sum;
    }
};

constexpr std::size_t kSmooth = 0, kRoughDiscs = 1, kRollingDiscs = 3;  // of KernelTable::contacts

}  // namespace

TEST_SUITE("kernels/sum work") {
    TEST_CASE_TEMPLATE("sums over bodies are those of their momenta and their drag", Real, float, double) {
        const double precision = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-14;
        Substep<Real> substep;
        for (const bool is_uniform : {false, true}) {
            double x = 0, y = 0, from_x = 0, from_y = 0, path = 0, turn = 0, scale = 0;
            for (std::size_t row = 0; row < kBodies; ++row) {
                if (!substep.moves(row)) continue;
                const double m = is_uniform ? kUniformMass : static_cast<double>(substep.mass[row]),
                             x0 = substep.start_x[row], y0 = substep.start_y[row],
                             u0 = substep.start_rim[row];
                x += m * substep.mean_of(row, 0), y += m * substep.mean_of(row, 1);
                from_x += m * x0, from_y += m * y0;
                path += m * (x0 * substep.mean_of(row, 0) + y0 * substep.mean_of(row, 1));
                turn += m * u0 * substep.mean_of(row, 2);
                scale += m * (x0 * x0 + y0 * y0 + u0 * u0);
            }
            const auto first =
                substep.average(runnable_kernel_tables().front()->of<Real>(), true, true, is_uniform);
            const auto is_near = [&](const BlockOfSums& sums, double expected) {
                return std::abs(sums.sum() - expected) < precision * scale;
            };
            CHECK(is_near(first.mean_x, x));
            CHECK(is_near(first.mean_y, y));
            CHECK(is_near(first.start_x, from_x));
            CHECK(is_near(first.start_y, from_y));
            CHECK(is_near(first.path, path));
            CHECK(is_near(first.turn, turn));
            for (std::size_t row = 0; row < kBodies; ++row)
                for (std::size_t k = 0; k < 3; ++k)
                    CHECK(substep.mean[4 * row + k] == static_cast<Real>(substep.mean_of(row, k)));
            for (const KernelTables* tables : runnable_kernel_tables())
                for (const bool drags : {false, true}) {
                    const auto sums = substep.average(tables->of<Real>(), true, drags, is_uniform);
                    CHECK(sums.mean_x == first.mean_x);
                    CHECK(sums.mean_y == first.mean_y);
                    if (!drags) continue;
                    CHECK(sums.start_x == first.start_x);
                    CHECK(sums.start_y == first.start_y);
                    CHECK(sums.path == first.path);
                    CHECK(sums.turn == first.turn);
                }
        }
    }

    TEST_CASE_TEMPLATE("the work of contacts is impulse times way of what touches", Real, float, double) {
        const double precision = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-14;
        Substep<Real> substep;
        substep.average(runnable_kernel_tables().front()->of<Real>(), true, false, false);
        for (const std::size_t variant : {kSmooth, kRoughDiscs, kRollingDiscs})
            for (const bool are_pairs : {true, false}) {
                CAPTURE(variant);
                CAPTURE(are_pairs);
                const auto expected = substep.work_by_formula(variant == kRollingDiscs, are_pairs);
                const WorkSums first =
                    substep.work(runnable_kernel_tables().front()->of<Real>(), variant, are_pairs);
                CHECK(std::abs(first.normal.sum() - expected[0]) < precision * kContacts);
                CHECK(std::abs(first.tangent.sum() - (variant == kSmooth ? 0 : expected[1])) <
                      precision * kContacts);
                for (const KernelTables* tables : runnable_kernel_tables()) {
                    const WorkSums sums = substep.work(tables->of<Real>(), variant, are_pairs);
                    CHECK(sums.normal == first.normal);
                    CHECK(sums.tangent == first.tangent);
                }
            }
    }
}

}  // namespace test_sum_work
