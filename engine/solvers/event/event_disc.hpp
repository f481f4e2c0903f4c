#pragma once

#include <cstdint>

#include "math/vec2_math.hpp"
#include "narrowphase/impact_time.hpp"

// The data of a disc under solver `event`, apart by how often they are read: a forecast looks at the movers
// of some ten neighbours and at one or two forecasts, an impact at two surfaces. Each is one cache line, or
// half of one.

namespace carom {

/// A disc's path since its last impact: one cache line.
struct alignas(64) EventMover {
    Vec2 position;                          ///< m, at its own time
    Vec2 velocity;                          ///< m/s, at its own time
    double time = 0;                        ///< s, on the solver's clock: its last impact
    double radius = 0;                      ///< m
    std::int32_t cell_x = 0, cell_y = 0;    ///< where it is registered
    std::int32_t next = -1, previous = -1;  ///< in the list of its cell
};
static_assert(sizeof(EventMover) == 64);

inline constexpr std::int32_t kNoPartner = INT32_MIN;

/// A disc's next event. Two of these a cache line.
struct EventForecast {
    double impact_time = kNever;        ///< s
    double exit_time = kNever;          ///< s, when it leaves its cell
    std::int32_t partner = kNoPartner;  ///< a disc, or -1 - side of the walls
    std::uint32_t partner_impacts = 0;  ///< the partner's when this was foreseen: if more now, it is void
    std::uint32_t impacts = 0;          ///< of this disc so far
    std::uint8_t exit_side = 0;         ///< as the walls' sides
    bool is_tied = false;               ///< another impact of this disc is due at the same instant

    double time() const { return impact_time < exit_time ? impact_time : exit_time; }
};
static_assert(sizeof(EventForecast) == 32);

/// The data of a disc that only impacts need: one cache line.
struct alignas(64) EventSurface {
    double inverse_mass = 0;     ///< 1/kg, 0 for what nothing moves
    double inverse_inertia = 0;  ///< 1/(kg m²), 0 for what nothing turns
    double restitution = 0;
    double friction = 0;
    double spin = 0;               ///< rad/s
    double angle = 0;              ///< rad, at angle_time
    double angle_time = 0;         ///< s, the last impact that changed the spin
    double last_impact = -kNever;  ///< s, for the rule against inelastic collapse
};
static_assert(sizeof(EventSurface) == 64);

/// One body as the solver is told about it.
struct EventBody {
    Vec2 position, velocity;     ///< m, m/s
    double angle = 0, spin = 0;  ///< rad, rad/s
    double radius = 0;           ///< m
    double inverse_mass = 0;     ///< 1/kg; 0: it keeps its velocity, whatever it meets
    double inverse_inertia = 0;  ///< 1/(kg m²)
    double restitution = 0;
    double friction = 0;
};

}  // namespace carom
