#pragma once

#include "solvers/impulse/impacts/flights.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace carom::test {

/// A few discs at the start of a substep, with what Flights points to.
template <class Real>
struct FlightsBench {
    struct Disc {
        Vec2 position, velocity;
        double mass = 1, radius = 0.5;
        bool is_immovable = false;
    };

    Bodies<Real> bodies;
    Books books;
    Walls walls{.min = {-100, 0}, .max = {100, 100}, .left = false, .right = false, .top = false};
    FlightColumns<Real> columns;
    Flights<Real> flights;
    std::vector<Disc> discs;

    explicit FlightsBench(std::vector<Disc> of, Vec2 gravity = {}, double dt = 1.0 / 64)
        : discs(std::move(of)) {
        const std::size_t count = discs.size();
        bodies.resize(count);
        columns.motion.resize(4 * count), columns.accelerations.resize(count);
        flights.look_at(columns);
        for (std::size_t row = 0; row < count; ++row) {
            const Disc& disc = discs[row];
            const Real motion[] = {static_cast<Real>(disc.position.x), static_cast<Real>(disc.position.y),
                                   static_cast<Real>(disc.velocity.x), static_cast<Real>(disc.velocity.y)};
            bodies.position_x[row] = motion[0], bodies.position_y[row] = motion[1];
            bodies.velocity_x[row] = motion[2], bodies.velocity_y[row] = motion[3];
            for (std::size_t k = 0; k < 4; ++k) flights.motion[4 * row + k] = motion[k];
            bodies.mass.set(row, count, static_cast<Real>(disc.mass));
            bodies.radius.set(row, count, static_cast<Real>(disc.radius));
            bodies.id[row] = {static_cast<std::uint32_t>(row), 0};
            if (disc.is_immovable) bodies.set_flags(row, kImmovable);
        }
        flights.bodies = &bodies, flights.books = &books, flights.walls = &walls;
        flights.end = flight_clock_at(dt, 0);
        flights.common_acceleration = gravity;
        for (std::size_t row = 0; row < count; ++row)
            flights.accelerations[row] = discs[row].is_immovable ? Vec2{} : gravity;
        flights.rest_speed = 0.02 * std::sqrt(length_squared(gravity)) * flights.end.s;
        books.is_open = true;
    }
    FlightsBench(const FlightsBench&) = delete;  // flights has pointers

    double inverse_mass(std::int32_t row) const { return flights.inverse_mass(row); }

    /// From a to b, or into the wall.
    Vec2 normal(Meeting m) const {
        if (m.with_wall()) return m.b == kBottom ? Vec2{0, -1} : Vec2{};
        const Vec2 d = flights.flight(m.b).position - flights.flight(m.a).position;
        return (1 / std::sqrt(length_squared(d))) * d;
    }
    /// -1 for a, 1 for b, 0 for who has no part in a meeting.
    static double side(Meeting m, std::int32_t row) { return row == m.a ? -1 : row == m.b ? 1 : 0; }

    /// What a unit impulse of meeting p adds to the relative normal velocity of meeting q [1/kg].
    double coupling(Meeting p, Meeting q) const {
        double sum = 0;
        for (std::size_t i = 0; i < discs.size(); ++i) {
            const auto row = static_cast<std::int32_t>(i);
            sum += side(p, row) * side(q, row) * inverse_mass(row);
        }
        return sum * dot(normal(p), normal(q));
    }
    /// Of b relative to a along the normal, of a vector that each body has.
    template <class Of>
    double relative(Meeting m, const Of& of) const {
        return dot((m.with_wall() ? Vec2{} : of(m.b)) - of(m.a), normal(m));
    }
    double normal_velocity(Meeting m) const {
        return relative(m, [&](std::int32_t row) { return flights.flight(row).velocity; });
    }

    Vec2 momentum() const {
        Vec2 sum;
        for (std::size_t i = 0; i < discs.size(); ++i) {
            const auto row = static_cast<std::int32_t>(i);
            if (inverse_mass(row) > 0) sum += (1 / inverse_mass(row)) * flights.flight(row).velocity;
        }
        return sum;
    }
    double energy() const {
        double sum = 0;
        for (std::size_t i = 0; i < discs.size(); ++i) {
            const auto row = static_cast<std::int32_t>(i);
            if (inverse_mass(row) > 0)
                sum += 0.5 / inverse_mass(row) * length_squared(flights.flight(row).velocity);
        }
        return sum;
    }
};

}  // namespace carom::test
