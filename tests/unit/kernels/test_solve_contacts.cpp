// Sweeps over contacts that share no body, each against the contact's laws in long double.
#include "isa/select_isa.hpp"
#include "unit/kernels/contact_bench.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace test_solve_contacts {

using namespace carom;
using namespace carom::test;

namespace {

/// Velocities are of order 1 m/s and inverse masses up to 3 / kg: a few roundings of the largest sum.
template <class Real>
constexpr long double kAllowed = 60 * std::numeric_limits<Real>::epsilon();

/// Calls fn(kernels, bench) for all instruction sets, variants, lengths and ways to tell the kernels.
template <class Real, class Fn>
void for_each_bench(bool is_support, const Fn& fn) {
    unsigned seed = 0;
    for (const KernelTables* tables : runnable_kernel_tables())
        for (std::size_t variant = 0; variant < 5; ++variant)
            for (const bool is_uniform : {false, true})
                for (const std::size_t count : {1u, 2u, 8u, 9u, 15u, 16u, 17u, 500u}) {
                    const KernelTable<Real>& table = tables->of<Real>();
                    CAPTURE(table.isa);
                    CAPTURE(variant);
                    CAPTURE(is_uniform);
                    CAPTURE(count);
                    ContactBench<Real> bench({variant, is_support, is_uniform}, count, ++seed);
                    fn(table.contacts[variant], bench);
                    REQUIRE(bench.is_rest_untouched());
                }
}

/// Largest difference of impulses and velocities from the reference.
template <class Real>
long double error_of(const ContactBench<Real>& bench, std::size_t i) {
    const DiscContact& c = bench.expected[i];
    const std::size_t at = bench.kFirst + i;
    long double worst = std::fabs(bench.along[at] - c.along);
    if (bench.kind.is_rough()) worst = std::max(worst, std::fabs(bench.tangent[at] - c.tangent));
    if (bench.kind.rolls()) worst = std::max(worst, std::fabs(bench.roll[at] - c.roll));
    for (const std::size_t disc : {2 * i, 2 * i + 1})
        if (bench.moves(disc)) worst = std::max(worst, bench.velocity_error(disc));
    return worst;
}

template <class Real>
void check_errors(const ContactBench<Real>& bench) {
    long double worst = 0;
    for (std::size_t i = 0; i < bench.count; ++i) worst = std::max(worst, error_of(bench, i));
    CHECK(worst <= kAllowed<Real>);
}

template <class Real>
void check_warm_start(bool is_support) {
    for_each_bench<Real>(is_support, [&](const ContactKernels<Real>& kernels, ContactBench<Real>& bench) {
        const SolveContacts<Real> k = bench.arguments();
        (is_support ? kernels.warm_start_supports : kernels.warm_start_pairs)(k, bench.kFirst, bench.end);
        for (DiscContact& c : bench.expected) c.apply_all();
        check_errors(bench);
    });
}

/// Later sweeps: no over-relaxation, no displacement.
template <class Real>
void check_next_sweep(bool is_support) {
    for_each_bench<Real>(is_support, [&](const ContactKernels<Real>& kernels, ContactBench<Real>& bench) {
        SolveContacts<Real> k = bench.arguments();
        k.calm = Real(0.1), k.over_relaxation = Real(1.9), k.calm_over_relaxation = Real(1.8);
        (is_support ? kernels.next_supports : kernels.next_pairs)(k, bench.kFirst, bench.end);
        for (DiscContact& c : bench.expected) c.solve_normal(), c.solve_rolling(), c.solve_friction();
        check_errors(bench);
        for (std::size_t disc = 0; disc < 2 * bench.count; ++disc) {
            const Real* moved = bench.displacement.data() + 2 * bench.row_of[disc];
            const bool is_still = !bench.moves(disc) || (moved[0] == bench.discs[disc].moved.x &&
                                                         moved[1] == bench.discs[disc].moved.y);
            CHECK(is_still);
        }
    });
}

constexpr long double kCalm = 0.3L, kOverRelaxation = 1.6L, kCalmOverRelaxation = 1.25L;

/// What the first sweep of a substep is to do with contact i. @return whether it is calm; `is_clear`: that
/// this is not a matter of round-off
template <class Real>
bool sweep_first(ContactBench<Real>& bench, std::size_t i, bool& is_clear) {
    DiscContact& c = bench.expected[i];
    const long double now = bench.separation_now(i), inverse = c.inverse_mass_along(c.normal);
    c.floor = std::min(-now / bench.kH, 0.0L);
    // Overlap is taken away by displacement, each disc by its inverse mass.
    const long double push = std::min(0.4L * std::max(-now, 0.0L), 0.003L + bench.kH * c.along * inverse);
    c.a->moved = c.a->moved - push * c.a->inverse_mass / inverse * c.normal;
    c.b->moved = c.b->moved + push * c.b->inverse_mass / inverse * c.normal;
    const long double wanted = std::fabs(c.floor - c.normal_velocity());
    const bool goes_far = wanted > kCalm;
    const long double added = c.solve_normal(bench.kind.is_support ? 1
                                             : goes_far            ? kOverRelaxation
                                                                   : kCalmOverRelaxation);
    c.solve_rolling();
    const long double change = std::max(std::fabs(added), std::fabs(c.solve_friction())) * inverse;
    is_clear = std::fabs(wanted - kCalm) > 1e-3L && std::fabs(change - kCalm) > 1e-3L;
    return change <= kCalm;
}

template <class Real>
void check_first_sweep(bool is_support) {
    for_each_bench<Real>(is_support, [&](const ContactKernels<Real>& kernels, ContactBench<Real>& bench) {
        SolveContacts<Real> k = bench.arguments();
        k.calm = static_cast<Real>(kCalm), k.over_relaxation = static_cast<Real>(kOverRelaxation);
        k.calm_over_relaxation = static_cast<Real>(kCalmOverRelaxation);
        (is_support ? kernels.first_supports : kernels.first_pairs)(k, bench.kFirst, bench.end);
        long double worst = 0, worst_floor = 0, worst_moved = 0;
        std::vector<int> restless(bench.needs_second_sweep.size(), 0), unclear(restless);
        for (std::size_t i = 0; i < bench.count; ++i) {
            bool is_clear = true;
            const std::size_t block = (bench.kFirst + i) / kContactBlock;
            const bool is_calm = sweep_first(bench, i, is_clear);
            if (!is_clear) {
                ++unclear[block];
                continue;
            }
            restless[block] += !is_calm;
            worst = std::max(worst, error_of(bench, i));
            worst_floor =
                std::max(worst_floor, std::fabs(bench.floor[bench.kFirst + i] - bench.expected[i].floor));
            for (const std::size_t disc : {2 * i, 2 * i + 1}) {
                if (!bench.moves(disc)) continue;
                const Real* moved = bench.displacement.data() + 2 * bench.row_of[disc];
                const Vector d = bench.discs[disc].moved;
                worst_moved = std::max({worst_moved, std::fabs(moved[0] - d.x), std::fabs(moved[1] - d.y)});
            }
        }
        // Floors are a separation over 4 ms.
        CHECK(worst <= 10 * kAllowed<Real>);
        CHECK(worst_floor <= 10 * kAllowed<Real>);
        CHECK(worst_moved <= 0.05L * kAllowed<Real>);
        if (is_support) return;  // these are few: all are solved twice
        for (std::size_t block = 1; block < bench.last / kContactBlock; ++block)
            if (restless[block] > 0 || unclear[block] == 0)
                CHECK(static_cast<int>(bench.needs_second_sweep[block]) == (restless[block] > 0 ? 1 : 0));
    });
}

/// Momentum, and angular momentum about the origin, of the two discs of contact i, of which a is there.
template <class Real>
Vector momentum_of(const ContactBench<Real>& bench, std::size_t i, long double& angular) {
    const DiscContact& c = bench.expected[i];
    const Vector places[] = {{1, 2}, Vector{1, 2} + (c.a->radius + c.b->radius) * c.normal};
    Vector sum;
    angular = 0;
    for (const std::size_t k : {0u, 1u}) {
        const RigidDisc& d = bench.discs[2 * i + k];
        const Real* v = bench.record(2 * i + k);
        const Vector p = 1 / d.inverse_mass * Vector{v[0], v[1]};
        const long double inertia = d.radius * d.radius / (2 * d.inverse_mass);
        sum = sum + p;
        angular += cross(places[k], p) + inertia * v[2] / d.radius;
    }
    return sum;
}

}  // namespace

TEST_SUITE("kernels/solve contacts") {
    TEST_CASE_TEMPLATE("a warm start gives each body its contacts' impulses", Real, float, double) {
        check_warm_start<Real>(false), check_warm_start<Real>(true);
    }

    TEST_CASE_TEMPLATE("a sweep solves a contact alone: the normal law, then rolling, then friction", Real,
                       float, double) {
        check_next_sweep<Real>(false), check_next_sweep<Real>(true);
    }

    TEST_CASE_TEMPLATE("the first sweep takes overlaps away, lets bodies meet, and over-relaxes pairs", Real,
                       float, double) {
        check_first_sweep<Real>(false), check_first_sweep<Real>(true);
    }

    TEST_CASE_TEMPLATE("a pair's momentum and angular momentum are kept", Real, float, double) {
        for (const KernelTables* tables : runnable_kernel_tables())
            for (const std::size_t variant : {0u, 1u, 3u}) {
                ContactBench<Real> bench({variant, false, false}, 200, 7);
                std::vector<Vector> before(bench.count);
                std::vector<long double> angular_before(bench.count);
                for (std::size_t i = 0; i < bench.count; ++i)
                    before[i] = momentum_of(bench, i, angular_before[i]);
                const SolveContacts<Real> k = bench.arguments();
                const ContactKernels<Real>& kernels = tables->of<Real>().contacts[variant];
                kernels.first_pairs(k, bench.kFirst, bench.end);
                for (int sweep = 0; sweep < 10; ++sweep) kernels.next_pairs(k, bench.kFirst, bench.end);
                long double worst = 0;
                for (std::size_t i = 0; i < bench.count; ++i) {
                    long double angular = 0;
                    const Vector after = momentum_of(bench, i, angular);
                    worst =
                        std::max({worst, std::fabs(after.x - before[i].x), std::fabs(after.y - before[i].y),
                                  std::fabs(angular - angular_before[i])});
                }
                CHECK(worst <= 20 * kAllowed<Real>);
            }
    }

    TEST_CASE_TEMPLATE("sweeps repeated satisfy all laws of a contact at once", Real, float, double) {
        for (const KernelTables* tables : runnable_kernel_tables())
            for (const bool is_support : {false, true})
                for (std::size_t variant = 0; variant < 5; ++variant) {
                    ContactBench<Real> bench({variant, is_support, false}, 100, 3);
                    const SolveContacts<Real> k = bench.arguments();
                    const ContactKernels<Real>& kernels = tables->of<Real>().contacts[variant];
                    for (int sweep = 0; sweep < 300; ++sweep)
                        (is_support ? kernels.next_supports : kernels.next_pairs)(k, bench.kFirst, bench.end);
                    int pushing = 0, sliding = 0, rolling = 0;
                    long double worst = 0;
                    for (std::size_t i = 0; i < bench.count; ++i) {
                        DiscContact& c = bench.expected[i];
                        for (const std::size_t d : {2 * i, 2 * i + 1}) {
                            if (!bench.moves(d)) continue;
                            const Real* v = bench.record(d);
                            bench.discs[d].velocity = {v[0], v[1]};
                            bench.discs[d].spin = v[2] / bench.discs[d].radius;
                        }
                        c.along = bench.along[bench.kFirst + i];
                        if (bench.kind.is_rough()) c.tangent = bench.tangent[bench.kFirst + i];
                        if (bench.kind.rolls()) c.roll = bench.roll[bench.kFirst + i];
                        worst = std::max(worst, c.violation());
                        pushing += c.along > 0;
                        sliding += c.along > 0 && std::fabs(c.tangent_velocity()) > 1e-3L;
                        rolling += c.along > 0 && std::fabs(c.rolling_velocity()) > 1e-3L;
                    }
                    CHECK(worst <= 10 * kAllowed<Real>);
                    CHECK(pushing > 20);
                    CHECK(pushing < 90);
                    if (bench.kind.is_rough()) CHECK(sliding > 5);
                    if (bench.kind.rolls()) CHECK(rolling > 5);
                }
    }
}

}  // namespace test_solve_contacts
