#pragma once

#include <carom/scene.hpp>

#include <optional>
#include <string>

namespace carom::bench {

/// A square box of tiles that turns about its centre at a fixed speed.
struct Container {
    double side = 0;              ///< m, inside
    double angular_velocity = 0;  ///< rad/s
    double tile_length = 8;       ///< m, along a side
    double tile_thickness = 1;    ///< m
};

/// A scene of docs/performance.md: the same bodies, in the same places, for every engine.
struct BenchScene {
    std::string name;
    Scene scene;                           ///< walls that are missing are open sides
    std::optional<Container> container{};  ///< in place of walls, centred on the origin
    int settle_steps = 0;                  ///< before anything is timed
    int restart_steps = 0;  ///< timed steps after which it starts over, as it would change; 0: never
};

}  // namespace carom::bench
