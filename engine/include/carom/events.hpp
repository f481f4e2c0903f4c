#pragma once

#include <carom/ids.hpp>
#include <carom/vec2.hpp>

#include <span>

namespace carom {

/// A body has come into a sensor, or has left it. Where one of the two was removed meanwhile, its handle is
/// the one it had.
struct SensorEvent {
    BodyId sensor, body;
    bool begins = true;  ///< false: it has left
    double time = 0;     ///< s, end of the step
    Vec2 position{};     ///< m, of the body then; where it was removed, of the origin
};

/// What happened, by kind, in the order in which it happened; within a step by sensor, then by body.
struct Events {
    std::span<const SensorEvent> sensor;
};

}  // namespace carom
