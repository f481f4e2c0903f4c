// Rows that change while the grid stays: names and loose rows are those that a list of bodies by hand says.
#include "broadphase/row_names.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

namespace test_row_names {

using namespace carom;

namespace {

using Rows = std::vector<std::int32_t>;

constexpr int kLoose = -1;

/// A body of the list by hand: a number of its own, and the row it had when the grid was built.
struct Listed {
    int number, name;
};

/// Bodies that come, go as the last takes their place, change places or are put elsewhere, and the names that
/// follow.
struct Edits {
    std::vector<Listed> bodies;
    RowNames names;
    Column<int> column;  // of each row the number of its body
    std::set<int> fresh;
    int next = 0;
    std::mt19937 random{7};

    explicit Edits(int count) {
        for (; next < count; ++next) bodies.push_back({next, next});
        column.resize(bodies.size());
        for (std::size_t row = 0; row < bodies.size(); ++row) column[row] = bodies[row].number;
    }
    std::size_t any() { return random() % bodies.size(); }

    /// @return whether the count of former rows without a body that stayed is right.
    bool edit() {
        const std::vector<Listed> before = bodies;
        std::set<int> elsewhere;
        for (int i = 0; i < 2; ++i) {
            bodies[any()] = bodies.back();
            bodies.pop_back();
        }
        for (int i = 0; i < 3; ++i) bodies.push_back({next++, kLoose});
        std::swap(bodies[any()], bodies[any()]);
        if (Listed& put = bodies[any()]; put.number < next - 3) {
            put.name = kLoose;
            elsewhere.insert(put.number);
        }
        Rows now(before.size(), -1);
        std::vector<std::uint8_t> is_elsewhere(bodies.size(), 0);
        std::size_t stayed = 0;
        fresh.clear();
        for (std::size_t row = 0; row < bodies.size(); ++row) {
            is_elsewhere[row] = elsewhere.count(bodies[row].number) > 0;
            const auto old = std::find_if(before.begin(), before.end(), [&](const Listed& body) {
                return body.number == bodies[row].number;
            });
            if (old != before.end())
                now[static_cast<std::size_t>(old - before.begin())] = static_cast<std::int32_t>(row);
            const bool stays = old != before.end() && !is_elsewhere[row];
            stayed += stays;
            if (!stays) fresh.insert(static_cast<int>(row));
        }
        const std::size_t gone = names.follow(bodies.size(), now, is_elsewhere);
        names.move(column, [&](std::size_t row) { return bodies[row].number; });
        return gone == before.size() - stayed;
    }
    Rows rows_where(bool are_loose) const {
        Rows rows;
        for (std::size_t row = 0; row < bodies.size(); ++row)
            if ((bodies[row].name == kLoose) == are_loose) rows.push_back(static_cast<std::int32_t>(row));
        return rows;
    }
};

}  // namespace

TEST_SUITE("broadphase/row names") {
    TEST_CASE("through edits of all kinds, names, loose rows and columns are those of the bodies") {
        constexpr int kCount = 40;
        Edits edits(kCount);
        RowNames& names = edits.names;
        CHECK(names.empty());
        for (int round = 0; round < 12; ++round) {
            CAPTURE(round);
            CHECK(edits.edit());
            REQUIRE_FALSE(names.empty());
            const Rows loose = edits.rows_where(true), named = edits.rows_where(false);
            CHECK(names.loose_count() == loose.size());
            REQUIRE(edits.column.size() == edits.bodies.size());
            for (std::size_t row = 0; row < edits.bodies.size(); ++row) {
                CHECK(edits.column[row] == edits.bodies[row].number);
                CHECK(names.is_loose(row) == (edits.bodies[row].name == kLoose));
                if (!names.is_loose(row))
                    CHECK(names.name_of(row) == static_cast<std::size_t>(edits.bodies[row].name));
            }

            Rows all(kCount);
            std::iota(all.begin(), all.end(), 0);
            std::reverse(all.begin(), all.end());
            names.sort(all, edits.bodies.size());
            Rows expected = named;
            std::sort(expected.begin(), expected.end(), [&](std::int32_t a, std::int32_t b) {
                return edits.bodies[static_cast<std::size_t>(a)].name >
                       edits.bodies[static_cast<std::size_t>(b)].name;
            });
            expected.insert(expected.end(), loose.begin(), loose.end());
            CHECK(names.sorted_rows() == expected);

            Column<std::int32_t> found;
            found.resize(kCount);
            std::copy(all.begin(), all.end(), found.begin());
            const std::size_t count = names.to_rows(found, kCount);
            Rows rows(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count));
            std::sort(rows.begin(), rows.end());
            Rows every(edits.bodies.size());
            std::iota(every.begin(), every.end(), 0);
            CHECK(rows == every);
            found[0] = edits.bodies[static_cast<std::size_t>(named[0])].name;
            const std::size_t few = names.to_rows(found, 1);
            CHECK(few == 1 + loose.size());
            CHECK(found[0] == named[0]);

            CHECK(names.fresh_count() == edits.fresh.size());
            Rows strays{named[0], named[1]};
            std::set<int> strayed(edits.fresh);
            strayed.insert(strays.begin(), strays.end());
            names.take_fresh(strays);
            CHECK(strays == Rows(strayed.begin(), strayed.end()));
            CHECK(names.fresh_count() == 0);
        }
        names.forget();
        CHECK(names.empty());
        CHECK(names.loose_count() == 0);
        CHECK_FALSE(names.is_loose(3));
        CHECK(names.name_of(3) == 3);
    }
}

}  // namespace test_row_names
