// B4 of the design notes, with discs: a heavy disc on a light one.
#include "support/passive_run.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kRadius = 0.5, kGravity = 10, kStep = 1.0 / 60;

/// How deep the upper of two discs of masses 1 and `ratio` in a shaft ever sinks, in diameters of the lower.
template <class Real>
double deepest_sink(double ratio, int substeps) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = Walls{.min = {-1.001 * kRadius, 0}, .max = {1.001 * kRadius, 100}, .top = false};
    scene.accuracy.solver = Solver::soft;
    scene.add(disc(kRadius, 1, {0, kRadius}));
    scene.add(disc(kRadius, ratio, {0, 3 * kRadius}));
    PassiveRun<Real> run(scene, {.substeps = substeps});
    double deepest = 0;
    for (int i = 0; i < 600; ++i) {
        run.step(kStep);
        const double light = run.state(0).position.y, heavy = run.state(1).position.y;
        deepest = std::fmax(deepest, (3 * kRadius - heavy) / (2 * kRadius));
        CHECK(heavy > light);
    }
    run.check();
    report("ratio ", ratio, ", ", substeps, " substeps: sink ", 100 * deepest, " % of a diameter, at last ",
           100 * (3 * kRadius - run.state(1).position.y) / (2 * kRadius), " %");
    return deepest;
}

}  // namespace

TEST_SUITE("hard cases/heavy on light") {
    // Default settings take ratios up to 100; beyond, the substeps that the law below asks for.
    TEST_CASE_TEMPLATE("B4: a light disc carries one that is up to a million times heavier", Real, float,
                       double) {
        constexpr int kDefault = 4;
        CHECK(deepest_sink<Real>(10, kDefault) < 0.01);
        CHECK(deepest_sink<Real>(1e2, kDefault) < 0.05);
        CHECK(deepest_sink<Real>(1e3, 6) < 0.1);
        CHECK(deepest_sink<Real>(1e4, 14) < 0.2);
        CHECK(deepest_sink<Real>(1e6, 84) < 0.5);
    }

    // A sweep takes the light body's share of the heavy one's speed away, two sweeps a substep: so the force
    // builds up as in a spring of stiffness 2 m / h², which is pressed by 2 M g h² / (2 m).
    TEST_CASE_TEMPLATE("a load that no impulse carries yet sinks by M g h² / m at most", Real, float,
                       double) {
        struct Setting {
            double ratio;
            int substeps;
        };
        for (const Setting& set : {Setting{1e2, 4}, {1e3, 4}, {1e3, 8}, {1e4, 14}, {1e4, 50}, {1e6, 100}}) {
            const double h = kStep / set.substeps;
            const double law = set.ratio * kGravity * h * h / (2 * kRadius);
            const double sink = deepest_sink<Real>(set.ratio, set.substeps);
            CAPTURE(set.ratio);
            CAPTURE(set.substeps);
            CHECK(sink < 1.01 * law);
            CHECK(sink > 0.25 * law);  // over-relaxation takes a part of it away
        }
    }
}
