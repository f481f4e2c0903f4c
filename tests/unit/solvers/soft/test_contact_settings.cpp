// The lengths by which solver `soft` judges contacts, against bodies that are stepped by hand.
#include "solvers/soft/contacts/contact_settings.hpp"

#include <doctest/doctest.h>

namespace test_contact_settings {

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
            settings.set_lengths(terms, 0);
            CHECK(settings.contact_distance(0) == doctest::Approx(fallen).epsilon(1e-12));
            CHECK(settings.contact_distance(1) > settings.contact_distance(0));
        }
    }
    TEST_CASE("an overlap is corrected by the same speed whatever the substeps") {
        SubstepTerms terms;
        terms.dt = 0.01, terms.substep_dt = 0.01;
        ContactSettings one, four;
        one.radius = four.radius = 0.5;
        one.set_lengths(terms, 0);
        terms.substep_dt = 0.0025;
        four.set_lengths(terms, 0);
        CHECK(one.largest_correction == doctest::Approx(4 * four.largest_correction).epsilon(1e-12));
    }
    TEST_CASE("short substeps close gaps and part overlaps as fast, in time, as those of the usual length") {
        const double longest = 0.02;  // s
        ContactSettings settings;
        SubstepTerms terms;
        const auto pace_at = [&](double length) {
            terms.dt = terms.substep_dt = length * longest;
            settings.set_lengths(terms, longest);
            return settings.pace;
        };
        for (const double length : {0.13001, 0.2, 0.5, 1.0, 30.0}) CHECK(pace_at(length) == 1);
        for (const double length : {0.014, 0.05, 0.1, 0.129}) {
            CAPTURE(length);
            CHECK(pace_at(length) == doctest::Approx(length / 0.13).epsilon(1e-12));
        }
        CHECK(pace_at(1e-6) > 0.05);
        settings.set_lengths(terms, 0);  // no gravity
        CHECK(settings.pace == 1);
    }
    TEST_CASE("long substeps have more sweeps, bounded, and leave none out; asked ones are the least") {
        const double longest = 0.02;  // s
        const auto sweeps_at = [&](int iterations, double length) {
            ContactSettings settings;
            settings.iterations = iterations;
            SubstepTerms terms;
            terms.dt = terms.substep_dt = length * longest;
            settings.set_lengths(terms, longest);
            CHECK(settings.may_leave_out_calm() == (iterations == 2 && length < 0.4));
            return settings.next_sweeps;
        };
        for (const double length : {0.0, 1e-3, 0.2001, 0.399}) CHECK(sweeps_at(2, length) == 1);
        CHECK(sweeps_at(2, 0.401) == 2);
        CHECK(sweeps_at(2, 0.601) == 3);
        CHECK(sweeps_at(2, 0.999) == 4);
        CHECK(sweeps_at(2, 1e6) == 5);  // where there are no more substeps
        for (const double length : {0.1, 0.5, 0.7}) {
            CHECK(sweeps_at(1, length) == 0);
            CHECK(sweeps_at(5, length) == 4);
        }
    }
}

}  // namespace test_contact_settings
