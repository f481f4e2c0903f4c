#include "accuracy/cases/parts.hpp"

// A slope is a level floor under tilted gravity: the disc slides and rolls along x.

namespace carom::accuracy {
namespace {

constexpr double kRadius = 0.5, kMass = 2, kFriction = 0.5, kTime = 1;  // m, kg, 1, s
constexpr double kLaunch = 6;                                           // m/s
constexpr double kTooSteep = 1.2, kNotSteep = 0.99;     // tangent of the slope over the coefficient
constexpr double kRollingSlope = 0.4;                   // rad
const double kSlidingSlope = std::atan(6 * kFriction);  // twice what friction can roll it on

Scene disc_on_floor(double slope, double speed, bool turns) {
    Scene scene;
    scene.gravity = {kGravity * std::sin(slope), -kGravity * std::cos(slope)};
    scene.walls = floor_of(bouncy(0, kFriction));
    scene.add(disc(kRadius, kMass, {0, kRadius}, {speed, 0}, bouncy(0, kFriction)));
    scene.bodies[0].fixed_rotation = !turns;
    return scene;
}

double steep() {
    return std::atan(kTooSteep * kFriction);
}
double not_steep() {
    return std::atan(kNotSteep * kFriction);
}
double sliding_acceleration(double slope) {
    return kGravity * (std::sin(slope) - kFriction * std::cos(slope));
}

/// Way from rest under a constant acceleration, and its error over another way.
double way(double acceleration) {
    return 0.5 * acceleration * kTime * kTime;
}

std::vector<double> run_sticking(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    const double smooth = way(kGravity * std::sin(not_steep()));
    return {stepper.state(0).position.x / smooth, stepper.state(0).velocity.x * kTime / (2 * smooth)};
}

std::vector<double> run_sliding(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    const double exact = way(sliding_acceleration(steep()));
    return {stepper.state(0).position.x / exact - 1, stepper.state(0).velocity.x * kTime / (2 * exact) - 1};
}

/// Errors of the way and of the spin's speed at the rim.
std::vector<double> errors_of_rolling(const Stepper& stepper, double exact_way, double exact_rim) {
    const BodyState state = stepper.state(0);
    return {state.position.x / exact_way - 1, -state.angular_velocity * kRadius / exact_rim - 1};
}

std::vector<double> run_rolling(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    const double a = 2.0 / 3 * kGravity * std::sin(kRollingSlope);
    return errors_of_rolling(stepper, way(a), a * kTime);
}

std::vector<double> run_rolling_and_sliding(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    const double rim = 2 * kFriction * kGravity * std::cos(kSlidingSlope) * kTime;
    return errors_of_rolling(stepper, way(sliding_acceleration(kSlidingSlope)), rim);
}

std::vector<double> run_launched(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    const double rolls_at = kLaunch / (3 * kFriction * kGravity), speed = 2 * kLaunch / 3;
    const double slid = 5 * kLaunch * kLaunch / (18 * kFriction * kGravity);
    return errors_of_rolling(stepper, slid + (kTime - rolls_at) * speed, speed);
}

std::vector<double> run_stopping(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(2 * kTime);  // it stands after 1.2 s
    const double exact = kLaunch * kLaunch / (2 * kFriction * kGravity);
    return {stepper.state(0).position.x / exact - 1, stepper.state(0).velocity.x / kLaunch};
}

Case friction_of(std::string_view id, std::string_view title, std::string_view effects,
                 std::string_view exact) {
    return {.id = id,
            .title = title,
            .kind = "friction",
            .effects = effects,
            .exact = exact,
            .errors = {},
            .solvers = {"soft"},
            .steps = steps_of_frames(),
            .scene = nullptr,
            .run = nullptr};
}

const std::vector<ErrorMeasure> kWayAndSpeed{{"way", "way slid in a second over the exact one, less 1"},
                                             {"speed", "the same of the speed"}};
const std::vector<ErrorMeasure> kWayAndSpin{{"way", "way in a second over the exact one, less 1"},
                                            {"spin", "speed of the rim over the exact one, less 1"}};

}  // namespace

Case sticking_disc() {
    Case sticks =
        friction_of("A9-stick", "A disc that cannot turn, on a slope 1 % below the angle of friction",
                    "G N F", "it stays where it is, because tan(slope) < μ; looked at after 1 s");
    sticks.errors = {{"creep", "way it went, over the way without friction"},
                     {"speed", "its speed, over that without friction"}};
    sticks.scene = [](int) { return disc_on_floor(not_steep(), 0, false); };
    sticks.run = run_sticking;
    return sticks;
}

Case sliding_disc() {
    Case slides = friction_of("A9", "A disc that cannot turn slides down a slope too steep to hold it",
                              "G N F", "a = g (sin(slope) - μ cos(slope)), because tan(slope) = 1.2 μ");
    slides.errors = kWayAndSpeed;
    slides.scene = [](int) { return disc_on_floor(steep(), 0, false); };
    slides.run = run_sliding;
    return slides;
}

Case rolling_disc() {
    Case rolls = friction_of("A10", "A disc rolls down a slope", "G N F W",
                             "a = 2/3 g sin(slope), because tan(slope) < 3 μ");
    rolls.errors = kWayAndSpin;
    rolls.scene = [](int) { return disc_on_floor(kRollingSlope, 0, true); };
    rolls.run = run_rolling;
    return rolls;
}

Case slipping_disc() {
    Case slips =
        friction_of("A10-slip", "A disc slips and turns on a slope too steep to roll on", "G N F W",
                    "a = g (sin(slope) - μ cos(slope)), spin 2 μ g cos(slope) t/R, because tan(slope) = 6 μ");
    slips.errors = kWayAndSpin;
    slips.scene = [](int) { return disc_on_floor(kSlidingSlope, 0, true); };
    slips.run = run_rolling_and_sliding;
    return slips;
}

Case launched_disc() {
    Case launched = friction_of("A11", "A disc launched without spin starts to roll", "G N F W",
                                "it rolls from v0/(3 μ g) on, after 5 v0²/(18 μ g), with 2/3 v0");
    launched.errors = kWayAndSpin;
    launched.scene = [](int) { return disc_on_floor(0, kLaunch, true); };
    launched.run = run_launched;
    return launched;
}

Case stopping_disc() {
    Case stops = friction_of("A12", "A disc that cannot turn slides to a stop", "G N F",
                             "it stands after v0²/(2 μ g)");
    stops.errors = {{"way", "way to where it stands over the exact one, less 1"},
                    {"speed", "speed left 0.8 s after it has to stand, over the first"}};
    stops.scene = [](int) { return disc_on_floor(0, kLaunch, false); };
    stops.run = run_stopping;
    return stops;
}

}  // namespace carom::accuracy
