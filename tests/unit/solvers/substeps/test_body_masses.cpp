#include "solvers/substeps/body_masses.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace test_body_masses {

using namespace carom;

namespace {

template <class Real>
Bodies<Real> bodies_of(const std::vector<double>& masses) {
    Bodies<Real> bodies;
    bodies.resize(masses.size());
    for (std::size_t row = 0; row < masses.size(); ++row)
        bodies.mass.set(row, row == 0 ? 1 : masses.size(), static_cast<Real>(masses[row]));
    return bodies;
}

}  // namespace

TEST_SUITE("solvers/substeps/body_masses") {
    TEST_CASE_TEMPLATE("like masses need no column, and nothing besides the sweeps", Real, float, double) {
        BodyMasses<Real> masses;
        CHECK(masses.derive(bodies_of<Real>({2, 2, 2}), true, true));
        CHECK(masses.inverse() == nullptr);
        CHECK_FALSE(masses.are_uneven());
        CHECK(masses.bytes() == 0);
    }
    TEST_CASE_TEMPLATE("a fixed angle is a sign, and what nothing moves is zero", Real, float, double) {
        Bodies<Real> bodies = bodies_of<Real>({2, 4, 8});
        bodies.set_flags(0, kImmovable);
        bodies.set_flags(1, kFixedAngle);
        BodyMasses<Real> masses;
        masses.derive(bodies, true, true);
        CHECK(masses.some_are_fixed());
        CHECK(masses.inverse()[0] == Real(0));
        CHECK(masses.inverse()[1] == Real(-0.25));
        CHECK(masses.inverse()[2] == Real(0.125));
        masses.forget();
        masses.derive(bodies, false, false);  // nothing turns
        CHECK_FALSE(masses.some_are_fixed());
        CHECK(masses.inverse()[1] == Real(0.25));
    }
    TEST_CASE_TEMPLATE("they are derived again only after they were forgotten", Real, float, double) {
        BodyMasses<Real> masses;
        CHECK(masses.derive(bodies_of<Real>({1, 2}), true, true));
        CHECK_FALSE(masses.derive(bodies_of<Real>({1, 1000}), true, true));
        CHECK_FALSE(masses.are_uneven());
        masses.forget();
        CHECK(masses.derive(bodies_of<Real>({1, 1000}), true, true));
        CHECK(masses.are_uneven());
    }
    TEST_CASE_TEMPLATE(
        "masses are very uneven from a thousand to one on, without friction from three hundred", Real, float,
        double) {
        for (const double ratio : {300.0, 1000.0, 1100.0})
            for (const bool has_friction : {true, false}) {
                BodyMasses<Real> masses;
                masses.derive(bodies_of<Real>({1, ratio}), has_friction, true);
                CHECK(masses.ratio() == doctest::Approx(ratio).epsilon(1e-6));
                CHECK(masses.are_very_uneven() == (ratio > (has_friction ? 1000 : 300)));
                CHECK(masses.are_mixed() == masses.are_very_uneven());
            }
    }
    TEST_CASE_TEMPLATE("a body that nothing moves makes no masses uneven", Real, float, double) {
        Bodies<Real> bodies = bodies_of<Real>({1, 1000});
        bodies.set_flags(1, kImmovable);
        BodyMasses<Real> masses;
        masses.derive(bodies, true, true);
        CHECK_FALSE(masses.are_uneven());
    }
}

}  // namespace test_body_masses
