// B43 of docs/hard-cases.md: bodies that are thrown, within a step, at what they had no contact with.
#include <cmath>

#include "support/hard_case.hpp"

namespace test_tunnelling {

using namespace carom;
using namespace carom::test;

TEST_SUITE("hard cases/tunnelling") {
    TEST_CASE_TEMPLATE("B43: no body that is thrown at a plate within a step passes it", Real, float,
                       double) {
        check_cases<Real>(torture::shots_at_plates(extent()));
    }
    TEST_CASE_TEMPLATE("B43: shapes that a drum throws about do not leave it", Real, float, double) {
        check_cases<Real>(torture::shapes_in_a_drum(extent()));
    }
    TEST_CASE_TEMPLATE("B43: what a fast drum carries lies on it", Real, float, double) {
        check_cases<Real>(torture::bodies_in_a_fast_drum(extent()));
    }
    TEST_CASE_TEMPLATE("a box that is thrown at a wall within a step ends that step before it", Real, float,
                       double) {
        for (const double restitution : {0.0, 0.5})
            for (const double speed : {1000.0, 3000.0})  // m/s: 17 and 50 times the box's size a step
                for (const double gap : {1.0, 5.0}) {    // m, between the box and the wall
                    CAPTURE(restitution);
                    CAPTURE(speed);
                    CAPTURE(gap);
                    Scene scene;
                    scene.accuracy.solver = Solver::soft;
                    scene.walls = Walls{.min = {0, 0}, .max = {20, 20}};
                    const double before_wall = 20 - 0.5 - gap;
                    const auto add_box = [&](Vec2 position, Vec2 velocity, double density) {
                        scene.add(
                            {.shape = Box{1, 1},
                             .position = position,
                             .velocity = velocity,
                             .material = {.density = density, .friction = 0.3, .restitution = restitution}});
                    };
                    add_box({before_wall, 10}, {0, 0}, 1);
                    add_box({before_wall - 6, 10.1}, {speed, 0}, 100);
                    BasicWorld<Real> world(scene, {.threads = 1});
                    double farthest = 0;  // m, of a centre from the middle of the walls, along x or y
                    for (int step = 0; step < 120; ++step) {
                        world.step(1.0 / 60);
                        for (std::uint32_t i = 0; i < 2; ++i) {
                            const Vec2 place = world.state({i, 0}).position;
                            farthest = std::fmax(farthest,
                                                 std::fmax(std::fabs(place.x - 10), std::fabs(place.y - 10)));
                        }
                    }
                    CHECK(farthest < 10);
                }
    }
}

}  // namespace test_tunnelling
