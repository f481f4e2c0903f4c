// Bodies through the substeps of a step: free flight against its exact solution, velocities that contacts
// changed against what the header promises, and rows that are lost.
#include "isa/select_isa.hpp"
#include "state/columns/column.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace test_advance_bodies {

using namespace carom;

namespace {

constexpr long double kH = 1.0L / 256;  // s
constexpr long double kGravityX = 1.5L, kGravityY = -9.5L;

/// Columns of a few bodies, padded as the solver's are: padding has no mass. A batch of sentinels behind.
template <class Real>
struct Rows {
    static constexpr Real kSentinel = Real(-77);
    std::size_t count, length;
    bool turns, are_uniform;
    Column<Real> motion, velocity, displacement, start_x, start_y, start_rim, turn, radius, inverse_mass, x,
        y, vx, vy, angle, spin;
    Column<std::int32_t> lost;

    Rows(std::size_t rows, bool with_rotation, bool uniform, unsigned seed)
        : count(rows), length(padded(rows)), turns(with_rotation), are_uniform(uniform) {
        const std::size_t all = length + kRowPadding;
        for (Column<Real>* column :
             {&start_x, &start_y, &start_rim, &turn, &radius, &inverse_mass, &x, &y, &vx, &vy, &angle, &spin})
            fill(*column, all, length);
        fill(motion, 4 * all, 4 * length), fill(velocity, 4 * all, 4 * length);
        fill(displacement, 2 * all, 2 * length), lost.resize(all);
        std::mt19937 random(seed);
        const auto draw = [&](double low, double high) {
            return static_cast<Real>(low + (high - low) * static_cast<double>(random() % 100001) * 1e-5);
        };
        for (std::size_t row = 0; row < count; ++row) {
            for (std::size_t k = 0; k < 4; ++k) motion[4 * row + k] = draw(-4, 4);
            x[row] = motion[4 * row], y[row] = motion[4 * row + 1];
            vx[row] = motion[4 * row + 2], vy[row] = motion[4 * row + 3];
            radius[row] = are_uniform ? Real(0.5) : draw(0.25, 1), angle[row] = draw(-3, 3);
            spin[row] = draw(-6, 6);
            // Some are immovable, some have a fixed angle, which is a negative inverse mass.
            inverse_mass[row] = are_uniform    ? Real(0.75)
                                : row % 5 == 2 ? 0
                                               : draw(0.2, 2) * (row % 5 == 3 ? -1 : 1);
        }
    }

    bool moves(std::size_t row) const { return inverse_mass[row] != 0; }
    StartColumns<Real> start() {
        return {start_x.data(), start_y.data(), turns ? start_rim.data() : nullptr};
    }

    /// @param linear, angular  drag, 1/s
    void begin(const KernelTable<Real>& kernels, long double linear, long double angular) {
        BeginSubsteps<Real> k{};
        k.motion = motion.data(), k.angular_velocity = turns ? spin.data() : nullptr;
        k.radius = are_uniform ? nullptr : radius.data(), k.uniform_radius = Real(0.5);
        k.inverse_mass = are_uniform ? nullptr : inverse_mass.data(), k.uniform_inverse_mass = Real(0.75);
        set_flight(k, linear, angular);
        k.count = count, k.velocity = velocity.data(), k.start = start();
        k.displacement = displacement.data(), k.turn = turns ? turn.data() : nullptr;
        kernels.begin_substeps[turns ? 1 : 0](k, 0, length);
    }
    /// @param nothing  m/s, below it bodies are at rest; 0: bodies are not asked
    void advance(const KernelTable<Real>& kernels, long double linear, long double angular, bool is_last,
                 Real nothing = 0) {
        AdvanceBodies<Real> k{};
        k.nothing = nothing;
        k.velocity = velocity.data(), k.start = start(), k.displacement = displacement.data();
        k.turn = turns ? turn.data() : nullptr, k.h = static_cast<Real>(kH), k.is_last = is_last;
        set_flight(k, linear, angular);
        kernels.advance_bodies[(turns ? 1 : 0) + (nothing > 0 ? 2 : 0)](k, 0, length);
    }
    std::size_t end(const KernelTable<Real>& kernels, double largest_position = 1e8,
                    double largest_speed = 1e7) {
        EndSubsteps<Real> k{};
        k.velocity = velocity.data(), k.displacement = displacement.data();
        k.turn = turns ? turn.data() : nullptr;
        k.radius = are_uniform ? nullptr : radius.data(), k.uniform_radius = Real(0.5);
        k.position_x = x.data(), k.position_y = y.data(), k.velocity_x = vx.data(), k.velocity_y = vy.data();
        k.angle = turns ? angle.data() : nullptr, k.angular_velocity = turns ? spin.data() : nullptr;
        k.largest_position = static_cast<Real>(largest_position);
        k.largest_speed = static_cast<Real>(largest_speed);
        k.lost = lost.data();
        return kernels.end_substeps[turns ? 1 : 0](k, 0, length);
    }

    bool is_rest_untouched() {
        for (const Column<Real>* column :
             {&start_x, &start_y, &start_rim, &turn, &radius, &inverse_mass, &x, &y, &vx, &vy, &angle, &spin})
            for (std::size_t row = length; row < column->size(); ++row)
                if ((*column)[row] != kSentinel) return false;
        for (std::size_t i = 4 * length; i < velocity.size(); ++i)
            if (velocity[i] != kSentinel) return false;
        for (std::size_t i = 2 * length; i < displacement.size(); ++i)
            if (displacement[i] != kSentinel) return false;
        return true;
    }
    /// Columns of padding rows, which stay zero if nothing is uniform.
    bool is_padding_zero() {
        for (const Column<Real>* column : {&x, &y, &vx, &vy, &angle, &spin})
            for (std::size_t row = count; row < length; ++row)
                if ((*column)[row] != 0) return false;
        return true;
    }

  private:
    static void fill(Column<Real>& column, std::size_t size, std::size_t zero_until) {
        column.resize(size);
        std::fill(column.data() + zero_until, column.data() + size, kSentinel);
    }
    template <class Arguments>
    static void set_flight(Arguments& k, long double linear, long double angular) {
        const long double decay = std::exp(-linear * kH);
        const long double s = linear > 0 ? (1 - decay) / linear : kH;
        k.gain_x = static_cast<Real>(kGravityX * s), k.gain_y = static_cast<Real>(kGravityY * s);
        k.decay = static_cast<Real>(decay), k.spin_decay = static_cast<Real>(std::exp(-angular * kH));
    }
};

/// One component of free flight at time t under acceleration a and drag k.
struct Flight {
    long double x, v;
};
Flight fly(Flight from, long double a, long double k, long double t) {
    if (k == 0) return {from.x + from.v * t + 0.5L * a * t * t, from.v + a * t};
    const long double u = std::exp(-k * t), s = (1 - u) / k;
    return {from.x + s * from.v + a * (t - s) / k, u * from.v + s * a};
}

/// Calls fn(kernels, rows) for all instruction sets, lengths and kinds of bodies.
template <class Real, class Fn>
void for_each_world(const Fn& fn) {
    for (const KernelTables* tables : runnable_kernel_tables())
        for (const bool turns : {false, true})
            for (const bool uniform : {false, true})
                for (const std::size_t count : {1u, 15u, 16u, 17u, 100u}) {
                    CAPTURE(tables->of<Real>().isa);
                    CAPTURE(turns);
                    CAPTURE(uniform);
                    CAPTURE(count);
                    Rows<Real> rows(count, turns, uniform, static_cast<unsigned>(count));
                    fn(tables->of<Real>(), rows);
                    REQUIRE(rows.is_rest_untouched());
                    if (!uniform) REQUIRE(rows.is_padding_zero());
                }
}

}  // namespace

TEST_SUITE("kernels/advance bodies") {
    TEST_CASE_TEMPLATE("free flight through substeps is exact, but for the bend that drag gives a substep",
                       Real, float, double) {
        constexpr int kSubsteps = 8;
        constexpr long double kAllowed = 60 * std::numeric_limits<Real>::epsilon();
        for (const long double linear : {0.0L, 2.0L})
            for_each_world<Real>([&](const KernelTable<Real>& kernels, Rows<Real>& rows) {
                const Rows<Real> before = rows;
                const long double angular = linear == 0 ? 0 : 5;
                rows.begin(kernels, linear, angular);
                for (int i = 0; i < kSubsteps; ++i)
                    rows.advance(kernels, linear, angular, i + 1 == kSubsteps);
                REQUIRE(rows.end(kernels) == 0);
                const long double t = kSubsteps * kH;
                // The trapezoid's error: h² t / 12 times the second derivative of the velocity, k² v + k g.
                const long double bend = kH * kH * t / 12 * (linear * linear * 4 + linear * 10);
                long double worst = 0, worst_velocity = 0, worst_spin = 0, worst_angle = 0;
                for (std::size_t row = 0; row < rows.count; ++row) {
                    const bool moves = rows.moves(row);
                    const long double k = moves ? linear : 0;
                    const Flight x = fly({before.x[row], before.vx[row]}, moves ? kGravityX : 0, k, t);
                    const Flight y = fly({before.y[row], before.vy[row]}, moves ? kGravityY : 0, k, t);
                    worst = std::max({worst, std::fabs(rows.x[row] - x.x), std::fabs(rows.y[row] - y.x)});
                    worst_velocity = std::max(
                        {worst_velocity, std::fabs(rows.vx[row] - x.v), std::fabs(rows.vy[row] - y.v)});
                    if (!rows.turns) continue;
                    const long double k_spin = moves ? angular : 0;
                    const Flight turn = fly({before.angle[row], before.spin[row]}, 0, k_spin, t);
                    worst_spin = std::max(worst_spin, std::fabs(rows.spin[row] - turn.v));
                    worst_angle = std::max(worst_angle, std::fabs(rows.angle[row] - turn.x));
                }
                CHECK(worst <= kAllowed + bend);
                CHECK(worst_velocity <= kAllowed);
                CHECK(worst_spin <= kAllowed);
                CHECK(worst_angle <= kAllowed + kH * kH * t / 12 * angular * angular * 6);
            });
    }

    TEST_CASE_TEMPLATE("what contacts did to a velocity is foreseen for the next substep", Real, float,
                       double) {
        constexpr long double kAllowed = 30 * std::numeric_limits<Real>::epsilon(), kLinear = 1, kAngular = 2;
        for_each_world<Real>([&](const KernelTable<Real>& kernels, Rows<Real>& rows) {
            const Rows<Real> before = rows;
            rows.begin(kernels, kLinear, kAngular);
            // Contacts push by 0.3 m/s and more, many times what gravity and drag change in a substep.
            const auto push = [](std::size_t row, std::size_t k) {
                return static_cast<Real>(0.3 * static_cast<double>(1 + (row + 1) * (k + 1) % 3));
            };
            for (std::size_t row = 0; row < rows.count; ++row)
                for (std::size_t k = 0; k < 3; ++k)
                    if (rows.moves(row)) rows.velocity[4 * row + k] += push(row, k);
            const Column<Real> solved = rows.velocity;
            rows.advance(kernels, kLinear, kAngular, false);
            long double worst = 0;
            for (std::size_t row = 0; row < rows.count; ++row) {
                const bool moves = rows.moves(row);
                const auto next = [&](std::size_t k, long double a) {
                    const long double now = solved[4 * row + k];
                    return moves ? fly({0, now}, a, kLinear, kH).v + push(row, k) : now;
                };
                const long double expected[] = {next(0, kGravityX), next(1, kGravityY)};
                for (std::size_t k = 0; k < 2; ++k) {
                    worst = std::max(worst, std::fabs(rows.velocity[4 * row + k] - expected[k]));
                    // A velocity that was pushed is that of all the substep.
                    worst =
                        std::max(worst, std::fabs(rows.displacement[2 * row + k] - kH * solved[4 * row + k]));
                }
                if (!rows.turns) continue;
                const long double rim = solved[4 * row + 2];
                const long double spun = moves ? rim * std::exp(-kAngular * kH) + push(row, 2) : rim;
                worst = std::max(worst, std::fabs(rows.velocity[4 * row + 2] - spun));
                worst = std::max(worst, std::fabs(rows.turn[row] - kH * rim));
            }
            CHECK(worst <= kAllowed);
        });
    }

    TEST_CASE_TEMPLATE("what is slower than nothing is at rest, and nothing else changes", Real, float,
                       double) {
        constexpr Real kNothing = Real(0.125);  // m/s
        for (const bool is_last : {false, true})
            for_each_world<Real>([&](const KernelTable<Real>& kernels, Rows<Real>& rows) {
                rows.begin(kernels, 0, 0);
                const std::size_t parts = rows.turns ? 3 : 2;
                // Velocities from zero up, to both sides, some of them just nothing.
                for (std::size_t i = 0; i < rows.count; ++i)
                    for (std::size_t part = 0; part < parts; ++part)
                        rows.velocity[4 * i + part] =
                            kNothing * static_cast<Real>((i + part) % 5) / 4 * (i % 2 == 0 ? 1 : -1);
                Rows<Real> plain = rows;
                std::size_t at_rest = 0;
                for (std::size_t i = 0; i < rows.length; ++i)  // padding has what gravity gives it
                    for (std::size_t part = 0; part < parts; ++part) {
                        Real& v = plain.velocity[4 * i + part];
                        if (std::fabs(v) < kNothing) v = 0, ++at_rest;
                    }
                plain.advance(kernels, 0, 0, is_last);
                rows.advance(kernels, 0, 0, is_last, kNothing);
                REQUIRE(at_rest > 0);
                CHECK(std::equal(plain.velocity.begin(), plain.velocity.end(), rows.velocity.begin()));
                CHECK(std::equal(plain.start_x.begin(), plain.start_x.end(), rows.start_x.begin()));
                CHECK(std::equal(plain.start_y.begin(), plain.start_y.end(), rows.start_y.begin()));
                CHECK(std::equal(plain.displacement.begin(), plain.displacement.end(),
                                 rows.displacement.begin()));
                if (!rows.turns) return;
                CHECK(std::equal(plain.start_rim.begin(), plain.start_rim.end(), rows.start_rim.begin()));
                CHECK(std::equal(plain.turn.begin(), plain.turn.end(), rows.turn.begin()));
            });
    }

    TEST_CASE_TEMPLATE("rows that leave the limits or are not numbers are reported, and held", Real, float,
                       double) {
        constexpr Real kNan = std::numeric_limits<Real>::quiet_NaN(),
                       kInfinite = std::numeric_limits<Real>::infinity();
        for_each_world<Real>([&](const KernelTable<Real>& kernels, Rows<Real>& rows) {
            rows.begin(kernels, 0, 0);
            rows.advance(kernels, 0, 0, true);
            const Rows<Real> before = rows;
            std::vector<std::int32_t> expected;
            for (std::size_t row = 0; row < rows.count; ++row) {
                Real* v = rows.velocity.data() + 4 * row;
                Real* d = rows.displacement.data() + 2 * row;
                switch (row % 9) {
                    case 0:
                        v[0] = kNan;
                        break;
                    case 1:
                        v[1] = -101;
                        break;
                    case 3:
                        d[0] = 1001 + 4;
                        break;
                    case 4:
                        d[1] = kNan;
                        break;
                    case 6:
                        d[1] = -kInfinite;
                        break;
                    case 7:
                        v[0] = kInfinite;
                        break;
                    case 5:
                        if (rows.turns) {
                            (row % 2 == 0 ? v[2] : rows.turn[row]) = row % 4 < 2 ? kNan : kInfinite;
                            break;
                        }
                        [[fallthrough]];
                    default:
                        v[0] = 100, d[0] = 990;
                        continue;  // within the limits
                }
                expected.push_back(static_cast<std::int32_t>(row));
            }
            const std::size_t lost = rows.end(kernels, 1000, 100);
            CHECK(std::vector<std::int32_t>(rows.lost.data(), rows.lost.data() + lost) == expected);
            std::size_t wrong = 0;
            for (const std::int32_t at : expected) {
                const auto row = static_cast<std::size_t>(at);
                wrong += rows.x[row] != before.x[row] || rows.y[row] != before.y[row];
                wrong += rows.vx[row] != 0 || rows.vy[row] != 0;
                if (rows.turns) wrong += rows.spin[row] != 0 || rows.angle[row] != before.angle[row];
            }
            for (std::size_t row = 0; row < rows.count; ++row)
                if (row % 9 == 2 || (row % 9 == 5 && !rows.turns) || row % 9 == 8)
                    wrong += rows.vx[row] != 100 || rows.x[row] != before.x[row] + 990;
            CHECK(wrong == 0);
        });
    }

    TEST_CASE_TEMPLATE("a spin that nothing changes keeps its bits", Real, float, double) {
        for_each_world<Real>([&](const KernelTable<Real>& kernels, Rows<Real>& rows) {
            if (!rows.turns) return;
            const Column<Real> before = rows.spin;
            for (int step = 0; step < 3; ++step) {
                rows.begin(kernels, 0, 0);
                for (int i = 0; i < 4; ++i) rows.advance(kernels, 0, 0, i == 3);
                rows.end(kernels);
            }
            CHECK(std::equal(before.begin(), before.begin() + rows.count, rows.spin.begin()));
        });
    }
}

}  // namespace test_advance_bodies
