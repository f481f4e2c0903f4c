#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/impulse/impulse_solver.hpp"

// When and with whom: the part of the impulse solver that looks ahead.

namespace carom {
namespace {

constexpr double kRoundingUp =
    1 + 1e-6;  // where neighbours are looked for, place and reach are rounded to Real

constexpr std::size_t kFewestNeighbours = 256;  // room for, doubled as needed

}  // namespace

template <class Real>
FoundMeeting ImpulseSolver<Real>::examine(Meeting m) const {
    FoundMeeting found{m};
    if (flights.rest_speed > 0) return found;
    const double slop = kSlopFraction * flights.smaller_radius(m);
    if (m.with_wall()) {
        found.overlaps = flights.encounter(m, 0).separation < -slop;
    } else {  // needs no root
        const Vec2 d = flights.flight(m.b).position - flights.flight(m.a).position;
        const double overlapping = flights.reach(m) - slop;
        found.overlaps = length_squared(d) < overlapping * overlapping;
    }
    found.impact = impact_time(m, 0);
    if (found.impact != kNever)
        found.tile =
            static_cast<std::uint32_t>(tiles_.tile_of(candidates_->grid(), flights.flight(m.a).position));
    return found;
}

/// When the bodies of a meeting next touch, from clock `from` on.
template <class Real>
double ImpulseSolver<Real>::impact_time(Meeting m, double from) const {
    const Flight fa = flights.flight(m.a);
    return m.with_wall() ? time_at_wall(m.a, fa, m.b, from) : time_of_pair(m, fa, flights.flight(m.b), from);
}

/// Puts the next impact of a meeting, if there is one from clock `from` on, into the queue.
template <class Real>
void ImpulseSolver<Real>::foresee(Meeting m, double from) {
    const double s = impact_time(m, from);
    if (s != kNever) queue(m, from, s);
}

template <class Real>
double ImpulseSolver<Real>::time_at_wall(std::int32_t row, const Flight& f, std::int32_t side,
                                         double from) const {
    const Vec2 n = wall_normal(side);
    const double clearance = wall_clearance(*flights.walls, side, f.position) - flights.radius(row);
    return wall_impact_time(clearance, -dot(n, f.velocity), -dot(n, f.acceleration),
                            {from, flights.end.s, flights.drag()});
}

template <class Real>
double ImpulseSolver<Real>::time_of_pair(Meeting m, const Flight& fa, const Flight& fb, double from) const {
    const Window window{from, flights.end.s, flights.drag()};
    const Flight relative{fb.position - fa.position, fb.velocity - fa.velocity,
                          fb.acceleration - fa.acceleration};
    if (relative.acceleration == Vec2{}) {
        const Vec2 d = relative.position + from * relative.velocity;
        if (!(dot(d, relative.velocity) < 0)) return kNever;  // most: worth asking first
        return straight_impact_time(d, relative.velocity, flights.reach(m), window);
    }
    const double reach = flights.reach(m);
    return accelerated_impact_time(relative, reach, window, 4 * std::numeric_limits<Real>::epsilon() * reach);
}

template <class Real>
void ImpulseSolver<Real>::queue(Meeting m, double from, double s) {
    if (flights.rest_speed > 0 && flights.rests(m, from) && flights.rests(m, s)) {
        keep_resting(m, 0);  // too gentle to bounce from here on
        return;
    }
    push(m, s, tiles_.tile_of(candidates_->grid(), flights.flight(m.a).position));
}

template <class Real>
void ImpulseSolver<Real>::push(Meeting m, double s, std::size_t tile) {
    queue_.push({s, m, deflections_[static_cast<std::size_t>(m.a)],
                 m.with_wall() ? 0 : deflections_[static_cast<std::size_t>(m.b)]},
                tile);
}

/// Foresees what a body can hit after it was deflected at clock `from`.
template <class Real>
void ImpulseSolver<Real>::foresee_all_of(std::int32_t row, double from) {
    if (flights.walls) foresee_walls(row, from);
    const Vec2 end = position_at(flights.flight(row), flights.end.s, flights.end.q);
    overshoot_ = std::max(overshoot_, candidates_->overshoot_of(row, flights.radius(row), end));
    foresee_near(row, from);
}

template <class Real>
void ImpulseSolver<Real>::foresee_walls(std::int32_t row, double from) {
    const Flight f = flights.flight(row);
    const Vec2 now = position_at(f, from, flight_q(from, flights.drag()));
    const Vec2 end = position_at(f, flights.end.s, flights.end.q);
    // The path bends by no more than a q between its ends.
    const Vec2 reach{flights.radius(row) + std::fabs(f.acceleration.x) * flights.end.q,
                     flights.radius(row) + std::fabs(f.acceleration.y) * flights.end.q};
    const Walls& walls = *flights.walls;
    for_each_wall_side([&](auto side) {
        const double least = std::min(wall_clearance(walls, side, now), wall_clearance(walls, side, end));
        const bool is_upright = side == kLeft || side == kRight;
        if (!(least < (is_upright ? reach.x : reach.y)) || !has_wall(walls, side)) return;
        const double s = time_at_wall(row, f, side, from);
        if (s != kNever) queue({row, side}, from, s);
    });
}

/// Drops those of the first `found` near rows that filters keep apart from a row. @return how many are left
template <class Real>
std::size_t ImpulseSolver<Real>::keep_touchable(std::int32_t row, std::size_t found) {
    std::int32_t* const rows = near_.data();
    return static_cast<std::size_t>(std::remove_if(rows, rows + found,
                                                   [&](std::int32_t other) {
                                                       return !flights.bodies->may_touch(
                                                           static_cast<std::size_t>(row),
                                                           static_cast<std::size_t>(other));
                                                   }) -
                                    rows);
}

/// Foresees what other bodies a body can hit from clock `from` on.
template <class Real>
void ImpulseSolver<Real>::foresee_near(std::int32_t row, double from) {
    const Flight f = flights.flight(row);
    const Vec2 now = position_at(f, from, flight_q(from, flights.drag()));
    const Vec2 way = position_at(f, flights.end.s, flights.end.q) - now;
    // No point of the path is farther from `now` than this; others stay within their margins and the
    // overshoot.
    const double travel = std::fabs(way.x) + std::fabs(way.y) +
                          (std::fabs(f.acceleration.x) + std::fabs(f.acceleration.y)) * flights.end.q;
    const double reach = flights.radius(row) + travel + overshoot_;
    const auto& radius = flights.bodies->radius;
    const auto kernel =
        radius.is_uniform() ? kernels_->find_impacts_near_uniform_radius : kernels_->find_impacts_near;
    const auto real = [](double value) { return static_cast<Real>(value); };
    FindImpactsNear<Real> k{real(now.x),
                            real(now.y),
                            real(reach * kRoundingUp),
                            flights.motion.data(),
                            row,
                            radius.data(),
                            radius.uniform_value(),
                            real(from),
                            real(flights.end.s),
                            real(slack_),
                            nullptr,
                            0};
    std::size_t found = 0;
    for (std::size_t level = 0; level < candidates_->grid().level_count(); ++level) {
        const auto find_in_level = [&] {
            k.found = near_.data() + found, k.capacity = near_.size() - found;
            return kernel(candidates_->grid().level(level), k);
        };
        std::size_t more = find_in_level();
        while (more == kNoRoom) {
            near_.resize(2 * near_.size() + kFewestNeighbours);
            more = find_in_level();
        }
        found += more;
    }
    if (flights.bodies->has_filters()) found = keep_touchable(row, found);
    const bool immovable = flights.is_immovable(row);
    for (std::size_t i = 0; i < found; ++i) {
        const std::int32_t other = near_[i];
        if (other == row || (immovable && flights.is_immovable(other))) continue;
        // One order for a pair, whichever of the two asks: the same bits and the same ties.
        foresee(row < other ? Meeting{row, other} : Meeting{other, row}, from);
    }
}

template class ImpulseSolver<float>;
template class ImpulseSolver<double>;

}  // namespace carom
