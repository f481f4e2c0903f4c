// A smooth box that hangs by two of its sides in a gap between two corners: it swings about its lowest place
// with nothing that takes or gives energy.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "support/report.hpp"
#include "support/scenes.hpp"

namespace test_rocking {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kSide = 0.8, kGap = 0.5, kGravity = 9.81, kStep = 1.0 / 60;

/// By Thales the corner of the box between the two sides runs on the circle whose diameter is the gap, and
/// the line from it to the centre goes through the circle's top for ever: at an angle phi to the vertical
/// the corner is gap cos(phi) below the top along that line.
/// @param of_chain  whether the gap is between points of a chain; else between boxes
Scene box_in_gap(double phi, bool of_chain) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    const double half = 0.5 * kGap;
    if (of_chain)
        scene.add({.type = BodyType::static_body,
                   .shape = Chain{{{-2, 0}, {-half, 0}, {-half, -2}, {half, -2}, {half, 0}, {2, 0}}}});
    else
        for (const double side : {-1.0, 1.0})
            scene.add(
                {.type = BodyType::static_body, .shape = Box{2, 2}, .position = {side * (1 + half), -1}});
    const double above = kSide / std::numbers::sqrt2 - kGap * std::cos(phi);  // m, of the centre, of the top
    scene.add({.shape = Box{kSide, kSide},
               .position = {-above * std::sin(phi), half + above * std::cos(phi)},
               .angle = std::numbers::pi / 4 + phi});
    scene.effects.ledger = true;
    return scene;
}

/// rad/s, of small swings: the centre is at half + d cos(phi) - gap cos(phi)^2, d half of the diagonal.
double frequency() {
    const double d = kSide / std::numbers::sqrt2, lever = d - kGap;
    return std::sqrt(kGravity * (2 * kGap - d) / (kSide * kSide / 6 + lever * lever));
}

}  // namespace

TEST_SUITE("physics/rocking") {
    // With contacts of the start of each step its swing grew as exp(w² dt t / 4), up to 3.3 rad/s.
    TEST_CASE_TEMPLATE("A14: a smooth box that hangs in a gap swings at its frequency and gains no energy",
                       Real, float, double) {
        for (const bool of_chain : {false, true}) {
            CAPTURE(of_chain);
            constexpr double kTilt = 0.05;
            BasicWorld<Real> world(box_in_gap(kTilt, of_chain));
            const BodyId box{of_chain ? 1u : 2u, 0};
            const Energy start = world.ledger().energy;
            const double swing = start.potential -
                                 kGravity * kSide * kSide * (0.5 * kGap + kSide / std::numbers::sqrt2 - kGap);
            double rise = 0, fastest = 0, late = 0, before = kTilt;
            int crossings = 0;
            double first = 0, last = 0;
            for (int i = 0; i < 1800; ++i) {
                world.step(kStep);
                const BodyState state = world.state(box);
                rise = std::fmax(rise, world.ledger().energy.total() - start.total());
                if (i < 60) fastest = std::fmax(fastest, std::fabs(state.angular_velocity));
                if (i >= 1200) late = std::fmax(late, std::fabs(state.angular_velocity));
                const double phi = state.angle - std::numbers::pi / 4;
                if (i < 300 && before * phi < 0) {
                    last = i + before / (before - phi);
                    if (++crossings == 1) first = last;
                }
                before = phi;
            }
            const double w = std::numbers::pi * (crossings - 1) / ((last - first) * kStep);
            report("box in a gap: ", w, " rad/s, exact ", frequency(), "; fastest ", fastest, ", late ", late,
                   " rad/s; energy up by ", rise / swing, " of the swing's");
            CHECK(w == doctest::Approx(frequency()).epsilon(0.02));
            CHECK(fastest == doctest::Approx(kTilt * frequency()).epsilon(0.1));
            CHECK(rise < 0.02 * swing);
            CHECK(late < 0.25 * fastest);
        }
    }
}

}  // namespace test_rocking
