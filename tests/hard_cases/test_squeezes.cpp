// B37 of docs/hard-cases.md: what a kinematic body squeezes against what stands is not shot out.
#include "support/hard_case.hpp"

namespace test_squeezes {

using namespace carom;
using namespace carom::test;

TEST_SUITE("hard cases/squeezes") {
    TEST_CASE_TEMPLATE("B37: shapes that a plate squeezes are not shot out", Real, float, double) {
        check_cases<Real>(torture::shapes_under_a_plate(extent_of_draws<Real>()));
    }
    TEST_CASE_TEMPLATE("B37: shapes that are pressed against the walls of a closed room do not leave it",
                       Real, float, double) {
        check_cases<Real>(torture::shapes_in_a_room_that_is_left(extent()));
    }
    TEST_CASE_TEMPLATE("B37: nothing that kinematic bodies and lines press against segments gets through",
                       Real, float, double) {
        check_cases<Real>(torture::rooms_that_many_leave(extent_of_draws<Real>()));
    }
    TEST_CASE_TEMPLATE("B37: discs get no energy from a paddle but its work", Real, float, double) {
        check_cases<Real>(torture::discs_that_a_paddle_stirs(extent_of_draws<Real>()));
    }
    TEST_CASE_TEMPLATE("B37: shapes that a cross stirs are not shot out", Real, float, double) {
        check_cases<Real>(torture::shapes_that_a_cross_stirs(extent_of_draws<Real>()));
    }
    TEST_CASE_TEMPLATE("B37: discs leave a wedge that closes at its limit speed", Real, float, double) {
        check_cases<Real>(torture::discs_in_closing_wedges(extent()));
    }
    TEST_CASE_TEMPLATE("B37: a disc that is thrown into a wedge stays in it", Real, float, double) {
        check_cases<Real>(torture::discs_thrown_into_wedges(extent()));
    }
}

}  // namespace test_squeezes
