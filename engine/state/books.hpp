#pragma once

#include <carom/ledger.hpp>

#include "math/vec2_math.hpp"

namespace carom {

/// Running totals by cause since the start, written by the stages as they act. What the stages write here
/// comes from formulas (docs/how-a-step-works.md), never from differences of the state, so that the remainder
/// means something.
struct Books {
    bool is_open =
        false;  ///< the ledger effect, or a debug build; nothing is written while closed, but wall_impulse
    double drag = 0;           // J
    double restitution = 0;    // J
    double friction = 0;       // J
    double correction = 0;     // J
    double joints = 0;         // J
    double drive = 0;          // J
    double sleep = 0;          // J
    double overlap_worth = 0;  // J, of this step, what overlaps are worth: solvers/shared/check_energy.hpp
    Vec2 gravity_momentum;     // kg m/s, and below
    Vec2 drag_momentum;
    Vec2 wall_momentum;
    Vec2 immovable_momentum;
    Vec2 sleep_momentum;
    double wall_impulse = 0;  // N s, magnitude

    /// An impulse from the walls on a body.
    void add_wall_impulse(Vec2 impulse) {
        wall_momentum += impulse;
        const double x =
            impulse.x < 0 ? -impulse.x : impulse.x;  // walls are axis-aligned: one of the two is zero
        const double y = impulse.y < 0 ? -impulse.y : impulse.y;
        wall_impulse += x + y;
    }
};

}  // namespace carom
