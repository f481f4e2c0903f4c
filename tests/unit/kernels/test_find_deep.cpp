// Pairs that would be deep in each other behind a substep, or are pushed apart, against long double.
#include "isa/select_isa.hpp"
#include "unit/kernels/contact_bench.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace test_find_deep {

using namespace carom;
using namespace carom::test;

namespace {

// Velocities of a bench are of order 1 m/s, its substep is 4 ms, separations are within 2 cm.
constexpr long double kCloses = 0.0012L, kDeep = 0.022L, kClear = 1e-5L;  // m

enum class Is { no, parted, deep, unclear };

/// Whether contact i closes by more than kCloses in a substep, and overlaps by more than kDeep behind it; or
/// what it alone would take from its impulse parts it by more than three times kCloses.
/// @param unit  of all these
template <class Real>
Is state_of(const ContactBench<Real>& bench, std::size_t i, long double unit) {
    const DiscContact& c = bench.expected[i];
    const long double velocity = dot(c.b->velocity - c.a->velocity, c.normal),
                      by = (c.floor - velocity) * bench.kH - unit * kCloses,
                      depth = -(bench.separation_now(i) + velocity * bench.kH) - unit * kDeep;
    const long double parted =
        std::min(c.along * (c.a->inverse_mass + c.b->inverse_mass), velocity - c.floor) * bench.kH -
        3 * unit * kCloses;
    if (parted > kClear) return Is::parted;
    if (by > kClear && depth > kClear) return Is::deep;
    return parted < -kClear && (by < -kClear || depth < -kClear) ? Is::no : Is::unclear;
}

}  // namespace

TEST_SUITE("kernels/find deep") {
    TEST_CASE_TEMPLATE("pairs that close and then overlap by more than they may are found, block by block",
                       Real, float, double) {
        for (const KernelTables* tables : runnable_kernel_tables())
            for (const bool has_column : {false, true})
                for (const std::size_t count : {1u, 2u, 9u, 16u, 17u, 500u}) {
                    const KernelTable<Real>& table = tables->of<Real>();
                    CAPTURE(table.isa);
                    CAPTURE(has_column);
                    CAPTURE(count);
                    ContactBench<Real> bench({1, false, false}, count, static_cast<unsigned>(count));
                    // Units by contact are twice the smaller radius: another number than one for all.
                    Column<Real> smaller(bench.last + kContactBlock);
                    const auto unit_of = [&](std::size_t i) -> long double {
                        if (!has_column) return 1;
                        return 2 * std::min(bench.discs[2 * i].radius, bench.discs[2 * i + 1].radius);
                    };
                    for (std::size_t i = 0; i < count; ++i)
                        smaller[bench.kFirst + i] = static_cast<Real>(unit_of(i));
                    SolveContacts<Real> k = bench.arguments();
                    const DeepPairs<Real> what{static_cast<Real>(kCloses), static_cast<Real>(kDeep)};
                    if (has_column) k.contacts.smaller = smaller.data();
                    int deep_blocks = 0, parted_blocks = 0, clear_blocks = 0;
                    for (std::size_t first = bench.kFirst; first < bench.last; first += kContactBlock) {
                        bool is_deep = false, is_parted = false, is_unclear = false;
                        const std::size_t end = std::min(first + kContactBlock, bench.kFirst + count);
                        for (std::size_t i = first - bench.kFirst; i < end - bench.kFirst; ++i) {
                            const Is state = state_of(bench, i, unit_of(i));
                            is_deep |= state == Is::deep, is_parted |= state == Is::parted;
                            is_unclear |= state == Is::unclear;
                        }
                        const bool is_found = is_deep || is_parted;
                        if (is_unclear && !is_found) continue;
                        const std::size_t last = std::min(first + kContactBlock, bench.end);
                        CHECK(table.find_deep(k, what, first, last) == is_found);
                        deep_blocks += is_deep && !is_parted, parted_blocks += is_parted && !is_deep;
                        clear_blocks += !is_found;
                    }
                    if (count == 500u) CHECK(std::min({deep_blocks, parted_blocks, clear_blocks}) > 0);
                    REQUIRE(bench.is_rest_untouched());
                }
    }
}

}  // namespace test_find_deep
