#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace carom::report {

/// A number that 16 bits stand for: base + step * bits.
struct Scale {
    double base = 0;
    double step = 0;
};

/// A place that cannot be drawn: not finite, or so far off that the others would lose their place.
inline constexpr std::uint16_t kNowhere = 65535;

/// What trajectories have in place of a colour 0xRRGGBB for a body without one.
inline constexpr std::uint32_t kNoColour = UINT32_MAX;

/// One frame as the page's player reads it: columns of 16 bits, x, y, then velocities and angles if there are
/// any.
struct QuantisedFrame {
    Scale x, y;             // m
    double speed_step = 0;  // m/s: velocity = speed_step * bits, signed
    double speed_rms = 0;   // m/s
    std::size_t lost = 0;   ///< bodies that are nowhere
    std::vector<std::uint16_t> bits;
};

/// The range in which one component (0: x, 1: y) of all positions [bodies, 2] is drawn, without those too far
/// off.
Scale drawn_range(std::span<const float> position, std::size_t component);

/// Positions to 1/65534 of the width of all, which no screen shows. Single bodies farther off than 16 times
/// the others' extent would make that coarse; they are lost instead.
/// @param position, velocity  [bodies, 2]; velocity and angle [bodies] may be empty.
QuantisedFrame quantise(std::span<const float> position, std::span<const float> velocity,
                        std::span<const float> angle);

}  // namespace carom::report
