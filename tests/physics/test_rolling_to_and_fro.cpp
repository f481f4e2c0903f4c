// What rolls to and fro on something round, with friction and nothing that takes or gives energy.
// docs/decisions/0066-what-rolls-keeps-its-energy.md.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

namespace test_rolling_to_and_fro {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kGravity = 9.81, kStep = 1.0 / 60;
constexpr Material kRough{.friction = 0.9};
constexpr double kLargestRise = 0.005;  // of the swing's energy, from nothing

/// A body that is let go at rest beside its lowest place and rolls without slipping.
struct Roller {
    Scene scene;
    BodyId body;
    double frequency = 0;  ///< rad/s, of small swings
    double energy = 0;     ///< J, of the swing, over rest
};

Scene heavy_world() {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.effects.ledger = true;
    return scene;
}

/// A disc with a small heavy one at its bottom, on the ground.
/// @param on_segment  whether the ground is a segment; else a box
Roller roly_poly(double swing, bool on_segment) {
    constexpr double kRadius = 0.5, kWeight = 0.15, kBelow = 0.3, kDensity = 20;  // m; kg/m²
    Roller made{heavy_world(), {}};
    made.scene.add({.type = BodyType::static_body,
                    .shape = on_segment ? Shape{Segment{{-50, 1}, {50, 1}}} : Shape{Box{100, 2}},
                    .material = kRough});
    const Material heavy{.density = kDensity, .friction = kRough.friction};
    const Compound shape{{{.shape = Disc{kRadius}, .material = kRough},
                          {.shape = Disc{kWeight}, .position = {0, -kBelow}, .material = heavy}}};
    const double large = std::numbers::pi * kRadius * kRadius,
                 small = kDensity * std::numbers::pi * kWeight * kWeight, mass = large + small;
    const double depth = kBelow * small / mass;  // m, of the centre of mass below that of the disc
    const double inertia = large * (kRadius * kRadius / 2 + depth * depth) +
                           small * (kWeight * kWeight / 2 + (kBelow - depth) * (kBelow - depth));
    made.body = made.scene.add({.shape = shape,
                                .position = {depth * std::sin(swing), 1 + kRadius - depth * std::cos(swing)},
                                .angle = swing,
                                .material = kRough});
    const double above = kRadius - depth;
    made.frequency = std::sqrt(mass * kGravity * depth / (inertia + mass * above * above));
    made.energy = mass * kGravity * depth * (1 - std::cos(swing));
    return made;
}

/// A plank across a round static body, on which it has rolled by `swing` times the radius along itself.
/// @param radius, top  m, of the round body: of its curve, and of its highest point over its middle
Roller plank_on(const Shape& round, double radius, double top, double swing) {
    constexpr double kLength = 2, kHalf = 0.05;  // m
    Roller made{heavy_world(), {}};
    const double turn = std::holds_alternative<Capsule>(round) ? std::numbers::pi / 2 : 0;
    made.scene.add({.type = BodyType::static_body, .shape = round, .angle = turn, .material = kRough});
    const double s = std::sin(swing), c = std::cos(swing), rolled = radius * swing;
    made.body = made.scene.add(
        {.shape = Box{kLength, 2 * kHalf},
         .position = {-(radius + kHalf) * s + rolled * c, top - radius + (radius + kHalf) * c + rolled * s},
         .angle = swing,
         .material = kRough});
    const double mass = 2 * kHalf * kLength, own = (kLength * kLength + 4 * kHalf * kHalf) / 12;
    made.frequency = std::sqrt(kGravity * (radius - kHalf) / (own + kHalf * kHalf));
    made.energy = mass * kGravity * ((radius + kHalf) * (c - 1) + rolled * s);
    return made;
}

/// A disc in a round valley of a chain.
/// @param swing  rad, about the centre of the valley's circle
Roller disc_in_bowl(double swing) {
    constexpr double kBowl = 3, kRadius = 0.3, kReach = 1.3;  // m; rad to each side of the lowest point
    constexpr int kEdges = 800;
    Roller made{heavy_world(), {}};
    Chain bowl;
    for (int i = 0; i <= kEdges; ++i) {
        const double at = kReach * (2.0 * i / kEdges - 1);
        bowl.points.push_back({kBowl * std::sin(at), -kBowl * std::cos(at)});
    }
    made.scene.add({.type = BodyType::static_body, .shape = bowl, .material = kRough});
    const double way = kBowl - kRadius, mass = std::numbers::pi * kRadius * kRadius;
    made.body = made.scene.add({.shape = Disc{kRadius},
                                .position = {way * std::sin(swing), -way * std::cos(swing)},
                                .material = kRough});
    made.frequency = std::sqrt(2 * kGravity / (3 * way));
    made.energy = mass * kGravity * way * (1 - std::cos(swing));
    return made;
}

/// What a roller did in some seconds.
struct Watched {
    double frequency = 0;  ///< rad/s, from crossings of its lowest place
    double most = 0;       ///< energy, in shares of the swing's at the start
    double left = 0;       ///< of the same, at the end
};

template <class Real>
Watched watch(const Roller& roller, double seconds, double step, bool by_angle) {
    BasicWorld<Real> world(roller.scene);
    const double start = world.ledger().energy.total(), rest = start - roller.energy;
    const auto place = [&] {
        const BodyState state = world.state(roller.body);
        return by_angle ? state.angle : state.position.x;
    };
    Watched seen;
    double before = place(), first = 0, last = 0;
    int crossings = 0;
    for (int i = 0; i < static_cast<int>(seconds / step); ++i) {
        world.step(step);
        seen.left = (world.ledger().energy.total() - rest) / roller.energy;
        seen.most = std::fmax(seen.most, seen.left);
        const double now = place();
        if (before * now < 0) {
            last = i + before / (before - now);
            if (++crossings == 1) first = last;
        }
        before = now;
    }
    seen.frequency = std::numbers::pi * (crossings - 1) / ((last - first) * step);
    return seen;
}

/// Watches a roller for 20 s, in steps of 1/60 and 1/120 s.
/// @param is_small  whether its swing is small enough for the frequency of small ones
/// @param left      share of it that must be left
/// @param by_angle  whether its lowest place is where its angle is zero; else where x is
template <class Real>
void check(const char* name, const Roller& roller, bool is_small, double left, bool by_angle) {
    CAPTURE(name);
    for (const double step : scaled<std::vector<double>>({kStep, kStep / 2}, {kStep})) {
        CAPTURE(step);
        const Watched seen = watch<Real>(roller, 20, step, by_angle);
        report(name, ": ", seen.frequency, " rad/s, exact ", roller.frequency, "; energy up to ", seen.most,
               ", at the end ", seen.left, " of the swing's");
        if (is_small) CHECK(seen.frequency == doctest::Approx(roller.frequency).epsilon(0.01));
        CHECK(seen.most < 1 + kLargestRise);
        CHECK(seen.left > left);
    }
}

}  // namespace

TEST_SUITE("physics/rolling to and fro") {
    // With contacts of the start of each step the toy had 4.6 times its energy after 20 s, 116 times it after
    // a minute, and a plank rolled off its disc.
    TEST_CASE_TEMPLATE("A37: a roly-poly rocks at its frequency and keeps its energy", Real, float, double) {
        for (const bool on_segment : {false, true}) {
            CAPTURE(on_segment);
            check<Real>("roly-poly, .1 rad", roly_poly(0.1, on_segment), true, 0.98, true);
            check<Real>("roly-poly, 1 rad", roly_poly(1, on_segment), false, 0.8, true);
        }
    }

    TEST_CASE_TEMPLATE("A37: a plank on something round rocks at its frequency and gains no energy", Real,
                       float, double) {
        check<Real>("plank on a disc, .05 rad", plank_on(Disc{0.6}, 0.6, 0.6, 0.05), true, 0.98, true);
        check<Real>("plank on a disc, .4 rad", plank_on(Disc{0.6}, 0.6, 0.6, 0.4), false, 0.7, true);
        check<Real>("plank on a capsule, .4 rad", plank_on(Capsule{0.5, 0.6}, 0.6, 0.85, 0.4), false, 0.7,
                    true);
    }

    TEST_CASE_TEMPLATE("A37: a disc rolls to and fro in a bowl at its frequency and gains no energy", Real,
                       float, double) {
        check<Real>("disc in a bowl, .3 rad", disc_in_bowl(0.3), true, 0.95, false);
        check<Real>("disc in a bowl, 1 rad", disc_in_bowl(1), false, 0.75, false);
    }
}

}  // namespace test_rolling_to_and_fro
