#include <carom/generators.hpp>

#include "scene/generators/place_discs.hpp"
#include "scene/generators/random_velocities.hpp"
#include "scene/validation/limits.hpp"
#include "scene/validation/validation.hpp"
#include "shapes/compound.hpp"
#include "shapes/convex_geometry.hpp"
#include "shapes/mass.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <variant>

namespace carom {
namespace {

constexpr Item kLatticeItem{"the lattice has", "", -1, ""};
constexpr Item kStackItem{"the stack has", "", -1, ""};
constexpr Item kPyramidItem{"the pyramid has", "", -1, ""};
constexpr Item kGasItem{"the gas has", "", -1, ""};

constexpr Quantity kCountOfBodies{"count", "", 1, static_cast<double>(kLargestBodyCount),
                                  "Each generator makes at least one body."};
constexpr Quantity kBase{"base", "", 1, static_cast<double>(kLargestBodyCount),
                         "Give the number of boxes in the bottom row."};
constexpr Quantity kSpacingOfBodies{
    "spacing", "m", 0, kLargestPosition,
    "It goes from centre to centre; a gap of 0 between discs is a spacing of 2 radii."};
constexpr Quantity kJitter{"jitter", "m", 0, kLargestPosition,
                           "Give the largest move of a centre, 0 for none."};
constexpr Quantity kGap{"gap", "m", 0, kLargestPosition, "Give the clear distance between neighbours."};
constexpr Quantity kVelocityRms{"velocity_rms", "m/s", 0, kLargestSpeed / 10,
                                "Give a root mean square speed in metres a second."};

std::optional<Problem> check_origin(const Item& item, Vec2 origin) {
    if (auto found = check(item, "/origin/0", origin.x, kPositionX)) return found;
    return check(item, "/origin/1", origin.y, kPositionY);
}

std::optional<Problem> check_range(const Item& item, const RadiusRange& range) {
    if (auto found = check(item, "/radius_range/0", range.min, kRadius)) return found;
    if (auto found = check(item, "/radius_range/1", range.max, kRadius)) return found;
    if (range.min <= range.max) return std::nullopt;
    return problem(ErrorCode::inconsistent, item, "/radius_range", "radius_range ",
                   Vec2{range.min, range.max}, " m; expected min <= max. Swap the two.");
}

/// The body that all others are copies of, with the radius that will be used; then it has to be a disc.
std::optional<Problem> check_pattern(const Item& item, Body body, std::optional<double> radius) {
    if (!body.name.empty())
        return problem(ErrorCode::inconsistent, item, "/name", "a body with the name ", quoted(body.name),
                       "; expected none, as names are unique. Name the bodies after they are made.");
    if (!has_area(body.shape))
        return problem(ErrorCode::inconsistent, item, "/shape", "the shape ", quoted(name_of(body.shape)),
                       "; expected a disc, box, capsule, polygon or compound. Add other shapes one by one.");
    if (radius && !is_disc(body.shape))
        return problem(ErrorCode::inconsistent, item, "/shape", "the shape ", quoted(name_of(body.shape)),
                       " and radii, which are of discs; expected a disc. Leave one of the two out.");
    if (radius) body.shape = Disc{*radius};
    body.position = {};
    return find_body_problem(item, body);
}

std::optional<Problem> check_velocity_rms(const Item& item, double rms, const Body& body,
                                          std::int64_t count) {
    if (auto found = check(item, "/velocity_rms", rms, kVelocityRms)) return found;
    if (rms == 0) return std::nullopt;
    const std::string words = join("velocity_rms ", rms, " m/s but ");
    if (body.type != BodyType::dynamic_body)
        return problem(ErrorCode::inconsistent, item, "/velocity_rms", words,
                       "bodies that are not dynamic; expected 0. Give them a set velocity, or none.");
    if (count < 2)
        return problem(ErrorCode::inconsistent, item, "/velocity_rms", words,
                       "one body, whose momentum cannot be zero then; expected 0. Give the body a velocity.");
    return std::nullopt;
}

std::optional<Problem> check_total(const Item& item, double count) {
    if (count <= static_cast<double>(kLargestBodyCount)) return std::nullopt;
    return problem(ErrorCode::too_large, item, "/count", "count ", count, "; expected at most ",
                   kLargestBodyCount, " bodies. Make fewer of them.");
}

/// Makes sure that they can all be had before the scene changes.
void make_room(Scene& scene, std::int64_t count, std::string_view where) {
    const std::size_t total = scene.bodies.size() + static_cast<std::size_t>(count);
    const Item item{"the scene would have", "", -1, ""};
    raise_if(where, check_total(item, static_cast<double>(total)));
    if (total > scene.bodies.capacity()) scene.bodies.reserve(std::max(total, 2 * scene.bodies.capacity()));
}

BodyId first_of(std::size_t first) {
    return {static_cast<std::uint32_t>(first), 0};
}

Body with_shape(const Body& pattern, double radius) {
    Body body = pattern;
    body.shape = Disc{radius};
    return body;
}

/// How far a body of a pattern reaches from its centre, as it is turned.
double reach_of(const Body& body, Vec2 direction) {
    if (const auto* compound = std::get_if<Compound>(&body.shape))
        return reach_along(*compound, body.material, rotation_by(body.angle), direction);
    return reach_along(convex_shape_of<double>(body.shape), rotation_by(body.angle), direction);
}

/// A gas that fits: the centres come out of these with `random` where it stands.
struct GasPlan {
    Region box;
    SiteLattice lattice;  // unless in rows
    std::vector<double> radius;
    std::vector<Vec2> centres;  // if in rows
    Random random;
};

Problem gas_does_not_fit(const Gas& gas, const Region& box) {
    const double mean_square = (gas.radius.min * gas.radius.min + gas.radius.min * gas.radius.max +
                                gas.radius.max * gas.radius.max) /
                               3;
    const double fraction = static_cast<double>(gas.count) * kPi * mean_square / (box.width() * box.height());
    return problem(ErrorCode::out_of_range, kGasItem, "/count", "count ", gas.count,
                   ", which does not fit: its discs would fill about ", std::round(100 * fraction) / 100,
                   " of the walls' box, ", box.width(), " m by ", box.height(),
                   " m; expected at most about 0.7. Make fewer or smaller discs, or the box larger.");
}

std::variant<GasPlan, Problem> plan_gas(const Gas& gas, const Scene& scene) {
    GasPlan plan{{scene.walls->min, scene.walls->max}, {}, {}, {}, Random(gas.seed)};
    const auto count = static_cast<std::size_t>(gas.count);
    plan.radius.assign(count, gas.radius.min);
    const bool mixed = gas.radius.min < gas.radius.max;
    if (mixed)
        for (double& radius : plan.radius) radius = plan.random.uniform(gas.radius.min, gas.radius.max);
    plan.lattice = roomiest_lattice(plan.box, count, gas.radius.max);
    if (plan.lattice.clearance >= 0) return plan;
    if (mixed) plan.centres = place_in_rows(plan.box, plan.radius, plan.random);
    if (plan.centres.empty()) return gas_does_not_fit(gas, plan.box);
    return plan;
}

std::optional<Problem> find_gas_settings_problem(const Gas& gas, const Scene& scene) {
    if (auto found = check(kGasItem, "/count", static_cast<double>(gas.count), kCountOfBodies)) return found;
    if (auto found = check_range(kGasItem, gas.radius)) return found;
    if (auto found = check_pattern(kGasItem, gas.body, gas.radius.max)) return found;
    if (auto found = check_velocity_rms(kGasItem, gas.velocity_rms, gas.body, gas.count)) return found;
    if (!scene.walls)
        return problem(ErrorCode::inconsistent, kGasItem, "",
                       "no walls to spread between; expected a scene with walls. Give the scene a box.");
    return find_settings_problem(scene);
}

}  // namespace

std::optional<Problem> find_problem(const Lattice& lattice) {
    const auto& item = kLatticeItem;
    const auto count_x = static_cast<double>(lattice.count_x), count_y = static_cast<double>(lattice.count_y);
    if (auto found = check(item, "/count/0", count_x, kCountOfBodies)) return found;
    if (auto found = check(item, "/count/1", count_y, kCountOfBodies)) return found;
    if (auto found = check_total(item, count_x * count_y)) return found;
    if (auto found = check_origin(item, lattice.origin)) return found;
    if (auto found = check(item, "/spacing/0", lattice.spacing.x, kSpacingOfBodies)) return found;
    if (auto found = check(item, "/spacing/1", lattice.spacing.y, kSpacingOfBodies)) return found;
    if (auto found = check(item, "/jitter", lattice.jitter, kJitter)) return found;
    if (lattice.radius_range)
        if (auto found = check_range(item, *lattice.radius_range)) return found;
    std::optional<double> radius;
    if (lattice.radius_range) radius = lattice.radius_range->max;
    if (auto found = check_pattern(item, lattice.body, radius)) return found;
    return check_velocity_rms(item, lattice.velocity_rms, lattice.body, lattice.count_x * lattice.count_y);
}

std::optional<Problem> find_problem(const Stack& stack) {
    if (auto found = check(kStackItem, "/count", static_cast<double>(stack.count), kCountOfBodies))
        return found;
    if (auto found = check_origin(kStackItem, stack.origin)) return found;
    if (auto found = check(kStackItem, "/gap", stack.gap, kGap)) return found;
    return check_pattern(kStackItem, stack.body, std::nullopt);
}

std::optional<Problem> find_problem(const Pyramid& pyramid) {
    const auto base = static_cast<double>(pyramid.base);
    if (auto found = check(kPyramidItem, "/base", base, kBase)) return found;
    if (base * (base + 1) / 2 > static_cast<double>(kLargestBodyCount))
        return problem(ErrorCode::too_large, kPyramidItem, "/base", "base ", base, ", which makes ",
                       base * (base + 1) / 2, " boxes; expected at most ", kLargestBodyCount,
                       " bodies. Give it a shorter row.");
    if (auto found = check_origin(kPyramidItem, pyramid.origin)) return found;
    if (auto found = check(kPyramidItem, "/gap", pyramid.gap, kGap)) return found;
    if (!std::holds_alternative<Box>(pyramid.body.shape))
        return problem(ErrorCode::inconsistent, kPyramidItem, "/shape", "the shape ",
                       quoted(name_of(pyramid.body.shape)),
                       "; expected a box, on which others stand. Use a lattice for other shapes.");
    if (pyramid.body.angle != 0)
        return problem(ErrorCode::inconsistent, kPyramidItem, "/angle", "angle ", pyramid.body.angle,
                       " rad; expected 0, as boxes stand on their sides. Leave it out.");
    return check_pattern(kPyramidItem, pyramid.body, std::nullopt);
}

std::optional<Problem> find_problem(const Gas& gas, const Scene& scene) {
    if (auto found = find_gas_settings_problem(gas, scene)) return found;
    auto plan = plan_gas(gas, scene);
    if (auto* found = std::get_if<Problem>(&plan)) return std::move(*found);
    return std::nullopt;
}

BodyId add_lattice(Scene& scene, const Lattice& lattice) {
    raise_if("add_lattice", find_problem(lattice));
    make_room(scene, lattice.count_x * lattice.count_y, "add_lattice");
    const std::size_t first = scene.bodies.size();
    Random random(lattice.seed);
    for (std::int64_t row = 0; row < lattice.count_y; ++row) {
        const double shift = lattice.stagger && row % 2 == 1 ? lattice.spacing.x / 2 : 0.0;
        for (std::int64_t column = 0; column < lattice.count_x; ++column) {
            Body body = lattice.body;
            body.position.x = lattice.origin.x + (static_cast<double>(column) * lattice.spacing.x + shift);
            body.position.y = lattice.origin.y + static_cast<double>(row) * lattice.spacing.y;
            if (lattice.jitter > 0) {
                body.position.x += random.uniform(-lattice.jitter, lattice.jitter);
                body.position.y += random.uniform(-lattice.jitter, lattice.jitter);
            }
            if (lattice.radius_range)
                body.shape = Disc{random.uniform(lattice.radius_range->min, lattice.radius_range->max)};
            scene.bodies.push_back(std::move(body));
        }
    }
    if (lattice.velocity_rms > 0)
        add_random_velocities(std::span(scene.bodies).subspan(first), lattice.velocity_rms, random);
    return first_of(first);
}

BodyId add_stack(Scene& scene, const Stack& stack) {
    raise_if("add_stack", find_problem(stack));
    make_room(scene, stack.count, "add_stack");
    const std::size_t first = scene.bodies.size();
    const double spacing = reach_of(stack.body, {0, 1}) + reach_of(stack.body, {0, -1}) + stack.gap;
    for (std::int64_t i = 0; i < stack.count; ++i) {
        Body body = stack.body;
        body.position = {stack.origin.x, stack.origin.y + static_cast<double>(i) * spacing};
        scene.bodies.push_back(std::move(body));
    }
    return first_of(first);
}

BodyId add_pyramid(Scene& scene, const Pyramid& pyramid) {
    raise_if("add_pyramid", find_problem(pyramid));
    make_room(scene, pyramid.base * (pyramid.base + 1) / 2, "add_pyramid");
    const std::size_t first = scene.bodies.size();
    const Box& box = std::get<Box>(pyramid.body.shape);
    const Vec2 spacing{box.width + pyramid.gap, box.height + pyramid.gap};
    for (std::int64_t row = 0; row < pyramid.base; ++row)
        for (std::int64_t column = 0; column < pyramid.base - row; ++column) {
            Body body = pyramid.body;
            // Halves are exact, so that both flanks mirror each other as far as the origin lets them.
            body.position.x =
                pyramid.origin.x + (static_cast<double>(column) + 0.5 * static_cast<double>(row)) * spacing.x;
            body.position.y = pyramid.origin.y + static_cast<double>(row) * spacing.y;
            scene.bodies.push_back(std::move(body));
        }
    return first_of(first);
}

BodyId add_gas(Scene& scene, const Gas& gas) {
    raise_if("add_gas", find_gas_settings_problem(gas, scene));
    auto planned = plan_gas(gas, scene);
    if (const auto* found = std::get_if<Problem>(&planned)) raise("add_gas", *found);
    GasPlan& plan = std::get<GasPlan>(planned);
    make_room(scene, gas.count, "add_gas");
    const std::size_t first = scene.bodies.size();
    if (plan.centres.empty())
        plan.centres =
            place_on_lattice(plan.box, plan.lattice, plan.radius.size(), gas.radius.max, plan.random);
    for (std::size_t i = 0; i < plan.radius.size(); ++i) {
        scene.bodies.push_back(with_shape(gas.body, plan.radius[i]));
        scene.bodies.back().position = plan.centres[i];
    }
    if (gas.velocity_rms > 0)
        add_random_velocities(std::span(scene.bodies).subspan(first), gas.velocity_rms, plan.random);
    return first_of(first);
}

}  // namespace carom
