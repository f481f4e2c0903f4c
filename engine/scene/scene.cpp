#include <carom/scene.hpp>

#include "scene/choose_solver.hpp"
#include "scene/validation/limits.hpp"
#include "scene/validation/validation.hpp"
#include "shapes/compound.hpp"
#include "shapes/convex_geometry.hpp"
#include "shapes/mass.hpp"

#include <utility>

namespace carom {
namespace {

constexpr Item kBodiesItem{"the scene has", "/bodies", -1, ""};

Problem too_many_bodies(std::size_t count) {
    return problem(ErrorCode::too_large, kBodiesItem, "", count, " bodies; expected at most ",
                   kLargestBodyCount, ". Split the scene.");
}

/// The smallest and the largest radius so far, and whose they are. What is no disc has two: of the disc in it
/// and of the one around it.
struct RadiusSpread {
    double smallest = kLargestRadius, largest = 0;
    std::size_t smallest_body = 0, largest_body = 0;
    std::string_view largest_shape = "disc/radius";

    void take(double inradius, double extent, std::size_t body, std::string_view shape) {
        if (inradius < smallest) smallest = inradius, smallest_body = body;
        if (extent > largest) largest = extent, largest_body = body, largest_shape = shape;
    }
    void take(const Body& of, std::size_t body) {
        const Shape& shape = of.shape;
        if (const auto* compound = std::get_if<Compound>(&shape)) {
            const CompoundSize size = compound_size_of(*compound, of.material);
            return take(size.thinnest, size.extent, body, name_of(shape));
        }
        if (!is_convex(shape)) return;
        if (is_disc(shape)) return take(radius_of(shape), radius_of(shape), body, "disc/radius");
        const ConvexShape<double> convex = convex_shape_of<double>(shape);
        take(convex.inradius, convex.extent, body, name_of(shape));
    }
};

std::optional<Problem> find_spread_problem(const RadiusSpread& spread) {
    if (spread.largest <= kLargestRadiusRatio * spread.smallest || spread.largest == 0) return std::nullopt;
    const Item item{"body", "/bodies", static_cast<std::ptrdiff_t>(spread.largest_body), ""};
    return problem(ErrorCode::out_of_range, item, join("/shape/", spread.largest_shape), "radius ",
                   spread.largest, " m and body ", spread.smallest_body, " has radius ", spread.smallest,
                   " m; expected the largest radius <= ", kLargestRadiusRatio,
                   " times the smallest. Use walls or static bodies of middle size.");
}

}  // namespace

BodyMass body_mass_of(const Body& body) {
    BodyMass of;
    if (const auto* compound = std::get_if<Compound>(&body.shape)) {
        const CompoundMass sum = compound_mass_of(*compound, body.material);
        of = {sum.mass, sum.centre, sum.inertia};
    } else {
        const MassProperties shape = mass_properties_of(body.shape);
        of = {body.material.density * shape.area, shape.centroid,
              body.material.density * shape.second_moment};
    }
    if (!body.mass || !(of.mass > 0)) return of;
    of.inertia *= *body.mass / of.mass;
    of.mass = *body.mass;
    return of;
}

BodyId Scene::add(Body body) {
    if (bodies.size() >= kLargestBodyCount) raise("Scene::add", too_many_bodies(bodies.size() + 1));
    bodies.push_back(std::move(body));
    return {static_cast<std::uint32_t>(bodies.size() - 1), 0};
}

JointId Scene::add(Joint joint) {
    if (joints.size() >= kLargestJointCount)
        raise("Scene::add",
              problem(ErrorCode::too_large, {"the scene has", "/joints", -1, ""}, "", joints.size() + 1,
                      " joints; expected at most ", kLargestJointCount, ". Split the scene."));
    joints.push_back(std::move(joint));
    return JointId::of(static_cast<std::uint32_t>(joints.size() - 1));
}

std::optional<Problem> Scene::find_problem() const {
    if (bodies.size() > kLargestBodyCount) return too_many_bodies(bodies.size());
    if (auto found = find_settings_problem(*this)) return found;
    RadiusSpread spread;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const Item item{"body", "/bodies", static_cast<std::ptrdiff_t>(i), bodies[i].name};
        if (auto found = find_body_problem(item, bodies[i])) return found;
        if (walls)
            if (auto found = find_inside_problem(item, bodies[i], *walls)) return found;
        spread.take(bodies[i], i);
    }
    if (auto found = find_spread_problem(spread)) return found;
    if (auto found = find_duplicate_name(bodies)) return found;
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const Item item{"joint", "/joints", static_cast<std::ptrdiff_t>(i), ""};
        if (auto found = find_joint_problem(item, joints[i])) return found;
        if (auto found = find_joint_bodies_problem(item, joints[i], *this)) return found;
    }
    if (auto found = find_effects_problem(*this, effects)) return found;
    const Solver solver = choose_solver(*this, accuracy).solver;
    if (auto found = find_iterations_problem(accuracy.iterations, solver)) return found;
    return find_solver_problem(*this, solver);
}

void Scene::validate() const {
    raise_if("Scene", find_problem());
}

}  // namespace carom
