// B27 of docs/hard-cases.md for boxes: no side is preferred where two fall on each other and where a tower
// stands, no direction is up, and the order of the bodies does not matter.
#include "support/box_scenes.hpp"
#include "support/report.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace test_box_symmetries {

using namespace carom;
using namespace carom::test;

namespace {

/// Boxes, tilted and aside, that fall on each other.
Scene falling_boxes(int boxes, double restitution) {
    Scene scene = box_ground(0.5);
    for (int i = 0; i < boxes; ++i) {
        const auto some = [&](int which) { return jitter_of(static_cast<std::uint64_t>(5 * i + which)); };
        Body box = box_at(0.4 * some(0), 0.7 + 1.1 * i, 1, 0.6 + 0.2 * some(1), 0.5, 0.2 * some(2));
        box.velocity = {0.5 * some(3), 0};
        box.angular_velocity = some(4);
        box.material.restitution = restitution;
        scene.add(box);
    }
    return scene;
}

Scene mirrored(Scene scene) {
    for (Body& body : scene.bodies) {
        body.position.x *= -1, body.velocity.x *= -1;
        body.angle *= -1, body.angular_velocity *= -1;
    }
    return scene;
}

/// Largest difference of a run from the mirror image of the mirrored scene's, after 100 steps [m, rad].
double asymmetry(const Scene& scene) {
    BoxRun<double> run(scene), image(mirrored(scene));
    run.steps(100), image.steps(100);
    double largest = 0;
    for (std::size_t i = 0; i <= run.last(); ++i)
        largest = std::max({largest, std::fabs(run.place(i).x + image.place(i).x),
                            std::fabs(run.place(i).y - image.place(i).y),
                            std::fabs(run.angle(i) + image.angle(i))});
    return largest;
}

/// The scene and gravity turned by a quarter, counter-clockwise.
Scene turned(Scene scene) {
    const auto turn = [](Vec2 v) { return Vec2{-v.y, v.x}; };
    scene.gravity = turn(scene.gravity);
    for (Body& body : scene.bodies) {
        body.position = turn(body.position), body.velocity = turn(body.velocity);
        body.angle += std::numbers::pi / 2;
    }
    return scene;
}

}  // namespace

TEST_SUITE("hard cases/box symmetries") {
    TEST_CASE("B27: boxes that fall and their mirror image agree to 1e-9 m after 100 steps") {
        for (const int boxes : {1, 2})
            for (const double restitution : {0.0, 0.5}) {
                const double difference = asymmetry(falling_boxes(boxes, restitution));
                report("B27: ", boxes, " boxes, restitution ", restitution, ": mirrored off by ", difference);
                CHECK(difference < 1e-9);
            }
    }
    TEST_CASE("B27: a tower of boxes and its mirror image agree to 1e-9 m after 100 steps") {
        const double difference = asymmetry(tower(12, 0.02, 77));
        report("B27: tower, mirrored off by ", difference);
        CHECK(difference < 1e-9);
    }
    TEST_CASE("B27: a tower that is turned by a right angle, or built in another order, agrees to 1e-9 m") {
        const Scene scene = tower(12, 0.02, 77);
        Scene other_order = scene;
        std::reverse(other_order.bodies.begin(), other_order.bodies.end());
        BoxRun<double> run(scene), aside(turned(scene)), permuted(other_order);
        run.steps(100), aside.steps(100), permuted.steps(100);
        double of_turned = 0, of_permuted = 0;
        for (std::size_t i = 0; i <= run.last(); ++i) {
            const Vec2 at = run.place(i), there = aside.place(i), again = permuted.place(run.last() - i);
            of_turned = std::max({of_turned, std::fabs(there.x + at.y), std::fabs(there.y - at.x)});
            of_permuted = std::max({of_permuted, std::fabs(again.x - at.x), std::fabs(again.y - at.y)});
        }
        report("B27: tower, turned off by ", of_turned, ", permuted by ", of_permuted);
        CHECK(of_turned < 1e-9);
        CHECK(of_permuted < 1e-9);
    }
}

}  // namespace test_box_symmetries
