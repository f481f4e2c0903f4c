// What contacts are filed with comes back, whatever their new order: against a map of pairs of rows.
#include "constraints/impulse_memory.hpp"

#include "constraints/rolling_memory.hpp"
#include "math/vec2_math.hpp"
#include "support/effort.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace test_impulse_memory {

using namespace carom;

namespace {

using PairOfRows = std::pair<std::int32_t, std::int32_t>;

template <class Real>
struct Carried {
    Real normal = 0, friction = 0, rolling = 0;
};

/// Contacts in groups, each with two colours, with padding between; the last colour of pairs may be one whose
/// contacts stand apart.
template <class Real>
struct Contacts {
    ContactRows<Real> candidates;
    std::map<PairOfRows, Carried<Real>> carried;

    /// @param pairs_of_group  rows (a, b)
    void lay_out(const std::vector<std::vector<PairOfRows>>& pairs_of_group, std::int32_t dummy,
                 bool has_overflow, std::mt19937& random) {
        ContactRows<Real>& c = candidates;
        c = {};
        c.has_overflow = has_overflow, c.overflow_stride = has_overflow ? kRowPadding : 1;
        for (const auto& pairs : pairs_of_group) {
            c.first_colour.push_back(c.begin.size());
            const std::size_t half = pairs.size() / 2;
            add_colour(pairs, 0, half, 1, dummy, random);
            const bool is_last = &pairs == &pairs_of_group.back();
            add_colour(pairs, half, pairs.size(), has_overflow && is_last ? kRowPadding : 1, dummy, random);
        }
        c.first_colour.push_back(c.begin.size());
    }

    /// Rows that are gone are forgotten; the others have new numbers.
    void rename(const std::vector<std::int32_t>& new_rows, bool are_pairs) {
        std::map<PairOfRows, Carried<Real>> renamed;
        const auto row = [&](std::int32_t old) {
            return old < 0 ? old : new_rows[static_cast<std::size_t>(old)];
        };
        for (const auto& [pair, of_pair] : carried) {
            PairOfRows now{row(pair.first), row(pair.second)};
            if (are_pairs && now.first > now.second) std::swap(now.first, now.second);
            renamed[now] = of_pair;
        }
        carried = renamed;
        candidates.for_each([&](std::size_t i) {
            std::int32_t &a = candidates.a[i], &b = candidates.b[i];
            a = row(a), b = row(b);
            if (are_pairs && a > b) std::swap(a, b);
        });
    }

  private:
    void add_colour(const std::vector<PairOfRows>& pairs, std::size_t first, std::size_t last,
                    std::size_t stride, std::int32_t dummy, std::mt19937& random) {
        ContactRows<Real>& c = candidates;
        c.begin.push_back(c.a.size()), c.count.push_back(last - first);
        std::size_t at = c.a.size();
        const std::size_t end = at + padded((last - first) * stride);
        c.a.resize(end), c.b.resize(end), c.normal_impulse.resize(end), c.friction_impulse.resize(end);
        c.rolling_impulse.resize(end);
        std::fill(c.a.data() + at, c.a.data() + end, dummy),
            std::fill(c.b.data() + at, c.b.data() + end, dummy);
        for (std::size_t i = first; i < last; ++i, at += stride) {
            c.a[at] = pairs[i].first, c.b[at] = pairs[i].second;
            if (random() % 3 == 0) continue;  // carries nothing
            const auto draw = [&] { return static_cast<Real>(random() % 1000 + 1); };
            c.normal_impulse[at] = draw(), c.friction_impulse[at] = -draw(), c.rolling_impulse[at] = draw();
            carried[pairs[i]] = {c.normal_impulse[at], c.friction_impulse[at], c.rolling_impulse[at]};
        }
    }
};

constexpr std::int32_t kRows = 700;
constexpr std::int32_t kImmovable = 60;  // the first rows: nothing moves them, so they are in no pair

std::int32_t movable_row(std::mt19937& random) {
    return kImmovable + static_cast<std::int32_t>(random() % (kRows - kImmovable));
}

/// Pairs a < b, most of them near each other, some across the world.
std::vector<PairOfRows> some_pairs(std::size_t count, std::mt19937& random) {
    std::set<PairOfRows> pairs;
    while (pairs.size() < count) {
        const std::int32_t a = movable_row(random);
        const auto way = static_cast<std::int32_t>(1 + random() % (random() % 20 == 0 ? kRows : 30));
        if (a + way < kRows) pairs.insert({a, a + way});
    }
    std::vector<PairOfRows> list(pairs.begin(), pairs.end());
    std::shuffle(list.begin(), list.end(), random);
    return list;
}

std::vector<PairOfRows> some_supports(std::size_t count, std::mt19937& random) {
    std::set<PairOfRows> supports;
    while (supports.size() < count)
        // Walls and edges.
        supports.insert({movable_row(random), static_cast<std::int32_t>(random() % 9) - 8});
    for (std::int32_t row = 0; row < kImmovable; ++row) supports.insert({movable_row(random), row});
    return {supports.begin(), supports.end()};
}

std::vector<std::vector<PairOfRows>> in_groups(const std::vector<PairOfRows>& pairs,
                                               const TaskGroups& groups) {
    std::vector<std::vector<PairOfRows>> of_group(groups.count());
    for (const PairOfRows& pair : pairs) of_group[groups.group_of(pair.first, pair.second)].push_back(pair);
    return of_group;
}

/// Pairs that were never contacts, and those that were, on both sides.
template <class Real>
void check_recalled(const ImpulseMemory<Real>& memory, const Contacts<Real>& pairs,
                    const Contacts<Real>& supports, std::int32_t rows) {
    std::size_t wrong = 0, found = 0;
    const auto expect = [&](const auto& impulses, const Contacts<Real>& contacts, PairOfRows pair) {
        const auto at = contacts.carried.find(pair);
        const Carried<Real> expected = at == contacts.carried.end() ? Carried<Real>{} : at->second;
        wrong += impulses.normal != expected.normal || impulses.friction != expected.friction;
        found += expected.normal > 0;
    };
    for (std::int32_t a = 0; a < rows; ++a) {
        for (std::int32_t b = a + 1; b < rows; ++b) expect(memory.recall_pair(a, b), pairs, {a, b});
        for (std::int32_t b = -9; b < kImmovable; ++b)
            if (pairs.carried.count({a, b}) == 0) expect(memory.recall_support(a, b), supports, {a, b});
    }
    CHECK(wrong == 0);
    CHECK(found > 500);
}

}  // namespace

TEST_SUITE("constraints/impulse memory") {
    TEST_CASE_TEMPLATE("pairs and supports are remembered by their rows, in groups of any number of threads",
                       Real, float, double) {
        for (const int threads : {1, 3})
            for (const bool has_overflow : {false, true}) {
                if (test::is_effort_reduced() && has_overflow != (threads > 1)) continue;
                std::mt19937 random(3);
                const TaskGroups groups(128, (kRows + 127) / 128);
                Contacts<Real> pairs, supports;
                pairs.lay_out(in_groups(some_pairs(2000, random), groups), kRows + 1, has_overflow, random);
                supports.lay_out({some_supports(400, random)}, kRows + 2, false, random);
                ImpulseMemory<Real> memory;
                const Executor executor(threads);
                memory.file(pairs.candidates, supports.candidates, kRows, &groups, executor);
                check_recalled(memory, pairs, supports, kRows);
                // Again, in what the first filing has left.
                pairs.carried.clear();
                pairs.lay_out(in_groups(some_pairs(1500, random), groups), kRows + 1, has_overflow, random);
                memory.file(pairs.candidates, supports.candidates, kRows, &groups, executor);
                check_recalled(memory, pairs, supports, kRows);
            }
    }

    TEST_CASE_TEMPLATE("rows appended since the grouping have nothing to remember", Real, float, double) {
        std::mt19937 random(4);
        const TaskGroups groups(128, (kRows + 127) / 128);
        Contacts<Real> pairs, supports;
        pairs.lay_out(in_groups(some_pairs(2000, random), groups), kRows + 1, false, random);
        supports.lay_out({some_supports(400, random)}, kRows + 2, false, random);
        ImpulseMemory<Real> memory;
        memory.file(pairs.candidates, supports.candidates, kRows + 300, &groups, Executor(1));
        check_recalled(memory, pairs, supports, kRows + 300);
    }

    TEST_CASE_TEMPLATE("contacts whose rows have new names are remembered by these", Real, float, double) {
        std::mt19937 random(6);
        const TaskGroups groups(128, (kRows + 127) / 128);
        Contacts<Real> pairs, supports;
        pairs.lay_out(in_groups(some_pairs(2000, random), groups), kRows + 1, true, random);
        supports.lay_out({some_supports(400, random)}, kRows + 2, false, random);
        std::vector<std::int32_t> new_rows(kRows);
        for (std::int32_t row = 0; row < kRows; ++row) new_rows[static_cast<std::size_t>(row)] = row;
        // Bodies that nothing moves keep their rows, so that no support becomes a pair.
        std::shuffle(new_rows.begin() + kImmovable, new_rows.end(), random);
        pairs.rename(new_rows, true), supports.rename(new_rows, false);
        ImpulseMemory<Real> memory;
        memory.file(pairs.candidates, supports.candidates, kRows, nullptr, Executor(1));
        check_recalled(memory, pairs, supports, kRows);
    }

    TEST_CASE_TEMPLATE("rolling impulses find their contacts in a new order", Real, float, double) {
        std::mt19937 random(8);
        const TaskGroups groups(128, (kRows + 127) / 128);
        Contacts<Real> before, after;
        const std::vector<PairOfRows> pairs = some_pairs(2500, random);
        before.lay_out(in_groups({pairs.begin(), pairs.begin() + 2000}, groups), kRows + 1, true, random);
        RollingMemory<Real> memory;
        memory.file(before.candidates, kRows);
        // Some pairs are gone, some are new, the groups are others.
        std::vector<PairOfRows> later(pairs.begin() + 500, pairs.end());
        std::shuffle(later.begin(), later.end(), random);
        after.lay_out({later}, kRows + 1, false, random);
        memory.recall(after.candidates);
        std::size_t wrong = 0, kept = 0;
        for (std::size_t i = 0; i < after.candidates.a.size(); ++i) {
            const auto found = before.carried.find({after.candidates.a[i], after.candidates.b[i]});
            const Real expected = found == before.carried.end() ? Real(0) : found->second.rolling;
            wrong += after.candidates.rolling_impulse[i] != expected;
            kept += expected != 0;
        }
        CHECK(wrong == 0);
        CHECK(kept > 800);
    }
}

}  // namespace test_impulse_memory
