// B43 of docs/hard-cases.md: bodies that are thrown, within a step, at what they had no contact with.
#include "support/hard_case.hpp"

using namespace carom;
using namespace carom::test;

TEST_SUITE("hard cases/tunnelling") {
    TEST_CASE_TEMPLATE("B43: no body that is thrown at a plate within a step passes it", Real, float,
                       double) {
        check_cases<Real>(torture::shots_at_plates(extent()));
    }
    TEST_CASE_TEMPLATE("B43: shapes that a drum throws about do not leave it", Real, float, double) {
        check_cases<Real>(torture::shapes_in_a_drum(extent()));
    }
    TEST_CASE_TEMPLATE("B43: what a fast drum carries lies on it", Real, float, double) {
        check_cases<Real>(torture::bodies_in_a_fast_drum(extent()));
    }
}
