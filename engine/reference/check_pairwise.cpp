#include "check_pairwise.hpp"

#include <carom/errors.hpp>

#include <cmath>
#include <limits>
#include <sstream>
#include <string>

namespace carom {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

struct Limits {
    double min = -kNoLimit;
    double max = kNoLimit;
    bool above_min = false;  // min itself is out
    const char* remedy = "Give a finite number.";
};

constexpr Limits kFinite{};
constexpr Limits kPositive{.min = 0, .above_min = true, .remedy = "Give a finite number above zero."};
constexpr Limits kNotNegative{.min = 0, .remedy = "Give zero or a finite number above it."};
constexpr Limits kFraction{.min = 0, .max = 1, .remedy = "Give a fraction from 0 to 1."};

std::string expected(const Limits& limits) {
    std::ostringstream text;
    text << "a finite number";
    if (limits.min > -kNoLimit) text << (limits.above_min ? " > " : " >= ") << limits.min;
    if (limits.max < kNoLimit) text << " and <= " << limits.max;
    return text.str();
}

void check(const std::string& item, double value, const char* unit, const Limits& limits) {
    const bool inside = (limits.above_min ? value > limits.min : value >= limits.min) && value <= limits.max;
    if (inside && std::isfinite(value)) return;
    std::ostringstream text;
    text << "Pairwise: " << item << " is " << value << unit << "; expected " << expected(limits) << ". "
         << limits.remedy;
    throw Error(std::isfinite(value) ? ErrorCode::out_of_range : ErrorCode::not_finite, text.str());
}

void check_body(std::size_t index, const PairwiseBody& body) {
    const auto check_part = [&](const char* part, double value, const char* unit, const Limits& limits) {
        check("the " + std::string(part) + " of body " + std::to_string(index), value, unit, limits);
    };
    check_part("x", body.x, " m", kFinite);
    check_part("y", body.y, " m", kFinite);
    check_part("vx", body.vx, " m/s", kFinite);
    check_part("vy", body.vy, " m/s", kFinite);
    check_part("mass", body.mass, " kg", kPositive);
    check_part("radius", body.radius, " m", kPositive);
    check_part("angle", body.angle, " rad", kFinite);
    check_part("omega", body.omega, " rad/s", kFinite);
}

void check_between(const char* axis, double min, double max) {
    if (min < max) return;
    std::ostringstream text;
    text << "Pairwise: the walls have min " << axis << " = " << min << " m and max " << axis << " = " << max
         << " m; expected min < max. Swap the two corners.";
    throw Error(ErrorCode::inconsistent, text.str());
}

void check_walls(const PairwiseWalls& walls) {
    check("min x of the walls", walls.min_x, " m", kFinite);
    check("min y of the walls", walls.min_y, " m", kFinite);
    check("max x of the walls", walls.max_x, " m", kFinite);
    check("max y of the walls", walls.max_y, " m", kFinite);
    check_between("x", walls.min_x, walls.max_x);
    check_between("y", walls.min_y, walls.max_y);
    check("the restitution of the walls", walls.restitution, "", kNotNegative);
    check("spin_kept of the walls", walls.spin_kept, "", kFraction);
}

}  // namespace

void check_pairwise(const PairwiseScene& scene) {
    check("gravity x", scene.gravity_x, " m/s²", kFinite);
    check("gravity y", scene.gravity_y, " m/s²", kFinite);
    check("linear_drag", scene.linear_drag, " 1/s", kNotNegative);
    check("angular_drag", scene.angular_drag, " 1/s", kNotNegative);
    if (scene.keep_per_step) check("keep_per_step", *scene.keep_per_step, "", kFraction);
    check("restitution", scene.restitution, "", kNotNegative);
    if (scene.walls) check_walls(*scene.walls);
    for (std::size_t index = 0; index < scene.bodies.size(); ++index) check_body(index, scene.bodies[index]);
}

void check_pairwise_dt(double dt) {
    if (std::isfinite(dt) && dt >= 0) return;
    check("dt of a step", dt, " s", {.min = 0, .remedy = "Give the step length in seconds."});
}

}  // namespace carom
