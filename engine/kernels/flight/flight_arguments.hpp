#pragma once

#include <cstddef>
#include <cstdint>

// Plain arguments of the kernels that fly bodies through a substep. Columns are padded and 64-byte aligned;
// `first` and `last` are multiples of kRowPadding, so there is no tail.

namespace carom {

/// Packs position and velocity into one record a body, and lists the rows that need a closer look.
template <class Real>
struct BeginFlight {
    const Real* position_x;  // m
    const Real* position_y;
    const Real* velocity_x;  // m/s
    const Real* velocity_y;
    const Real* built_x;  // m, where the candidate pairs were found
    const Real* built_y;
    const Real* reach;   // m, radius plus the body's margin
    const Real* radius;  // m, or null: uniform_radius serves all
    Real uniform_radius;
    Real s;               // s, the flight's clock at its end (effects/flight.hpp)
    Real fall_x, fall_y;  // m, acceleration times q at the end
    Real gain_x, gain_y;  // m/s, acceleration times s at the end
    Real bend_x, bend_y;  // m, how far a path can bulge beyond both its ends
    Real touch_ratio;     // no unit, >= 1: within this many radii of a wall a body may touch it
    Real min_x, min_y;    // m, walls; infinite where there is none
    Real max_x, max_y;
    Real largest_position;         // m
    Real largest_speed;            // m/s
    Real* motion;                  // out, [rows][4]: x, y, vx, vy
    std::int32_t* wall_rows;       // out: rows that may reach a wall; room for last - first + a batch
    std::int32_t* displaced_rows;  // out: rows whose path leaves their margin, or that have none
    std::int32_t* lost_rows;       // out: rows whose state leaves the limits, or is not a number
};

/// How many rows each list got, and the largest speed squared [m²/s²].
template <class Real>
struct FlightCounts {
    std::size_t wall;
    std::size_t displaced;
    std::size_t lost;
    Real fastest_squared;
};

/// Candidate pairs that may touch in this substep, or whose bodies are as near as `near` already.
template <class Real>
struct FindImpacts {
    const Real* motion;     // [rows][4]: x, y, vx, vy
    const std::int32_t* a;  // body rows, [pairs], padded with pairs that never meet
    const std::int32_t* b;
    const Real* radius;  // m, or null: uniform_radius serves all
    Real uniform_radius;
    Real s;               // s, the flight's clock at its end
    Real slack;           // m, >= 0, how far accelerations can bring two paths nearer than straight lines
    Real near;            // m, separation up to which a pair is listed whether or not it approaches
    std::int32_t* found;  // out: pair numbers, ascending; room for last - first + a batch
};

/// Lists the bodies in the cells around a place that body `row` may meet between clock `from` and the end of
/// the substep.
template <class Real>
struct FindImpactsNear {
    Real x, y, reach;    // m, where to look: cells that hold a body with distance below reach + its own reach
    const Real* motion;  // [rows][4]: x, y, vx, vy
    std::int32_t row;    // never found itself unless slack > 0
    const Real* radius;  // m, or null: uniform_radius serves all
    Real uniform_radius;
    Real from;            // s
    Real until;           // s
    Real slack;           // m, >= 0, as for FindImpacts; pairs as near as that are listed even if they part
    std::int32_t* found;  // out: rows
    std::size_t capacity;
};

/// Writes positions and velocities at the end of the flight back into the columns.
template <class Real>
struct EndFlight {
    const Real* motion;   // [rows][4]
    Real s;               // s
    Real loss;            // no unit, what drag takes: 1 - e^(-kt)
    Real fall_x, fall_y;  // m
    Real gain_x, gain_y;  // m/s
    Real* position_x;     // out, m
    Real* position_y;
    Real* velocity_x;  // out, m/s
    Real* velocity_y;
    Real dither_x, dither_y;  // no unit, of velocity: added before rounding (effects/fair_rounding.hpp)
};

/// angle += angular velocity * s, angular velocity *= u, with the angular drag's own clock.
template <class Real>
struct AdvanceRotation {
    Real* angle;             // rad
    Real* angular_velocity;  // rad/s
    Real s;                  // s
    Real u;                  // no unit
};

}  // namespace carom
