#include "isa/select_isa.hpp"
#include "lane_probe.hpp"
#include "state/columns/column.hpp"

#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

extern const LaneProbes kLanesOnScalar, kLanesOnSse2, kLanesOnAvx2, kLanesOnAvx512;

namespace test_lanes {

using carom::Column;

namespace {

std::vector<const LaneProbes*> runnable_lane_probes() {
    std::vector<const LaneProbes*> probes{&kLanesOnScalar};
    for (const carom::KernelTables* tables : carom::runnable_kernel_tables()) {
#if defined(CAROM_BUILT_SSE2)
        if (tables->single_precision.isa == "sse2") probes.push_back(&kLanesOnSse2);
#endif
#if defined(CAROM_BUILT_AVX2)
        if (tables->single_precision.isa == "avx2") probes.push_back(&kLanesOnAvx2);
#endif
#if defined(CAROM_BUILT_AVX512)
        if (tables->single_precision.isa == "avx512") probes.push_back(&kLanesOnAvx512);
#endif
    }
    return probes;
}

template <class Real>
const LaneProbe<Real>& probe_of(const LaneProbes& probes) {
    if constexpr (std::is_same_v<Real, float>)
        return probes.single_precision;
    else
        return probes.double_precision;
}

/// All pairs of numbers that are awkward somewhere, then random ones.
template <class Real>
void fill_operands(Column<Real>& a, Column<Real>& b) {
    using Limits = std::numeric_limits<Real>;
    const std::vector<Real> awkward{0,
                                    -Real{0},
                                    1,
                                    -1,
                                    Real(0.1),
                                    Limits::min(),
                                    Limits::denorm_min(),
                                    -Limits::denorm_min(),
                                    Limits::max(),
                                    Limits::lowest(),
                                    Limits::infinity(),
                                    -Limits::infinity(),
                                    Limits::quiet_NaN(),
                                    3};
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> uniform(-100, 100);
    std::size_t row = 0;
    a.resize(1024);
    b.resize(1024);
    for (const Real x : awkward)
        for (const Real y : awkward) a[row] = x, b[row++] = y;
    for (; row < a.size(); ++row) a[row] = uniform(random), b[row] = uniform(random);
}

template <class T>
bool same_bits(const Column<T>& a, const Column<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

/// Bits of x, but one NaN for all: which of two NaN operands an instruction returns is not ours to say.
template <class Real>
void make_nans_equal(Column<Real>& values) {
    for (Real& value : values)
        if (std::isnan(value)) value = std::numeric_limits<Real>::quiet_NaN();
}

template <class Real>
Real expected_binade(Real x) {
    if (!std::isnormal(x)) return std::copysign(std::isfinite(x) ? Real{0} : INFINITY, x);
    return std::copysign(std::ldexp(Real{1}, std::ilogb(x)), x);
}

template <class Real>
Column<Real> expected_arithmetic(const Column<Real>& a, const Column<Real>& b) {
    const std::size_t count = a.size();
    Column<Real> out(kArithmetic * count);
    for (std::size_t i = 0; i < count; ++i) {
        const Real x = a[i], y = b[i];
        const Real results[kArithmetic] = {x + y,
                                           x - y,
                                           x * y,
                                           x / y,
                                           -x,
                                           std::sqrt(std::fabs(x)),
                                           std::fabs(x),
                                           expected_binade(x),
                                           x < y ? x : y,
                                           x > y ? x : y,
                                           x < y ? x : Real{7},
                                           x + y,
                                           x - y,
                                           x * y};
        for (std::size_t k = 0; k < kArithmetic; ++k) out[k * count + i] = results[k];
    }
    make_nans_equal(out);
    return out;
}

unsigned bits_of(std::size_t lanes, const auto& is_set) {
    unsigned bits = 0;
    for (std::size_t lane = 0; lane < lanes; ++lane) bits |= is_set(lane) ? 1u << lane : 0u;
    return bits;
}

template <class Real>
std::vector<unsigned> expected_comparisons(const Column<Real>& a, const Column<Real>& b, std::size_t lanes) {
    std::vector<unsigned> out;
    for (std::size_t i = 0; i < a.size(); i += lanes) {
        const auto all = bits_of(lanes, [](std::size_t) { return true; });
        const auto less = bits_of(lanes, [&](std::size_t k) { return a[i + k] < b[i + k]; });
        const auto equal = bits_of(lanes, [&](std::size_t k) { return a[i + k] == b[i + k]; });
        const auto greater = bits_of(lanes, [&](std::size_t k) { return a[i + k] > b[i + k]; });
        out.insert(out.end(), {less, less | equal, greater, greater | equal, equal, all & ~less, less | equal,
                               0u, less != 0 ? 1u : 0u, less == all ? 1u : 0u});
    }
    return out;
}

}  // namespace

TEST_SUITE("simd/lanes") {
    TEST_CASE_TEMPLATE("arithmetic gives the scalar operation's bits on every instruction set", Real, float,
                       double) {
        Column<Real> a, b;
        fill_operands(a, b);
        const Column<Real> expected = expected_arithmetic(a, b);
        for (const LaneProbes* probes : runnable_lane_probes()) {
            CAPTURE(probes->isa);
            Column<Real> actual(expected.size());
            probe_of<Real>(*probes).arithmetic(a.data(), b.data(), a.size(), actual.data());
            make_nans_equal(actual);
            CHECK(same_bits(expected, actual));
        }
    }

    TEST_CASE_TEMPLATE("comparisons treat NaN and signed zeros as the scalar ones do", Real, float, double) {
        Column<Real> a, b;
        fill_operands(a, b);
        for (const LaneProbes* probes : runnable_lane_probes()) {
            CAPTURE(probes->isa);
            const LaneProbe<Real>& probe = probe_of<Real>(*probes);
            std::vector<unsigned> actual(kComparisons * (a.size() / probe.lanes));
            probe.comparisons(a.data(), b.data(), a.size(), actual.data());
            CHECK(expected_comparisons(a, b, probe.lanes) == actual);
        }
    }

    TEST_CASE_TEMPLATE("unaligned loads and stores touch their rows and no other", Real, float, double) {
        Column<Real> from, unused;
        fill_operands(from, unused);
        for (const LaneProbes* probes : runnable_lane_probes())
            for (std::size_t shift = 1; shift < 16; ++shift) {
                CAPTURE(probes->isa);
                CAPTURE(shift);
                Column<Real> to(from.size()), expected(from.size());
                std::copy_n(from.data() + shift, 64, expected.data() + 2 * shift);
                probe_of<Real>(*probes).unaligned_copy(from.data() + shift, 64, to.data() + 2 * shift);
                CHECK(same_bits(expected, to));
            }
    }

    TEST_CASE_TEMPLATE("gather reads each lane's own row", Real, float, double) {
        Column<Real> column, unused;
        fill_operands(column, unused);
        std::mt19937 random(5);
        Column<std::int32_t> rows(256);
        for (std::int32_t& row : rows) row = static_cast<std::int32_t>(random() % column.size());
        Column<Real> expected(rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) expected[i] = column[static_cast<std::size_t>(rows[i])];
        for (const LaneProbes* probes : runnable_lane_probes()) {
            CAPTURE(probes->isa);
            Column<Real> actual(rows.size());
            probe_of<Real>(*probes).gather(column.data(), rows.data(), rows.size(), actual.data());
            CHECK(same_bits(expected, actual));
            Column<Real> at(rows.size());
            probe_of<Real>(*probes).gather_at(column.data(), rows.data(), rows.size(), at.data());
            CHECK(same_bits(expected, at));
        }
    }

    TEST_CASE_TEMPLATE("compress_store keeps the marked lanes in order, for every mask", Real, float,
                       double) {
        Column<std::int32_t> values(16);
        for (std::int32_t i = 0; i < 16; ++i) values[static_cast<std::size_t>(i)] = 1000 + 7 * i;
        for (const LaneProbes* probes : runnable_lane_probes()) {
            CAPTURE(probes->isa);
            const LaneProbe<Real>& probe = probe_of<Real>(*probes);
            bool all_equal = true;
            for (unsigned bits = 0; bits < (1u << probe.lanes); ++bits) {
                std::vector<std::int32_t> expected, actual(17, -12345);
                for (std::size_t lane = 0; lane < probe.lanes; ++lane)
                    if ((bits >> lane) & 1u) expected.push_back(values[lane]);
                const std::size_t count = probe.compress(values.data(), bits, actual.data());
                all_equal = all_equal && count == expected.size() && actual[probe.lanes] == -12345 &&
                            std::equal(expected.begin(), expected.end(), actual.begin());
            }
            CHECK(all_equal);
        }
    }

    TEST_CASE_TEMPLATE(
        "compress_store of numbers keeps the bits of the marked lanes in order, for every mask", Real, float,
        double) {
        Column<Real> values(16);
        for (std::size_t i = 0; i < 16; ++i) values[i] = static_cast<Real>(0.1 * static_cast<double>(i) - 1);
        values[5] = Real(-0.0), values[9] = std::numeric_limits<Real>::infinity();
        for (const LaneProbes* probes : runnable_lane_probes()) {
            CAPTURE(probes->isa);
            const LaneProbe<Real>& probe = probe_of<Real>(*probes);
            bool all_equal = true;
            for (unsigned bits = 0; bits < (1u << probe.lanes); ++bits) {
                Column<Real> expected(17), actual(17);
                std::fill(actual.begin(), actual.end(), Real(-12345));
                std::size_t count = 0;
                for (std::size_t lane = 0; lane < probe.lanes; ++lane)
                    if ((bits >> lane) & 1u) expected[count++] = values[lane];
                probe.compress_reals(values.data(), bits, actual.data());
                // A whole batch may be written, and nothing behind it.
                all_equal = all_equal && actual[probe.lanes] == Real(-12345) &&
                            std::memcmp(expected.data(), actual.data(), count * sizeof(Real)) == 0;
            }
            CHECK(all_equal);
        }
    }

    TEST_CASE_TEMPLATE("load_rows2 splits records of two and store_rows2 puts them back", Real, float,
                       double) {
        constexpr std::size_t kRecords = 100, kRows = 64;
        Column<Real> packed(2 * kRecords);
        for (std::size_t i = 0; i < packed.size(); ++i) packed[i] = static_cast<Real>(i) + Real(0.5);
        Column<std::int32_t> rows(kRows);
        for (std::size_t i = 0; i < kRows; ++i) rows[i] = static_cast<std::int32_t>((37 * i) % kRecords);
        Column<Real> expected(2 * kRows), expected_packed(packed.size());
        for (std::size_t i = 0; i < kRows; ++i)
            for (std::size_t k = 0; k < 2; ++k) {
                const std::size_t at = 2 * static_cast<std::size_t>(rows[i]) + k;
                expected[k * kRows + i] = packed[at];
                expected_packed[at] = packed[at];
            }
        for (const LaneProbes* probes : runnable_lane_probes()) {
            CAPTURE(probes->isa);
            Column<Real> actual(expected.size()), actual_packed(packed.size());
            probe_of<Real>(*probes).rows2(packed.data(), rows.data(), kRows, actual.data(),
                                          actual_packed.data());
            CHECK(same_bits(expected, actual));
            CHECK(same_bits(expected_packed, actual_packed));  // rows that were not named stay as they are
        }
    }

    TEST_CASE_TEMPLATE("load_rows4 transposes records and store_rows4 puts them back", Real, float, double) {
        constexpr std::size_t kRecords = 100, kRows = 64;
        Column<Real> packed(4 * kRecords);
        for (std::size_t i = 0; i < packed.size(); ++i) packed[i] = static_cast<Real>(i) + Real(0.5);
        Column<std::int32_t> rows(kRows);
        for (std::size_t i = 0; i < kRows; ++i) rows[i] = static_cast<std::int32_t>((37 * i) % kRecords);
        Column<Real> expected(4 * kRows), expected_packed(packed.size());
        for (std::size_t i = 0; i < kRows; ++i)
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t at = 4 * static_cast<std::size_t>(rows[i]) + k;
                expected[k * kRows + i] = packed[at];
                expected_packed[at] = packed[at];
            }
        for (const LaneProbes* probes : runnable_lane_probes()) {
            CAPTURE(probes->isa);
            Column<Real> actual(expected.size()), actual_packed(packed.size());
            probe_of<Real>(*probes).rows4(packed.data(), rows.data(), kRows, actual.data(),
                                          actual_packed.data());
            CHECK(same_bits(expected, actual));
            CHECK(same_bits(expected_packed, actual_packed));
        }
    }

    TEST_CASE_TEMPLATE("rows that lie in order by fours give the records that rows anywhere give", Real,
                       float, double) {
        constexpr std::size_t kRecords = 400, kRows = 64;
        Column<Real> packed2(2 * kRecords), packed4(4 * kRecords);
        for (std::size_t i = 0; i < packed2.size(); ++i) packed2[i] = static_cast<Real>(i) + Real(0.5);
        for (std::size_t i = 0; i < packed4.size(); ++i) packed4[i] = static_cast<Real>(i) - Real(0.25);
        for (const bool are_pairs : {false, true}) {
            CAPTURE(are_pairs);
            Column<std::int32_t> a(kRows), b(kRows);
            for (std::size_t i = 0; i < kRows; ++i) {
                // Each four lanes elsewhere, out of order, at rows that are no multiples of anything.
                const auto four = static_cast<std::int32_t>(i / 4), lane = static_cast<std::int32_t>(i % 4);
                const std::int32_t first = 7 + 9 * (5 * four % 16);
                a[i] = first + (are_pairs ? 2 * lane : lane), b[i] = are_pairs ? a[i] + 1 : a[i] + 200;
            }
            Column<Real> expected(12 * kRows), expected2(packed2.size()), expected4(packed4.size());
            for (std::size_t i = 0; i < kRows; ++i)
                for (const bool is_b : {false, true}) {
                    const auto row = static_cast<std::size_t>(is_b ? b[i] : a[i]);
                    Real* out = expected.data() + (is_b ? 6 * kRows : 0) + i;
                    for (std::size_t k = 0; k < 2; ++k)
                        out[k * kRows] = expected2[2 * row + k] = packed2[2 * row + k];
                    for (std::size_t k = 0; k < 4; ++k)
                        out[(2 + k) * kRows] = expected4[4 * row + k] = packed4[4 * row + k];
                }
            for (const LaneProbes* probes : runnable_lane_probes()) {
                CAPTURE(probes->isa);
                Column<Real> actual(expected.size()), actual2(packed2.size()), actual4(packed4.size());
                const LaneProbe<Real>& probe = probe_of<Real>(*probes);
                if (!(are_pairs ? probe.pairs : probe.runs)(packed2.data(), packed4.data(), a.data(),
                                                            b.data(), kRows, actual.data(), actual2.data(),
                                                            actual4.data()))
                    continue;
                CHECK(same_bits(expected, actual));
                CHECK(same_bits(expected2, actual2));  // rows that were not named stay as they are
                CHECK(same_bits(expected4, actual4));
            }
        }
    }

    TEST_CASE_TEMPLATE("load_differences4 subtracts record from record", Real, float, double) {
        constexpr std::size_t kRecords = 100, kRows = 64;
        std::mt19937 random(19);
        Column<Real> packed(4 * kRecords), expected(4 * kRows);
        for (Real& value : packed) value = static_cast<Real>(random()) * Real(1e-7);
        Column<std::int32_t> of(kRows), from(kRows);
        for (std::size_t i = 0; i < kRows; ++i) {
            of[i] = static_cast<std::int32_t>(random() % kRecords);
            from[i] = static_cast<std::int32_t>(random() % kRecords);
            for (std::size_t k = 0; k < 4; ++k)
                expected[k * kRows + i] = packed[4 * static_cast<std::size_t>(of[i]) + k] -
                                          packed[4 * static_cast<std::size_t>(from[i]) + k];
        }
        for (const LaneProbes* probes : runnable_lane_probes()) {
            CAPTURE(probes->isa);
            Column<Real> actual(expected.size());
            probe_of<Real>(*probes).differences4(packed.data(), of.data(), from.data(), kRows, actual.data());
            CHECK(same_bits(expected, actual));
        }
    }

    TEST_CASE("floor goes toward minus infinity, whole numbers and negative ones included") {
        Column<float> values(512);
        std::mt19937 random(9);
        std::uniform_real_distribution<float> uniform(-1e6f, 1e6f);
        for (float& value : values) value = uniform(random);
        const float awkward[] = {0.0f, -0.0f, -1.0f, -0.5f, -1e-30f, 0.99999994f, -0.99999994f, 1e9f, -1e9f};
        std::copy(std::begin(awkward), std::end(awkward), values.begin());
        for (const LaneProbes* probes : runnable_lane_probes()) {
            CAPTURE(probes->isa);
            Column<double> floors(values.size());
            Column<std::int32_t> rows(values.size());
            probes->double_precision.floor(values.data(), values.size(), floors.data(), rows.data());
            bool all_equal = true;
            for (std::size_t i = 0; i < values.size(); ++i) {
                const double expected = std::floor(static_cast<double>(values[i]));
                all_equal =
                    all_equal && floors[i] == expected && rows[i] == static_cast<std::int32_t>(expected);
            }
            CHECK(all_equal);
        }
    }

    TEST_CASE("row numbers are subtracted and compared lane by lane, negative ones included") {
        Column<std::int32_t> a(256), b(256), difference(256), min(256), sums(256);
        std::mt19937 random(13);
        for (std::size_t i = 0; i < a.size(); ++i) {
            a[i] = static_cast<std::int32_t>(random() % 2'000'001) - 1'000'000;
            b[i] = static_cast<std::int32_t>(random() % 2'000'001) - 1'000'000;
        }
        for (const LaneProbes* probes : runnable_lane_probes()) {
            CAPTURE(probes->isa);
            for (const auto row_sums :
                 {probes->single_precision.row_sums, probes->double_precision.row_sums}) {
                row_sums(a.data(), b.data(), a.size(), sums.data());
                bool all_sums = true;
                for (std::size_t i = 0; i < a.size(); ++i) all_sums = all_sums && sums[i] == a[i] + b[i];
                CHECK(all_sums);
            }
            probes->rows.rows(a.data(), b.data(), a.size(), difference.data(), min.data());
            bool all_equal = true;
            for (std::size_t i = 0; i < a.size(); ++i)
                all_equal = all_equal && difference[i] == a[i] - b[i] && min[i] == std::min(a[i], b[i]);
            CHECK(all_equal);

            const std::size_t lanes = probes->single_precision.lanes;
            for (std::size_t from = 0; from + 4 * lanes <= a.size(); from += lanes) {
                std::int32_t smallest[4], expected[4];
                probes->rows.smallest4(a.data() + from, smallest);
                for (std::size_t k = 0; k < 4; ++k)
                    expected[k] =
                        *std::min_element(a.data() + from + k * lanes, a.data() + from + (k + 1) * lanes);
                CHECK(std::equal(expected, expected + 4, smallest));
            }
        }
    }

    TEST_CASE("store_marked_pairs writes the pair of every set bit in order, for few bits and for many") {
        Column<std::int32_t> a(16), b(20);
        for (std::size_t i = 0; i < a.size(); ++i) a[i] = static_cast<std::int32_t>(100 + i);
        for (std::size_t i = 0; i < b.size(); ++i) b[i] = static_cast<std::int32_t>(900 - 3 * i);
        std::mt19937_64 random(21);
        for (int trial = 0; trial < 400; ++trial) {
            std::uint64_t word = random();
            for (int thinner = trial % 6; thinner > 0; --thinner) word &= random();
            if (trial == 0) word = 0;
            if (trial == 6) word = ~std::uint64_t{0};
            std::vector<std::int32_t> expected_a, expected_b;
            for (std::size_t bit = 0; bit < 64; ++bit)
                if ((word >> bit) & 1u) {
                    expected_a.push_back(a[bit % 16]);
                    expected_b.push_back(b[bit % 16 + bit / 16]);
                }
            for (const LaneProbes* probes : runnable_lane_probes()) {
                std::vector<std::int32_t> to_a(72, -12345), to_b(72, -12345);
                const std::size_t count =
                    probes->rows.marked_pairs(to_a.data(), to_b.data(), a.data(), b.data(), word);
                CAPTURE(probes->isa);
                CAPTURE(word);
                REQUIRE(count == expected_a.size());
                CHECK(std::equal(expected_a.begin(), expected_a.end(), to_a.begin()));
                CHECK(std::equal(expected_b.begin(), expected_b.end(), to_b.begin()));
                CHECK(to_a.back() == -12345);
                CHECK(to_b.back() == -12345);
            }
        }
    }
}

}  // namespace test_lanes
