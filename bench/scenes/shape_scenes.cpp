#include "scenes/shape_scenes.hpp"

#include <carom/generators.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace carom::bench {
namespace {

constexpr double kGravity = 10;                   // m/s²
constexpr double kPileFriction = 0.5;             // no unit, as the pile of discs has it
constexpr double kFriction = 0.6;                 // no unit, the default of Box2D, whose pyramid this is
constexpr RadiusRange kHalfSides{0.4, 0.6};       // m, uniform; of discs and capsules the radii
constexpr double kLoosePart = 1.02;               // spacing of a loose grid over the largest diameter
constexpr double kSettledPacking = 0.82;          // about what friction leaves
constexpr int kCalmAfter = 300;                   // steps
constexpr int kSettleFew = 1200, kSettle = 2400;  // steps, of up to 1,000 bodies and of more

/// The same numbers on every machine. Source: splitmix64, Steele, Lea and Flood 2014.
class Random {
  public:
    double between(double low, double high) { return low + (high - low) * unit(); }
    double in(const RadiusRange& range) { return between(range.min, range.max); }
    double angle() { return between(-std::numbers::pi, std::numbers::pi); }
    int whole(int low, int high) { return std::min(high, low + static_cast<int>(unit() * (high - low + 1))); }

  private:
    double unit() {
        state_ += 0x9e3779b97f4a7c15u;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    std::uint64_t state_ = 3;
};

/// Closed at the bottom, y = 0, and at the sides if there are any.
Scene open_box(double left, double right, bool has_sides, double friction) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls.emplace();
    scene.walls->min = {left, 0}, scene.walls->max = {right, 10 * (right - left)};
    scene.walls->left = scene.walls->right = has_sides;
    scene.walls->top = false;
    scene.walls->material.friction = friction;
    return scene;
}

/// Bodies of `shape_of` at any angle on a loose grid in a box that is as wide as their pile will be high.
template <class ShapeOf>
BenchScene dropped(const char* name, std::int64_t bodies, double diameter, const ShapeOf& shape_of) {
    Random random;
    std::vector<Shape> shapes;
    double area = 0;
    for (std::int64_t i = 0; i < bodies; ++i) {
        shapes.push_back(shape_of(random, i));
        area += mass_properties_of(shapes.back()).area;
    }
    const double width = std::max(std::sqrt(area / kSettledPacking), 2 * diameter);
    const double spacing = kLoosePart * diameter;
    Scene scene = open_box(0, width, true, kPileFriction);
    Lattice lattice;
    lattice.count_x = static_cast<std::int64_t>((width - diameter) / spacing) + 1;
    lattice.count_y = (bodies + lattice.count_x - 1) / lattice.count_x;
    lattice.origin = {diameter / 2, diameter / 2};
    lattice.spacing = {spacing, spacing};
    lattice.body.material.friction = kPileFriction;
    add_lattice(scene, lattice);
    scene.bodies.resize(static_cast<std::size_t>(bodies));
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        scene.bodies[i].shape = shapes[i];
        scene.bodies[i].angle = random.angle();
    }
    return {name, std::move(scene), {}, bodies > 1000 ? kSettle : kSettleFew};
}

Box random_box(Random& random) {
    const double width = 2 * random.in(kHalfSides);
    return {width, 2 * random.in(kHalfSides)};
}

/// Its vertices lie on a circle, at equal angles.
Polygon regular_polygon(int vertices, double radius) {
    Polygon polygon;
    for (int k = 0; k < vertices; ++k) {
        const double angle = 2 * std::numbers::pi * k / vertices;
        polygon.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return polygon;
}

}  // namespace

BenchScene pyramid(std::int64_t bodies) {
    const double rows = (std::sqrt(8 * static_cast<double>(bodies) + 1) - 1) / 2;
    Pyramid boxes{.base = static_cast<std::int64_t>(std::ceil(rows))};
    const auto base = static_cast<double>(boxes.base);
    boxes.origin = {(1 - base) / 2, 0.5};
    boxes.body.material.friction = kFriction;
    Scene scene = open_box(-base, base, false, kFriction);
    add_pyramid(scene, boxes);
    scene.bodies.resize(static_cast<std::size_t>(bodies));
    return {"pyramid", std::move(scene), {}, kCalmAfter};
}

BenchScene box_pile(std::int64_t bodies) {
    return dropped("box-pile", bodies, 2 * std::numbers::sqrt2 * kHalfSides.max,
                   [](Random& random, std::int64_t) -> Shape { return random_box(random); });
}

BenchScene mixed_pile(std::int64_t bodies) {
    const auto shape_of = [](Random& random, std::int64_t i) -> Shape {
        switch (i % 4) {
            case 0:
                return Disc{random.in(kHalfSides)};
            case 1:
                return random_box(random);
            case 2:
                return Capsule{.length = 0.5, .radius = random.in(kHalfSides) / 2};
            default:
                return regular_polygon(random.whole(3, 8), random.in(kHalfSides));
        }
    };
    return dropped("mixed-pile", bodies, 2 * std::numbers::sqrt2 * kHalfSides.max, shape_of);
}

BenchScene smash(std::int64_t bodies) {
    constexpr double kSide = 5, kDensity = 8, kSpeed = 40;  // m, kg/m², m/s
    constexpr double kGap = 0.01;                           // m, between the boxes of the wall
    Scene scene;
    const auto others = static_cast<double>(bodies - 1);
    Lattice wall;
    wall.count_x = std::max<std::int64_t>(1, std::lround(std::sqrt(others / 2)));
    wall.count_y = (bodies - 1 + wall.count_x - 1) / wall.count_x;
    wall.spacing = {1 + kGap, 1 + kGap};
    wall.body.shape = Box{};
    wall.body.material.friction = kFriction;
    scene.add({.shape = Box{kSide, kSide},
               .position = {-kSide, 0.5 * wall.spacing.y * static_cast<double>(wall.count_y - 1)},
               .velocity = {kSpeed, 0},
               .material = {.density = kDensity, .friction = kFriction}});
    if (wall.count_y > 0) add_lattice(scene, wall);
    scene.bodies.resize(static_cast<std::size_t>(bodies));
    return {"smash", std::move(scene), {}, 0, kCalmAfter};
}

BenchScene planks(std::int64_t bodies) {
    constexpr double kLength = 10, kThickness = 0.1, kColumns = 3;  // m
    constexpr double kTilt = 0.02;                                  // rad, at most
    const double spacing = kLoosePart * kLength;
    Scene scene = open_box(0, kColumns * spacing, true, kPileFriction);
    Lattice lattice;
    lattice.count_x = static_cast<std::int64_t>(kColumns);
    lattice.count_y = (bodies + lattice.count_x - 1) / lattice.count_x;
    lattice.origin = {spacing / 2, 0.5};
    lattice.spacing = {spacing, 0.5};
    lattice.body.shape = Box{kLength, kThickness};
    lattice.body.material.friction = kPileFriction;
    add_lattice(scene, lattice);
    scene.bodies.resize(static_cast<std::size_t>(bodies));
    Random random;
    for (Body& body : scene.bodies) body.angle = random.between(-kTilt, kTilt);
    return {"planks", std::move(scene), {}, kSettleFew};
}

BenchScene start_of(BenchScene scene, int steps) {
    scene.name += "-start", scene.settle_steps = 0, scene.restart_steps = steps;
    return scene;
}

}  // namespace carom::bench
