#include "support/effort.hpp"

#include <carom/generators.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace test_generators {

using namespace carom;

namespace {

constexpr double kPi = 3.14159265358979323846;

// Taken from gcc 12 on x86-64; gcc and clang, optimised and not, agree.
constexpr std::uint64_t kGoldenGas = 2679954874911174098u, kGoldenMixed = 3988634706704664467u,
                        kGoldenLattice = 13874162215632265636u;

double radius_of(const Body& body) {
    return std::get<Disc>(body.shape).radius;
}

/// The smallest gap between two discs over their radii, by sweeping along x; negative: they overlap.
double smallest_gap(std::vector<Body> bodies) {
    std::sort(bodies.begin(), bodies.end(),
              [](const Body& a, const Body& b) { return a.position.x < b.position.x; });
    double largest = 0;
    for (const Body& body : bodies) largest = std::max(largest, radius_of(body));
    double smallest = 1e300;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        for (std::size_t j = i + 1; j < bodies.size(); ++j) {
            const Vec2 a = bodies[i].position, b = bodies[j].position;
            const double reach = radius_of(bodies[i]) + radius_of(bodies[j]);
            if (b.x - a.x > 2 * largest) break;
            smallest = std::min(smallest, std::hypot(b.x - a.x, b.y - a.y) - reach);
        }
    return smallest;
}

bool inside(const Body& body, const Walls& walls) {
    const double r = radius_of(body);
    return body.position.x - r >= walls.min.x && body.position.x + r <= walls.max.x &&
           body.position.y - r >= walls.min.y && body.position.y + r <= walls.max.y;
}

/// A scene with a box of those proportions that a gas fills to that packing fraction.
Scene box_for(const Gas& gas, double packing, double width_over_height, Vec2 min) {
    const double a = gas.radius.min, b = gas.radius.max;
    const double area = static_cast<double>(gas.count) * kPi * (a * a + a * b + b * b) / 3 / packing;
    const double height = std::sqrt(area / width_over_height);
    Scene scene;
    scene.walls = Walls{.min = min, .max = {min.x + height * width_over_height, min.y + height}};
    return scene;
}

struct Totals {
    double square = 0, mass = 0;
    Vec2 momentum;
};

Totals totals(const std::vector<Body>& bodies) {
    Totals sum;
    for (const Body& body : bodies) {
        const double mass =
            body.mass.value_or(body.material.density * kPi * radius_of(body) * radius_of(body));
        sum.mass += mass;
        sum.square += body.velocity.x * body.velocity.x + body.velocity.y * body.velocity.y;
        sum.momentum = {sum.momentum.x + mass * body.velocity.x, sum.momentum.y + mass * body.velocity.y};
    }
    return sum;
}

/// FNV-1a over the bits of position, velocity and radius.
std::uint64_t hash_of(const std::vector<Body>& bodies) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const Body& body : bodies)
        for (const double value :
             {body.position.x, body.position.y, body.velocity.x, body.velocity.y, radius_of(body)}) {
            hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3u;
        }
    return hash;
}

template <class Generator>
void check_refused(const Generator& generator, ErrorCode code, const std::string& pointer,
                   const std::string& words) {
    const auto found = find_problem(generator);
    REQUIRE(found.has_value());
    CAPTURE(found->statement);
    CHECK(found->code == code);
    CHECK(found->pointer == pointer);
    CHECK(found->statement.find(words) != std::string::npos);
}

}  // namespace

TEST_SUITE("scene/generators") {
    TEST_CASE("a gas overlaps neither itself nor the walls, whatever its radii, its density and its box") {
        const RadiusRange kRadii[] = {{0.5, 0.5}, {0.4, 0.6}, {0.01, 0.5}, {1e-5, 1e-5}};
        for (const std::int64_t count : {1, 2, 7, 100, 4000})
            for (const RadiusRange& radius : kRadii)
                for (const double packing : {0.001, 0.1, 0.4, 0.6, 0.70})
                    for (const double proportion : {1.0, 0.3, 4.0}) {
                        if (count < 100 && packing > 0.3) continue;  // may truly not fit
                        if (test::is_effort_reduced() && count == 4000 && proportion != 1) continue;
                        if (packing == 0.70 && count == 100 && (proportion != 1 || radius.max > radius.min))
                            continue;
                        CAPTURE(count);
                        CAPTURE(packing);
                        CAPTURE(radius.max);
                        const Gas gas{.count = count, .radius = radius, .seed = 3};
                        Scene scene = box_for(gas, packing, proportion, {-7, 100});
                        add_gas(scene, gas);
                        REQUIRE(scene.bodies.size() == static_cast<std::size_t>(count));
                        CHECK(smallest_gap(scene.bodies) >= 0);
                        CHECK(std::all_of(scene.bodies.begin(), scene.bodies.end(),
                                          [&](const Body& body) { return inside(body, *scene.walls); }));
                        CHECK_FALSE(scene.find_problem().has_value());
                    }
    }

    TEST_CASE("a gas of one radius fits up to a packing fraction of 0.85 when there are many") {
        const Gas gas{.count = 10000, .seed = 1};
        Scene scene = box_for(gas, 0.85, 1, {0, 0});
        add_gas(scene, gas);
        CHECK(smallest_gap(scene.bodies) >= 0);
    }

    TEST_CASE("what does not fit is refused, and the scene stays as it was") {
        Scene scene;
        scene.walls = Walls{.min = {0, 0}, .max = {10, 10}};
        scene.add({.position = {5, 5}});
        for (const Gas& gas :
             {Gas{.count = 120}, Gas{.count = 120, .radius = {0.45, 0.55}}, Gas{.radius = {6, 6}}}) {
            const auto found = find_problem(gas, scene);
            REQUIRE(found.has_value());
            CHECK(found->pointer == "/count");
            CHECK(found->code == ErrorCode::out_of_range);
            CHECK(found->statement.find("does not fit") != std::string::npos);
            CHECK_THROWS_AS(add_gas(scene, gas), Error);
            CHECK(scene.bodies.size() == 1);
        }
    }

    TEST_CASE("a gas has the root mean square speed asked for, and no momentum") {
        for (const RadiusRange radius : {RadiusRange{0.5, 0.5}, RadiusRange{0.1, 0.5}})
            for (const std::int64_t count : {2, 3, 1000}) {
                const Gas gas{.count = count, .radius = radius, .velocity_rms = 3, .seed = 5};
                Scene scene = box_for(gas, 0.1, 1, {0, 0});
                add_gas(scene, gas);
                const Totals sum = totals(scene.bodies);
                CHECK(std::sqrt(sum.square / static_cast<double>(count)) ==
                      doctest::Approx(3).epsilon(1e-14));
                CHECK(std::abs(sum.momentum.x) <= 1e-13 * sum.mass);
                CHECK(std::abs(sum.momentum.y) <= 1e-13 * sum.mass);
            }
    }

    TEST_CASE("random velocities have the second and fourth moment of a normal distribution, nearly") {
        const Gas gas{.count = 20000, .velocity_rms = 1, .seed = 11};
        Scene scene = box_for(gas, 0.4, 1, {0, 0});
        add_gas(scene, gas);
        double x2 = 0, x4 = 0;
        for (const Body& body : scene.bodies) {
            const double square = body.velocity.x * body.velocity.x;
            x2 += square;
            x4 += square * square;
        }
        x2 /= 20000;
        x4 /= 20000;
        CHECK(x2 == doctest::Approx(0.5).epsilon(0.03));
        CHECK(x4 / (x2 * x2) == doctest::Approx(2.9).epsilon(0.05));
    }

    TEST_CASE("the same description gives the same bits on every machine, another seed gives others") {
        const auto hash = [](const Gas& gas, double packing) {
            Scene scene = box_for(gas, packing, 1, {0, 0});
            add_gas(scene, gas);
            return hash_of(scene.bodies);
        };
        const Gas gas{.count = 1000, .velocity_rms = 3, .seed = 1};
        const Gas mixed{.count = 1000, .radius = {0.2, 0.6}, .velocity_rms = 3, .seed = 1};
        Gas other = gas;
        other.seed = 2;
        CHECK(hash(gas, 0.4) == kGoldenGas);
        CHECK(hash(mixed, 0.7) == kGoldenMixed);
        CHECK(hash(other, 0.4) != kGoldenGas);
        Scene scene;
        add_lattice(scene, {.count_x = 20,
                            .count_y = 10,
                            .jitter = 0.1,
                            .radius_range = RadiusRange{0.1, 0.3},
                            .velocity_rms = 2,
                            .seed = 9});
        CHECK(hash_of(scene.bodies) == kGoldenLattice);
    }

    TEST_CASE("a lattice goes row by row from the bottom, staggered rows half a spacing to the right") {
        Scene scene;
        scene.add(Body{});
        const BodyId first = add_lattice(scene, {.count_x = 3,
                                                 .count_y = 2,
                                                 .origin = {10, 20},
                                                 .spacing = {2, 3},
                                                 .stagger = true,
                                                 .body = {.shape = Disc{0.25}, .color = "#123456"}});
        CHECK(first == BodyId{1, 0});
        REQUIRE(scene.bodies.size() == 7);
        const Vec2 kExpected[] = {{10, 20}, {12, 20}, {14, 20}, {11, 23}, {13, 23}, {15, 23}};
        for (std::size_t i = 0; i < 6; ++i) {
            CHECK(scene.bodies[i + 1].position == kExpected[i]);
            CHECK(radius_of(scene.bodies[i + 1]) == 0.25);
            CHECK(scene.bodies[i + 1].color == "#123456");
        }
    }

    TEST_CASE("jitter, radii and random velocities stay within what was asked for") {
        Scene scene;
        add_lattice(scene, {.count_x = 50,
                            .count_y = 40,
                            .jitter = 0.2,
                            .radius_range = RadiusRange{0.1, 0.3},
                            .velocity_rms = 2,
                            .seed = 4});
        double least = 1, most = 0, moved = 0;
        for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
            const Body& body = scene.bodies[i];
            least = std::min(least, radius_of(body));
            most = std::max(most, radius_of(body));
            moved = std::max({moved, std::abs(body.position.x - static_cast<double>(i % 50)),
                              std::abs(body.position.y - static_cast<double>(i / 50))});
        }
        CHECK(least >= 0.1);
        CHECK(least < 0.101);
        CHECK(most <= 0.3);
        CHECK(most > 0.299);
        CHECK(moved <= 0.2 + 1e-12);
        CHECK(moved > 0.19);
        const Totals sum = totals(scene.bodies);
        CHECK(std::sqrt(sum.square / 2000) == doctest::Approx(2).epsilon(1e-14));
        CHECK(std::abs(sum.momentum.x) <= 1e-13 * sum.mass);
    }

    TEST_CASE("a stack's discs touch without a gap, and stand a gap apart with one") {
        Scene scene;
        add_stack(scene, {.count = 3, .origin = {1, 0.5}, .body = {.shape = Disc{0.5}}});
        add_stack(scene, {.count = 2, .origin = {5, 0.5}, .gap = 0.25, .body = {.shape = Disc{0.5}}});
        const Vec2 kExpected[] = {{1, 0.5}, {1, 1.5}, {1, 2.5}, {5, 0.5}, {5, 1.75}};
        REQUIRE(scene.bodies.size() == 5);
        for (std::size_t i = 0; i < 5; ++i) CHECK(scene.bodies[i].position == kExpected[i]);
    }

    TEST_CASE("wrong settings of a generator are refused, with their place and value") {
        check_refused(Lattice{.count_x = 0}, ErrorCode::out_of_range, "/count/0", "the lattice has count 0");
        check_refused(Lattice{.count_y = -4}, ErrorCode::out_of_range, "/count/1", "count -4");
        check_refused(Lattice{.count_x = 60000, .count_y = 60000}, ErrorCode::too_large, "/count",
                      "count 3.6e+09");
        check_refused(Lattice{.spacing = {-1, 1}}, ErrorCode::out_of_range, "/spacing/0", "spacing -1 m");
        check_refused(Lattice{.jitter = -0.1}, ErrorCode::out_of_range, "/jitter", "jitter -0.1 m");
        check_refused(Lattice{.radius_range = RadiusRange{0.5, 0.2}}, ErrorCode::inconsistent,
                      "/radius_range", "radius_range [0.5, 0.2] m");
        check_refused(Lattice{.radius_range = RadiusRange{0, 0.2}}, ErrorCode::out_of_range,
                      "/radius_range/0", "radius 0 m");
        check_refused(Lattice{.body = {.name = "x"}}, ErrorCode::inconsistent, "/name", "names are unique");
        check_refused(Lattice{.body = {.mass = -1}}, ErrorCode::out_of_range, "/mass", "mass -1 kg");
        check_refused(Lattice{.count_x = 2, .velocity_rms = -1}, ErrorCode::out_of_range, "/velocity_rms",
                      "-1 m/s");
        check_refused(Lattice{.velocity_rms = 1}, ErrorCode::inconsistent, "/velocity_rms", "one body");
        check_refused(Lattice{.count_x = 2, .velocity_rms = 1, .body = {.type = BodyType::kinematic_body}},
                      ErrorCode::inconsistent, "/velocity_rms", "not dynamic");
        check_refused(Stack{.count = 0}, ErrorCode::out_of_range, "/count", "the stack has count 0");
        check_refused(Stack{.gap = -1}, ErrorCode::out_of_range, "/gap", "gap -1 m");
        check_refused(Stack{.body = {.shape = Disc{0}}}, ErrorCode::out_of_range, "/shape/disc/radius",
                      "radius 0 m");
    }

    TEST_CASE("a gas needs walls") {
        const auto found = find_problem(Gas{}, Scene{});
        REQUIRE(found.has_value());
        CHECK(found->code == ErrorCode::inconsistent);
        CHECK(found->statement.find("no walls") != std::string::npos);
    }
}

}  // namespace test_generators
