// What impulses add to the energy of bodies in a substep, against sums over bodies by the books' formulas.
#include "isa/select_isa.hpp"
#include "state/columns/column.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

namespace test_measure_gain {

using namespace carom;

namespace {

constexpr std::size_t kBodies = 1000;

/// Random velocities at the start and at the end of a substep; some bodies do not move, some do not turn.
template <class Real>
struct Records {
    Column<Real> velocity, start_x, start_y, start_rim;
    std::vector<double> mass, rim;  // kg, m

    explicit Records(bool turns) {
        std::mt19937 random(7);
        const auto draw = [&](double low, double high) {
            return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
        };
        velocity.resize(4 * padded(kBodies));
        for (Column<Real>* column : {&start_x, &start_y, &start_rim}) column->resize(padded(kBodies));
        for (std::size_t row = 0; row < kBodies; ++row) {
            mass.push_back(row % 7 == 3 ? 0 : draw(0.5, 5)), rim.push_back(draw(0.1, 2));
            for (std::size_t k = 0; k < 3; ++k) velocity[4 * row + k] = static_cast<Real>(draw(-4, 4));
            const bool is_fixed = row % 5 == 2 || !turns;
            if (is_fixed) velocity[4 * row + 2] = 0;
            velocity[4 * row + 3] =
                mass[row] > 0 ? static_cast<Real>((row % 5 == 2 ? -1 : 1) / mass[row]) : Real(0);
            start_x[row] = static_cast<Real>(draw(-4, 4)), start_y[row] = static_cast<Real>(draw(-4, 4));
            start_rim[row] = static_cast<Real>(is_fixed ? 0 : draw(-4, 4));
        }
    }
    EnergyGain measured(const KernelTable<Real>& kernels, bool turns, std::size_t first, std::size_t last,
                        bool is_work = false) {
        const MeasureGain<Real> k{
            velocity.data(), {start_x.data(), start_y.data(), turns ? start_rim.data() : nullptr},
            Real(0.25),      Real(-0.5),
            Real(0.9375),    Real(0.875)};
        return kernels.measure_gain[(turns ? 1 : 0) + (is_work ? 2 : 0)](k, first, last);
    }
    /// Force times way: the change of momentum that free flight does not account for, times the mean
    /// velocity.
    double work() const {
        double sum = 0;
        for (std::size_t row = 0; row < kBodies; ++row) {
            const auto along = [](double start, double free, double end) {
                return (end - free) * 0.5 * (start + end);
            };
            const double x = start_x[row], y = start_y[row], u = start_rim[row];
            sum += mass[row] * along(x, 0.9375 * x + 0.25, velocity[4 * row]) +
                   mass[row] * along(y, 0.9375 * y - 0.5, velocity[4 * row + 1]) +
                   0.5 * mass[row] * along(u, 0.875 * u, velocity[4 * row + 2]);
        }
        return sum;
    }
    /// m v² / 2 and I w² / 2 of each body, with I = m rim² / 2.
    EnergyGain summed() const {
        EnergyGain sum;
        for (std::size_t row = 0; row < kBodies; ++row) {
            const auto energy = [&](double x, double y, double at_rim) {
                const double spin = at_rim / rim[row], inertia = 0.5 * mass[row] * rim[row] * rim[row];
                return 0.5 * mass[row] * (x * x + y * y) + 0.5 * inertia * spin * spin;
            };
            const double before = energy(0.9375 * static_cast<double>(start_x[row]) + 0.25,
                                         0.9375 * static_cast<double>(start_y[row]) - 0.5,
                                         0.875 * static_cast<double>(start_rim[row]));
            sum.before += before;
            sum.gain += energy(velocity[4 * row], velocity[4 * row + 1], velocity[4 * row + 2]) - before;
        }
        return sum;
    }
};

}  // namespace

TEST_SUITE("kernels/measure gain") {
    TEST_CASE_TEMPLATE("what impulses add to the energy of bodies is what their energies differ by", Real,
                       float, double) {
        const double precision = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-14;
        for (const bool turns : {false, true}) {
            CAPTURE(turns);
            Records<Real> records(turns);
            const EnergyGain expected = records.summed();
            const EnergyGain first =
                records.measured(runnable_kernel_tables().front()->of<Real>(), turns, 0, padded(kBodies));
            CHECK(first.before == doctest::Approx(expected.before).epsilon(precision));
            CHECK(std::abs(first.gain - expected.gain) < precision * expected.before);
            for (const KernelTables* tables : runnable_kernel_tables()) {
                const EnergyGain sum = records.measured(tables->of<Real>(), turns, 0, padded(kBodies));
                CHECK(sum.gain == first.gain);
                CHECK(sum.before == first.before);
            }
            const EnergyGain work = records.measured(runnable_kernel_tables().front()->of<Real>(), turns, 0,
                                                     padded(kBodies), true);
            CHECK(std::abs(work.gain - records.work()) < precision * expected.before);
            CHECK(work.before == first.before);
            for (const KernelTables* tables : runnable_kernel_tables())
                CHECK(records.measured(tables->of<Real>(), turns, 0, padded(kBodies), true).gain ==
                      work.gain);
        }
    }
}

}  // namespace test_measure_gain
