#include <carom/generators.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/validation/limits.hpp"
#include "scene/validation/validation.hpp"

// Generators of joined bodies.

namespace carom {
namespace {

constexpr Quantity kCountOfJoinedBodies{"count", "", 1, static_cast<double>(kLargestBodyCount),
                                        "Give whole numbers."};
constexpr Quantity kSpacingOfJoinedBodies{"spacing", "m", kShortestRod, kLargestPosition, kUseMetres};

std::optional<Problem> check_count(const Item& item, std::string_view tail, std::int64_t count) {
    return check(item, tail, static_cast<double>(count), kCountOfJoinedBodies);
}

/// A link of the kind asked for, with its anchor midway.
JointKind link_at(JointKind kind, Vec2 anchor) {
    if (auto* hinge = std::get_if<RevoluteJoint>(&kind)) hinge->anchor = anchor;
    if (auto* weld = std::get_if<WeldJoint>(&kind)) weld->anchor = anchor;
    return kind;
}

std::optional<Problem> check_link(const Item& item, const JointKind& link) {
    if (std::holds_alternative<DistanceJoint>(link) || std::holds_alternative<RevoluteJoint>(link) ||
        std::holds_alternative<WeldJoint>(link))
        return std::nullopt;
    return problem(
        ErrorCode::inconsistent, item, "/joint",
        "links that are neither distance, revolute nor weld joints; expected one of these. Add others "
        "to \"joints\", one by one.");
}

void make_room(const Scene& scene, double bodies, double joints, std::string_view where) {
    if (static_cast<double>(scene.bodies.size()) + bodies <= static_cast<double>(kLargestBodyCount) &&
        static_cast<double>(scene.joints.size()) + joints <= static_cast<double>(kLargestJointCount))
        return;
    throw Error(ErrorCode::too_large,
                join(where, ": the scene would have more than ", kLargestBodyCount, " bodies or ",
                     kLargestJointCount, " joints. Make fewer of them."));
}

BodyId id_at(std::size_t index) {
    return {static_cast<std::uint32_t>(index), 0};
}

}  // namespace

std::optional<Problem> find_problem(const BodyChain& chain) {
    static constexpr Item kItem{"the chain has", "", -1, ""};
    if (auto found = check_count(kItem, "/count", chain.count)) return found;
    if (auto found = check(kItem, "/spacing", chain.spacing, kSpacingOfJoinedBodies)) return found;
    const double squared = chain.direction.x * chain.direction.x + chain.direction.y * chain.direction.y;
    if (!(squared > 0) || squared - squared != 0)
        return problem(ErrorCode::out_of_range, kItem, "/direction", "direction ", chain.direction,
                       "; expected a vector that is not zero. Give one such as [1, 0].");
    return check_link(kItem, chain.link);
}

std::optional<Problem> find_problem(const Net& net) {
    static constexpr Item kItem{"the net has", "", -1, ""};
    if (auto found = check_count(kItem, "/count/0", net.count_x)) return found;
    if (auto found = check_count(kItem, "/count/1", net.count_y)) return found;
    if (auto found = check(kItem, "/spacing/0", net.spacing.x, kSpacingOfJoinedBodies)) return found;
    if (auto found = check(kItem, "/spacing/1", net.spacing.y, kSpacingOfJoinedBodies)) return found;
    return check_link(kItem, net.link);
}

BodyId add_chain(Scene& scene, const BodyChain& chain) {
    raise_if("add_chain", find_problem(chain));
    make_room(scene, static_cast<double>(chain.count), static_cast<double>(chain.count), "add_chain");
    const double length =
        std::sqrt(chain.direction.x * chain.direction.x + chain.direction.y * chain.direction.y);
    const Vec2 way{chain.spacing / length * chain.direction.x, chain.spacing / length * chain.direction.y};
    const auto at = [&](double number) {
        return Vec2{chain.origin.x + number * way.x, chain.origin.y + number * way.y};
    };
    const std::size_t first = scene.bodies.size();
    for (std::int64_t i = 0; i < chain.count; ++i) {
        const auto number = static_cast<double>(i);
        Body body = chain.body;
        body.position = at(number);
        const BodyId id = scene.add(std::move(body));
        if (i > 0)
            scene.add(
                Joint{.a = id_at(id.index - 1u), .b = id, .kind = link_at(chain.link, at(number - 0.5))});
        else if (chain.pinned)
            scene.add(Joint{.b = id,
                            .kind = std::holds_alternative<DistanceJoint>(chain.link)
                                        ? JointKind(RevoluteJoint{})
                                        : link_at(chain.link, at(-0.5))});
    }
    return id_at(first);
}

BodyId add_net(Scene& scene, const Net& net) {
    raise_if("add_net", find_problem(net));
    const double bodies = static_cast<double>(net.count_x) * static_cast<double>(net.count_y);
    make_room(scene, bodies, 2 * bodies, "add_net");
    std::int32_t group = -1;
    for (const Body& body : scene.bodies) group = std::min(group, body.group - 1);
    const std::size_t first = scene.bodies.size();
    const auto nx = static_cast<std::size_t>(net.count_x), ny = static_cast<std::size_t>(net.count_y);
    const auto place = [&](double x, double y) {
        return Vec2{net.origin.x + x * net.spacing.x, net.origin.y + y * net.spacing.y};
    };
    for (std::size_t y = 0; y < ny; ++y)
        for (std::size_t x = 0; x < nx; ++x) {
            Body body = net.body;
            body.position = place(static_cast<double>(x), static_cast<double>(y));
            body.group = group;
            const bool is_corner = x == 0 || x + 1 == nx;
            if (y + 1 == ny &&
                (net.pinned == Net::Pinned::top || (net.pinned == Net::Pinned::corners && is_corner)))
                body.type = BodyType::static_body, body.velocity = {}, body.angular_velocity = 0;
            scene.add(std::move(body));
        }
    const auto add_link = [&](std::size_t a, std::size_t b, Vec2 middle) {
        const auto moves = [&](std::size_t body) {
            return scene.bodies[body].type == BodyType::dynamic_body;
        };
        if (moves(a) || moves(b))
            scene.add(Joint{.a = id_at(a), .b = id_at(b), .kind = link_at(net.link, middle)});
    };
    for (std::size_t y = 0; y < ny; ++y)
        for (std::size_t x = 0; x < nx; ++x) {
            const std::size_t at = first + y * nx + x;
            const auto px = static_cast<double>(x), py = static_cast<double>(y);
            if (x + 1 < nx) add_link(at, at + 1, place(px + 0.5, py));
            if (y + 1 < ny) add_link(at, at + nx, place(px, py + 0.5));
        }
    return id_at(first);
}

}  // namespace carom
