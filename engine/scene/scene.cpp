#include <carom/scene.hpp>

#include "scene/choose_solver.hpp"
#include "scene/limits.hpp"
#include "scene/mass.hpp"
#include "scene/validation.hpp"

#include <utility>

namespace carom {
namespace {

constexpr Item kBodiesItem{"the scene has", "/bodies", -1, ""};

Problem too_many_bodies(std::size_t count) {
    return problem(ErrorCode::too_large, kBodiesItem, "", count, " bodies; expected at most ",
                   kLargestBodyCount, ". Split the scene.");
}

/// The smallest and the largest radius so far, and whose they are.
struct RadiusSpread {
    double smallest = kLargestRadius, largest = 0;
    std::size_t smallest_body = 0, largest_body = 0;

    void take(double radius, std::size_t body) {
        if (radius < smallest) smallest = radius, smallest_body = body;
        if (radius > largest) largest = radius, largest_body = body;
    }
};

std::optional<Problem> find_spread_problem(const RadiusSpread& spread) {
    if (spread.largest <= kLargestRadiusRatio * spread.smallest || spread.largest == 0) return std::nullopt;
    const Item item{"body", "/bodies", static_cast<std::ptrdiff_t>(spread.largest_body), ""};
    return problem(ErrorCode::out_of_range, item, "/shape/disc/radius", "radius ", spread.largest,
                   " m and body ", spread.smallest_body, " has radius ", spread.smallest,
                   " m; expected the largest radius <= ", kLargestRadiusRatio,
                   " times the smallest. Use walls or static bodies of middle size.");
}

}  // namespace

BodyId Scene::add(Body body) {
    if (bodies.size() >= kLargestBodyCount) raise("Scene::add", too_many_bodies(bodies.size() + 1));
    bodies.push_back(std::move(body));
    return {static_cast<std::uint32_t>(bodies.size() - 1), 0};
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
        if (is_disc(bodies[i].shape)) spread.take(radius_of(bodies[i].shape), i);
    }
    if (auto found = find_spread_problem(spread)) return found;
    if (auto found = find_duplicate_name(bodies)) return found;
    if (auto found = find_effects_problem(*this, effects)) return found;
    const Solver solver = choose_solver(*this, accuracy).solver;
    if (auto found = find_iterations_problem(accuracy.iterations, solver)) return found;
    return find_solver_problem(*this, solver);
}

void Scene::validate() const {
    raise_if("Scene", find_problem());
}

}  // namespace carom
