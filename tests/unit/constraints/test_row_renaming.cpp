#include "constraints/row_renaming.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace test_row_renaming {

using carom::RowRenaming;

TEST_SUITE("constraints/row renaming") {
    TEST_CASE("rows that were not moved need no new names") {
        RowRenaming trail;
        trail.start(3);
        CHECK_FALSE(trail.has_moved());
    }

    TEST_CASE("a row is found again after sorting, removing and sorting") {
        RowRenaming trail;
        trail.start(4);
        const std::int32_t reversed[] = {3, 2, 1, 0};
        trail.follow_sorted(reversed, 4);  // now 3 2 1 0
        trail.follow_removed(1, 3);        // 2 is gone, 0 takes its place: 3 0 1
        const std::int32_t swapped[] = {1, 0, 2};
        trail.follow_sorted(swapped, 3);  // 0 3 1
        CHECK(trail.has_moved());
        CHECK(trail.new_rows() == std::vector<std::int32_t>{0, 2, RowRenaming::kGone, 1});
        trail.start(3);
        CHECK_FALSE(trail.has_moved());
    }

    TEST_CASE("a row that makes room for another body is found at the end") {
        RowRenaming trail;
        trail.start(4);
        trail.follow_made_room(1, 4);  // 0, a new one, 2, 3, 1
        CHECK(trail.new_rows() == std::vector<std::int32_t>{0, 4, 2, 3});
        trail.follow_removed(0, 4);  // 1, a new one, 2, 3
        CHECK(trail.new_rows() == std::vector<std::int32_t>{RowRenaming::kGone, 0, 2, 3});
    }

    TEST_CASE("rows that were added since belong to none, even when they are sorted among the old ones") {
        RowRenaming trail;
        trail.start(2);
        const std::int32_t order[] = {2, 1, 0};
        trail.follow_sorted(order, 3);
        CHECK(trail.new_rows() == std::vector<std::int32_t>{2, 1});
    }

    TEST_CASE("a world that is emptied and filled again has no old rows") {
        RowRenaming trail;
        trail.start(1);
        trail.follow_removed(0, 0);
        CHECK(trail.has_moved());
        CHECK(trail.new_rows() == std::vector<std::int32_t>{RowRenaming::kGone});
    }
}

}  // namespace test_row_renaming
