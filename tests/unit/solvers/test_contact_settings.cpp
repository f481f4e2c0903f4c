// The lengths by which solver `soft` judges contacts, against bodies that are stepped by hand.
#include "solvers/soft/contacts/contact_settings.hpp"

#include <doctest/doctest.h>

using namespace carom;

TEST_SUITE("solvers/soft/contact_settings") {
    TEST_CASE("a body at rest that gravity brings to another one within the step is in contact with it") {
        for (const int substeps : {1, 2, 4, 32}) {
            CAPTURE(substeps);
            SubstepTerms terms;
            terms.dt = 1.0 / 60;
            terms.substep_dt = terms.dt / substeps;
            terms.gravity_change = terms.substep_dt * Vec2{3, -4};
            double speed = 0, fallen = 0;  // along gravity of 5 m/s², as sweeps see it: velocity first
            for (int substep = 0; substep < substeps; ++substep) {
                speed += 5 * terms.substep_dt;
                fallen += speed * terms.substep_dt;
            }
            ContactSettings settings;
            settings.set_lengths(terms);
            CHECK(settings.contact_distance(0) == doctest::Approx(fallen).epsilon(1e-12));
            CHECK(settings.contact_distance(1) > settings.contact_distance(0));
        }
    }
    TEST_CASE("an overlap is corrected by the same speed whatever the substeps") {
        SubstepTerms terms;
        terms.dt = 0.01, terms.substep_dt = 0.01;
        ContactSettings one, four;
        one.radius = four.radius = 0.5;
        one.set_lengths(terms);
        terms.substep_dt = 0.0025;
        four.set_lengths(terms);
        CHECK(one.largest_correction == doctest::Approx(4 * four.largest_correction).epsilon(1e-12));
    }
}
