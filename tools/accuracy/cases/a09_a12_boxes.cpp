#include "accuracy/cases/parts.hpp"

// What discs that cannot turn do on a slope under tilted gravity (a09_a12_friction.cpp), boxes do on one that
// is tilted itself.

namespace carom::accuracy {
namespace {

constexpr double kSlope = 0.3, kRough = 1, kTime = 2;         // rad, coefficient of the slope, s
constexpr double kHolds = 0.99, kSlides = 1.2;                // tan(slope) over the coefficient
constexpr double kTippingSlope = 0.5;                         // rad
constexpr double kStands = 1.01, kTips = 0.99, kTipTime = 4;  // width over height tan(slope), s
constexpr double kTipped = 0.5;                               // rad: then it has tipped
constexpr double kSpeed = 5, kFriction = 0.3;                 // m/s

/// Along the slope, which falls to the right through the origin, and above it.
Vec2 on_slope(double slope, double along, double above) {
    const double c = std::cos(slope), s = std::sin(slope);
    return {along * c + above * s, above * c - along * s};
}

void add_box(Scene& scene, double slope, double along, double width, double height, double friction) {
    scene.add(box(width, height, on_slope(slope, along, 0.5 * height), -slope, friction));
}

Scene slope_of(double slope) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.add(block(200, 2, on_slope(slope, 0, -1), -slope, kRough));
    return scene;
}

/// A pair has the geometric mean of both coefficients.
double for_pair(double friction) {
    return friction * friction / kRough;
}

Scene boxes_on_slope(int) {
    Scene scene = slope_of(kSlope);
    add_box(scene, kSlope, -20, 1, 0.5, for_pair(std::tan(kSlope) / kHolds));
    add_box(scene, kSlope, 20, 1, 0.5, for_pair(std::tan(kSlope) / kSlides));
    return scene;
}

double way_along(const Stepper& stepper, const Scene& scene, std::size_t body) {
    const Vec2 at = stepper.state(body).position, start = scene.bodies[body].position;
    return (at.x - start.x) * std::cos(kSlope) - (at.y - start.y) * std::sin(kSlope);
}

std::vector<double> run_slope(Stepper& stepper, const Scene& scene, int) {
    stepper.advance_to(kTime);
    const double smooth = 0.5 * kGravity * std::sin(kSlope) * kTime * kTime;
    const double slides = smooth * (1 - 1 / kSlides);
    return {way_along(stepper, scene, 2) / slides - 1, way_along(stepper, scene, 1) / smooth};
}

Scene boxes_that_tip(int) {
    Scene scene = slope_of(kTippingSlope);
    const double width = std::tan(kTippingSlope);  // of a box 1 m high that balances
    add_box(scene, kTippingSlope, -20, kStands * width, 1, 25);
    add_box(scene, kTippingSlope, 20, kTips * width, 1, 25);
    return scene;
}

std::vector<double> run_tipping(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTipTime);
    const double stands = stepper.state(1).angle + kTippingSlope,
                 tips = stepper.state(2).angle + kTippingSlope;
    return {stands, tips < -kTipped ? 0.0 : 1.0};
}

Scene sliding_box(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.add(ground(-100, 100, kFriction));
    scene.add(box(1, 0.5, {0, 0.25}, 0, kFriction));
    scene.bodies.back().velocity = {kSpeed, 0};
    return scene;
}

std::vector<double> run_stopping(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime + 1);  // it stands after 1.7 s
    const double exact = kSpeed * kSpeed / (2 * kFriction * kGravity);
    // Below round-off it is none: it would only be a line of the chart.
    const double left = stepper.state(1).velocity.x / kSpeed;
    return {stepper.state(1).position.x / exact - 1, std::abs(left) < 1e-15 ? 0.0 : left};
}

Case friction_of(std::string_view id, std::string_view title, std::string_view exact) {
    return {.id = id,
            .title = title,
            .kind = "friction",
            .effects = "G N F W",
            .exact = exact,
            .errors = {},
            .solvers = {"soft"},
            .steps = steps_of_structures(),
            .scene = nullptr,
            .run = nullptr};
}

}  // namespace

Case sloping_boxes() {
    Case slides =
        friction_of("A9-box", "Two boxes on a slope, one 1 % below the angle of friction, one above",
                    "one stays where it is, the other slides with g (sin(slope) - μ cos(slope)), "
                    "tan(slope) = 1.2 μ; looked at after 2 s");
    slides.errors = {{"way", "way slid over the exact one, less 1"},
                     {"creep", "way that the other went, over the way without friction"}};
    slides.scene = boxes_on_slope, slides.run = run_slope;
    return slides;
}

Case tipping_boxes() {
    Case tips =
        friction_of("A9-tip", "Two boxes on a rough slope, one 1 % wider than what stands, one narrower",
                    "a box stands if tan(slope) is below width over height, else it tips; after 4 s");
    tips.errors = {{"turn", "angle by which the one that stands has turned, rad"},
                   {"tips", "0 if the other one has tipped, 1 if it stands"}};
    tips.scene = boxes_that_tip, tips.run = run_tipping;
    return tips;
}

Case stopping_box() {
    Case stops = friction_of("A12-box", "A box slides to a stop", "it stands after v0²/(2 μ g)");
    stops.errors = {{"way", "way to where it stands over the exact one, less 1"},
                    {"speed", "speed left 1.3 s after it has to stand, over the first"}};
    stops.scene = sliding_box, stops.run = run_stopping;
    return stops;
}

}  // namespace carom::accuracy
