#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/event/event_disc.hpp"
#include "state/columns/column.hpp"

namespace carom {

/// One side of the box: clearance of a point is normal · x - offset.
struct EventWall {
    bool is_closed = false;
    Vec2 normal;        ///< into the box
    double offset = 0;  ///< m
};

/// Gravity and walls, which act on all discs.
struct EventLaws {
    Vec2 gravity;                      ///< m/s², on everything that has a mass
    std::array<EventWall, 4> walls{};  ///< left, right, bottom, top
    double wall_restitution = 0;
    double wall_friction = 0;
};

/// The discs, in an order of their own: movable ones first, so that a number tells whether a disc falls;
/// those too large for the cells in one range around that border; and neighbours in the plane near each
/// other.
struct EventStore {
    EventLaws laws;
    Column<EventMover> movers;
    Column<EventForecast> forecasts;
    Column<EventSurface> surfaces;
    std::vector<std::int32_t> row_of;   // of the bodies as they were handed over
    std::vector<std::int32_t> disc_of;  // the inverse
    std::size_t first_immovable = 0;
    std::size_t large_begin = 0, large_end = 0;

    std::size_t count() const { return movers.size(); }
    bool is_immovable(std::size_t disc) const { return disc >= first_immovable; }
    bool is_large(std::size_t disc) const { return disc >= large_begin && disc < large_end; }
    bool fall_alike(std::size_t a, std::size_t b) const { return is_immovable(a) == is_immovable(b); }
    Vec2 gravity_on(std::size_t disc) const { return is_immovable(disc) ? Vec2{} : laws.gravity; }

    Vec2 position_at(std::size_t disc, double time) const {
        const EventMover& m = movers[disc];
        const double t = time - m.time;
        return m.position + t * (m.velocity + (0.5 * t) * gravity_on(disc));
    }
    Vec2 velocity_at(std::size_t disc, double time) const {
        const EventMover& m = movers[disc];
        return m.velocity + (time - m.time) * gravity_on(disc);
    }
    double angle_at(std::size_t disc, double time) const {
        const EventSurface& s = surfaces[disc];
        return s.angle + (time - s.angle_time) * s.spin;
    }
    /// Restates a disc's path from where it is at `time`.
    void bring_to(std::size_t disc, double time) {
        EventMover& m = movers[disc];
        const Vec2 position = position_at(disc, time), velocity = velocity_at(disc, time);
        m.position = position, m.velocity = velocity, m.time = time;
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.laws, self.movers, self.forecasts, self.surfaces, self.row_of, self.disc_of);
        archive(self.first_immovable, self.large_begin, self.large_end);
    }

    std::size_t bytes() const {
        return movers.bytes() + forecasts.bytes() + surfaces.bytes() +
               (row_of.capacity() + disc_of.capacity()) * sizeof(std::int32_t);
    }
};

}  // namespace carom
