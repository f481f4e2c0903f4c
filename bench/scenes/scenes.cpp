#include "scenes/scenes.hpp"

#include <carom/generators.hpp>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "measure/gas.hpp"
#include "measure/text.hpp"
#include "scenes/driven_scenes.hpp"
#include "scenes/joint_scenes.hpp"
#include "scenes/shape_scenes.hpp"

namespace carom::bench {
namespace {

constexpr double kGravity = 10;                                           // m/s²
constexpr double kFriction = 0.5;                                         // no unit
constexpr double kGasFriction = 0.3;                                      // no unit
constexpr int kStepsAlike = 10;                                           // of a gas that cools
constexpr RadiusRange kRadii{0.4, 0.6};                                   // m, uniform
constexpr double kMeanArea = std::numbers::pi * (0.25 + 0.2 * 0.2 / 12);  // m², of a disc of those radii
constexpr double kSettledPacking = 0.82;                                  // about what friction leaves
constexpr double kLooseSpacing = 1.3;                                     // m, from centre to centre
constexpr double kLooseJitter = 0.04;                                     // m: the largest discs stay apart
constexpr double kPackedPacking = 0.80;

/// `bodies` discs in rows of `columns` on a lattice whose first body is at `origin`.
void add_discs(Scene& scene, std::int64_t bodies, std::int64_t columns, Vec2 origin, Vec2 spacing,
               bool stagger, double jitter) {
    Lattice lattice;
    lattice.count_x = columns;
    lattice.count_y = (bodies + columns - 1) / columns;
    lattice.origin = origin;
    lattice.spacing = spacing;
    lattice.stagger = stagger;
    lattice.jitter = jitter;
    lattice.radius_range = kRadii;
    lattice.seed = 3;
    add_lattice(scene, lattice);
    scene.bodies.resize(static_cast<std::size_t>(bodies));
    // Here, not in the lattice: a solver without friction refuses the scene then, not the generator.
    for (Body& body : scene.bodies) body.material.friction = kFriction;
}

/// A box open at the top, as wide as the settled pile is high.
Scene open_box(std::int64_t bodies) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    const double width = std::sqrt(kMeanArea * static_cast<double>(bodies) / kSettledPacking);
    scene.walls.emplace();
    scene.walls->max = {width, 10 * width};
    scene.walls->top = false;
    scene.walls->material.friction = kFriction;
    return scene;
}

BenchScene pile(std::int64_t bodies) {
    Scene scene = open_box(bodies);
    const double first = kRadii.max + kLooseJitter;
    const double room = scene.walls->max.x - 2 * first;
    const auto columns = std::max<std::int64_t>(1, static_cast<std::int64_t>(room / kLooseSpacing) + 1);
    add_discs(scene, bodies, columns, {first, first}, {kLooseSpacing, kLooseSpacing}, false, kLooseJitter);
    return {"pile", std::move(scene), {}, bodies > 1000 ? 2400 : 1200};
}

/// Hexagonal rows at the packing fraction; large neighbours overlap at the start and are pushed apart.
BenchScene packed(std::int64_t bodies) {
    Scene scene = open_box(bodies);
    const double spacing = std::sqrt(2 / std::sqrt(3.0) * kMeanArea / kPackedPacking);
    const double room = scene.walls->max.x - 2 * kRadii.max - spacing / 2;  // odd rows are shifted
    const auto columns = std::max<std::int64_t>(1, static_cast<std::int64_t>(room / spacing) + 1);
    add_discs(scene, bodies, columns, {kRadii.max, kRadii.max}, {spacing, spacing * std::sqrt(3.0) / 2}, true,
              0);
    return {"packed", std::move(scene), {}, 450};
}

/// The gas, whose discs rub from now on. It cools, by a tenth in so many steps.
BenchScene rough_gas(std::int64_t bodies) {
    Scene scene = measure::flown_gas_scene(bodies);
    for (Body& body : scene.bodies) body.material.friction = kGasFriction;
    scene.walls->material.friction = kGasFriction;
    return {"rough-gas", std::move(scene), {}, 6, kStepsAlike};
}

/// Half of the container is filled; its speed makes the centrifugal acceleration at a wall a twentieth of
/// gravity.
BenchScene tumbler(std::int64_t bodies) {
    constexpr double kCentrifugal = 0.05;
    Container container;
    container.side = std::sqrt(2 * kMeanArea * static_cast<double>(bodies) / kSettledPacking);
    container.angular_velocity = std::sqrt(kCentrifugal * kGravity / (container.side / 2));
    Scene scene;
    scene.gravity = {0, -kGravity};
    const double half = container.side / 2, first = kRadii.max + kLooseJitter;
    const auto columns = static_cast<std::int64_t>((container.side - 2 * first) / kLooseSpacing) + 1;
    add_discs(scene, bodies, columns, {first - half, first - half}, {kLooseSpacing, kLooseSpacing}, false,
              kLooseJitter);
    return {"tumbler", std::move(scene), container, 600};
}

}  // namespace

const std::vector<std::string>& scene_names() {
    static const std::vector<std::string> names{"gas",
                                                "rough-gas",
                                                "pile",
                                                "packed",
                                                "tumbler",
                                                "pyramid",
                                                "pyramid-start",
                                                "box-pile",
                                                "box-pile-start",
                                                "mixed-pile",
                                                "mixed-pile-start",
                                                "smash",
                                                "planks",
                                                "planks-start",
                                                "driven-drum",
                                                "spinner",
                                                "net",
                                                "ragdolls",
                                                "car",
                                                "chain",
                                                "stairs"};
    return names;
}

// Steps: the pyramid closes its gaps, what is dropped has fallen on each other.
constexpr int kStartOfPyramid = 120, kStartOfPile = 300;

BenchScene make_scene(const std::string& name, std::int64_t bodies) {
    if (name == "gas") return {"gas", measure::flown_gas_scene(bodies), {}, 6};
    if (name == "rough-gas") return rough_gas(bodies);
    if (name == "pile") return pile(bodies);
    if (name == "packed") return packed(bodies);
    if (name == "tumbler") return tumbler(bodies);
    if (name == "pyramid") return pyramid(bodies);
    if (name == "pyramid-start") return start_of(pyramid(bodies), kStartOfPyramid);
    if (name == "box-pile") return box_pile(bodies);
    if (name == "box-pile-start") return start_of(box_pile(bodies), kStartOfPile);
    if (name == "mixed-pile") return mixed_pile(bodies);
    if (name == "mixed-pile-start") return start_of(mixed_pile(bodies), kStartOfPile);
    if (name == "smash") return smash(bodies);
    if (name == "planks") return planks(bodies);
    if (name == "planks-start") return start_of(planks(bodies), kStartOfPile);
    if (name == "driven-drum") return driven_drum(bodies);
    if (name == "spinner") return spinner(bodies);
    if (name == "net") return net(bodies);
    if (name == "ragdolls") return ragdolls(bodies);
    if (name == "car") return car(bodies);
    if (name == "chain") return chain(bodies);
    if (name == "stairs") return stairs(bodies);
    throw std::invalid_argument(measure::joined("no benchmark scene is called ", name));
}

}  // namespace carom::bench
