#include "scene/validation/limits.hpp"
#include "scene/validation/validation.hpp"
#include "shapes/compound.hpp"
#include "shapes/convex_geometry.hpp"
#include "shapes/mass.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

std::optional<Problem> find_velocity_problem(const Item& item, Vec2 velocity) {
    if (auto found = check(item, "/velocity/0", velocity.x, kVelocityX)) return found;
    if (auto found = check(item, "/velocity/1", velocity.y, kVelocityY)) return found;
    // Only the sum of two large components can exceed the limit that each of them keeps.
    if (std::abs(velocity.x) + std::abs(velocity.y) <= kLargestSpeed) return std::nullopt;
    return check(item, "/velocity", std::sqrt(velocity.x * velocity.x + velocity.y * velocity.y), kSpeed);
}

std::optional<Problem> find_position_problem(const Item& item, Vec2 position) {
    if (auto found = check(item, "/position/0", position.x, kPositionX)) return found;
    return check(item, "/position/1", position.y, kPositionY);
}

std::optional<Problem> find_mass_problem(const Item& item, const Body& body) {
    if (body.mass) return check(item, "/mass", *body.mass, kMass);
    if (body.type != BodyType::dynamic_body) return std::nullopt;
    return check(item, "/material/density", mass_of(body), kMassOfDensity);
}

std::optional<Problem> find_motion_problem(const Item& item, const Body& body) {
    const Mobility mobility = body.type == BodyType::static_body ? Mobility::none
                              : body.fixed_rotation              ? Mobility::no_rotation
                                                                 : Mobility::all;
    if (auto found = find_velocity_problem(item, mobility, body.velocity)) return found;
    return find_angular_velocity_problem(item, mobility, body.angular_velocity);
}

bool is_hex_digit(char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}

std::optional<Problem> find_color_problem(const Item& item, const std::string& color) {
    if (color.empty()) return std::nullopt;
    if (color.size() == 7 && color[0] == '#' && std::all_of(color.begin() + 1, color.end(), is_hex_digit))
        return std::nullopt;
    return problem(ErrorCode::out_of_range, item, "/color", "color ", quoted(color),
                   "; expected \"#rrggbb\" with six hexadecimal digits.");
}

struct Axis {
    std::string_view name;
    std::string_view tail;
    double position, min, max;
    bool low_side, high_side;
    std::string_view low_name, high_name;
};

/// @param radius  m, of the disc in the body: what it needs however it turns
std::optional<Problem> find_axis_problem(const Item& item, const Axis& axis, const Shape& shape,
                                         double radius) {
    const bool below = axis.low_side && axis.position < axis.min;
    const bool above = axis.high_side && axis.position > axis.max;
    if (below || above)
        return problem(ErrorCode::out_of_range, item, axis.tail, "position ", axis.name, " ", axis.position,
                       " m, outside the ", below ? axis.low_name : axis.high_name, " wall; expected ",
                       axis.min, " <= ", axis.name, " <= ", axis.max,
                       " m. Move the body inside, or leave that side open.");
    if (axis.low_side && axis.high_side && 2 * radius > axis.max - axis.min)
        return problem(
            ErrorCode::inconsistent, item,
            is_disc(shape) ? "/shape/disc/radius" : join("/shape/", name_of(shape)),
            is_disc(shape) ? "diameter " : "thickness ", 2 * radius, " m but the ", axis.low_name, " and ",
            axis.high_name, " walls are ", axis.max - axis.min,
            " m apart; expected a body that fits between them. Make it smaller, or the box larger.");
    return std::nullopt;
}

constexpr Item kSingleBody{"the body has", "", -1, ""};

constexpr std::string_view kWasQuarantined =
    "was quarantined, as its state left the limits, and takes no part any more; expected ";
constexpr std::string_view kAddAnew = ". Remove it and add a body in its place.";

}  // namespace

std::optional<Problem> find_velocity_problem(const Item& item, Mobility mobility, Vec2 velocity) {
    if (velocity == Vec2{} || mobility == Mobility::all || mobility == Mobility::no_rotation)
        return std::nullopt;
    const std::string what = join("velocity ", velocity, " m/s but ");
    if (mobility == Mobility::quarantined)
        return problem(ErrorCode::inconsistent, item, "/velocity", what, kWasQuarantined, "[0, 0]", kAddAnew);
    return problem(ErrorCode::inconsistent, item, "/velocity", what,
                   "is static; expected [0, 0]. Make it kinematic to move at a set velocity.");
}

std::optional<Problem> find_angular_velocity_problem(const Item& item, Mobility mobility, double spin) {
    if (spin == 0 || mobility == Mobility::all) return std::nullopt;
    const std::string what = join("angular velocity ", spin, " rad/s but ");
    if (mobility == Mobility::quarantined)
        return problem(ErrorCode::inconsistent, item, "/angular_velocity", what, kWasQuarantined, "0",
                       kAddAnew);
    if (mobility == Mobility::no_rotation)
        return problem(ErrorCode::inconsistent, item, "/angular_velocity", what,
                       "fixed rotation; expected 0. Drop one of the two.");
    return problem(ErrorCode::inconsistent, item, "/angular_velocity", what,
                   "is static; expected 0. Make it kinematic to turn at a set velocity.");
}

std::optional<Problem> find_material_problem(const Item& item, std::string_view tail,
                                             const Material& material) {
    const auto in = [tail](std::string_view key) { return join(tail, key); };
    if (!(material.density >= kDensity.low && material.density <= kDensity.high))
        return check(item, in("/density"), material.density, kDensity);
    if (!(material.restitution >= kRestitution.low && material.restitution <= kRestitution.high))
        return check(item, in("/restitution"), material.restitution, kRestitution);
    if (material.friction == 0 && material.rolling_resistance == 0) return std::nullopt;
    if (auto found = check(item, in("/friction"), material.friction, kFriction)) return found;
    return check(item, in("/rolling_resistance"), material.rolling_resistance, kRollingResistance);
}

std::optional<Problem> find_problem(const Material& material) {
    return find_material_problem({"the material has", "", -1, ""}, "", material);
}

std::optional<Problem> find_body_problem(const Item& item, const Body& body) {
    if (auto found = find_shape_problem(item, body)) return found;
    if (body.sensor && !has_area(body.shape))
        return problem(ErrorCode::inconsistent, item, "/sensor", "sensor true and the shape ",
                       quoted(name_of(body.shape)),
                       "; expected a shape with an area, that bodies can be in. Use a box or a capsule.");
    if (auto found = find_position_problem(item, body.position)) return found;
    if (auto found = check(item, "/angle", body.angle, kAngle)) return found;
    if (auto found = find_velocity_problem(item, body.velocity)) return found;
    if (auto found = check(item, "/angular_velocity", body.angular_velocity, kAngularVelocity)) return found;
    if (auto found = find_material_problem(item, "/material", body.material)) return found;
    if (auto found = find_mass_problem(item, body)) return found;
    if (auto found = find_motion_problem(item, body)) return found;
    return find_color_problem(item, body.color);
}

std::optional<Problem> find_inside_problem(const Item& item, const Body& body, const Walls& walls) {
    if (body.type != BodyType::dynamic_body)
        return std::nullopt;  // what walls do not move may stand anywhere
    const auto* compound = std::get_if<Compound>(&body.shape);
    const double radius = is_disc(body.shape) ? radius_of(body.shape)
                          : compound          ? compound_size_of(*compound, body.material).thickest
                                              : convex_shape_of<double>(body.shape).inradius;
    const Axis x{"x",        "/position/0", body.position.x, walls.min.x, walls.max.x,
                 walls.left, walls.right,   "left",          "right"};
    if (auto found = find_axis_problem(item, x, body.shape, radius)) return found;
    const Axis y{"y",          "/position/1", body.position.y, walls.min.y, walls.max.y,
                 walls.bottom, walls.top,     "bottom",        "top"};
    return find_axis_problem(item, y, body.shape, radius);
}

void validate_body(const Body& body, std::string_view where) {
    raise_if(where, find_body_problem(kSingleBody, body));
}

void validate_inside(const Body& body, const Walls& walls, std::string_view where) {
    raise_if(where, find_inside_problem(kSingleBody, body, walls));
}

void validate_position(Vec2 position, std::string_view where) {
    raise_if(where, find_position_problem(kSingleBody, position));
}

void validate_velocity(Vec2 velocity, std::string_view where) {
    raise_if(where, find_velocity_problem(kSingleBody, velocity));
}

void validate_angular_velocity(double angular_velocity, std::string_view where) {
    raise_if(where, check(kSingleBody, "/angular_velocity", angular_velocity, kAngularVelocity));
}

}  // namespace carom
