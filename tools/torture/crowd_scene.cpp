#include "torture/crowd_scene.hpp"

#include <carom/generators.hpp>

#include <cmath>
#include <numbers>

#include "torture/runs.hpp"

namespace carom::torture {

Scene falling_crowd(std::int64_t discs, double restitution, double friction, std::uint64_t seed) {
    constexpr double kSmallest = 0.2, kLargest = 0.5;  // m
    constexpr double kWidth = 40, kFill = 0.35,
                     kStart = 5;  // m, of the box for kCrowd; fill; m above the floor
    const double mean_square = (kSmallest * kSmallest + kSmallest * kLargest + kLargest * kLargest) / 3;
    const double area = static_cast<double>(discs) * std::numbers::pi * mean_square / kFill;
    const double width = kWidth * std::sqrt(static_cast<double>(discs) / kCrowd);
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = Walls{.min = {0, kStart},
                        .max = {width, kStart + area / width},
                        .top = false,
                        .material = material_of(restitution, friction)};
    Gas gas;
    gas.count = discs, gas.radius = {kSmallest, kLargest}, gas.velocity_rms = 1, gas.seed = seed;
    gas.body.material = material_of(restitution, friction);
    add_gas(scene, gas);
    scene.walls->min.y = 0;
    return scene;
}

}  // namespace carom::torture
