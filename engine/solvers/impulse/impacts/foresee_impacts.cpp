#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/impulse/impacts/impact_resolver.hpp"

// When and with what a body collides next: the part of a resolver that looks ahead.

namespace carom {
namespace {

constexpr double kRoundingUp =
    1 + 1e-6;  // where neighbours are looked for, place and reach are rounded to Real

constexpr std::size_t kFewestNeighbours = 256;  // room for, doubled as needed

}  // namespace

template <class Real>
double ImpactResolver<Real>::impact_time(Meeting m, double from) const {
    const Flight fa = flights_.flight(m.a);
    return m.with_wall() ? time_at_wall(m.a, fa, m.b, from) : time_of_pair(m, fa, flights_.flight(m.b), from);
}

template <class Real>
void ImpactResolver<Real>::foresee(Meeting m, double from) {
    const double s = impact_time(m, from);
    if (s != kNever) queue(m, from, s);
}

template <class Real>
double ImpactResolver<Real>::time_at_wall(std::int32_t row, const Flight& f, std::int32_t side,
                                          double from) const {
    const Vec2 n = wall_normal(side);
    const double clearance = wall_clearance(*flights_.walls, side, f.position) - flights_.radius(row);
    return wall_impact_time(clearance, -dot(n, f.velocity), -dot(n, f.acceleration),
                            {from, flights_.end.s, flights_.drag()});
}

template <class Real>
double ImpactResolver<Real>::time_of_pair(Meeting m, const Flight& fa, const Flight& fb, double from) const {
    const Window window{from, flights_.end.s, flights_.drag()};
    const Flight relative{fb.position - fa.position, fb.velocity - fa.velocity,
                          fb.acceleration - fa.acceleration};
    if (relative.acceleration == Vec2{}) {
        const Vec2 d = relative.position + from * relative.velocity;
        if (!(dot(d, relative.velocity) < 0)) return kNever;  // most: worth asking first
        return straight_impact_time(d, relative.velocity, flights_.reach(m), window);
    }
    const double reach = flights_.reach(m);
    return accelerated_impact_time(relative, reach, window, 4 * std::numeric_limits<Real>::epsilon() * reach);
}

template <class Real>
void ImpactResolver<Real>::queue(Meeting m, double from, double s) {
    if (flights_.rest_speed > 0 && flights_.rests(m, from) && flights_.rests(m, s)) {
        keep_resting(m, 0);  // too gentle to bounce from here on
        return;
    }
    push(m, s, terms_.tiles->tile_of(flights_.flight(m.a).position));
}

template <class Real>
void ImpactResolver<Real>::push(Meeting m, double s, std::size_t tile) {
    const auto deflections = [&](std::int32_t row) {
        return terms_.deflections[static_cast<std::size_t>(row)];
    };
    const Impact impact{s, m, deflections(m.a), m.with_wall() ? 0 : deflections(m.b)};
    if (phase_ != kAfterAll && (phase_ == kBeforeAll || terms_.tiles->phase_of(tile) > phase_))
        out_->of_other_tiles.push_back({impact, static_cast<std::uint32_t>(tile)});
    else
        calendar_.push(impact);
}

template <class Real>
void ImpactResolver<Real>::keep_resting(Meeting m, double force) {
    const auto& id = flights_.bodies->id;
    out_->resting.push_back({id[static_cast<std::size_t>(m.a)],
                             m.with_wall() ? BodyId{} : id[static_cast<std::size_t>(m.b)],
                             m.with_wall() ? m.b : 0, force});
}

template <class Real>
void ImpactResolver<Real>::foresee_all_of(std::int32_t row, double from) {
    if (flights_.walls) foresee_walls(row, from);
    const Vec2 end = position_at(flights_.flight(row), flights_.end.s, flights_.end.q);
    out_->overshoot =
        std::max(out_->overshoot, terms_.candidates->overshoot_of(row, flights_.radius(row), end));
    foresee_near(row, from);
}

template <class Real>
void ImpactResolver<Real>::foresee_walls(std::int32_t row, double from) {
    const Flight f = flights_.flight(row);
    const Vec2 now = position_at(f, from, flight_q(from, flights_.drag()));
    const Vec2 end = position_at(f, flights_.end.s, flights_.end.q);
    // The path bends by no more than a q between its ends.
    const Vec2 reach{flights_.radius(row) + std::fabs(f.acceleration.x) * flights_.end.q,
                     flights_.radius(row) + std::fabs(f.acceleration.y) * flights_.end.q};
    const Walls& walls = *flights_.walls;
    for_each_wall_side([&](auto side) {
        const double least = std::min(wall_clearance(walls, side, now), wall_clearance(walls, side, end));
        const bool is_upright = side == kLeft || side == kRight;
        if (!(least < (is_upright ? reach.x : reach.y)) || !has_wall(walls, side)) return;
        const double s = time_at_wall(row, f, side, from);
        if (s != kNever) queue({row, side}, from, s);
    });
}

/// Whether the kernel that looks for what is near may look in all cells that it will.
template <class Real>
bool ImpactResolver<Real>::may_look_near(double y, Real reach) const {
    constexpr double kRoundingMargin = 1 + 1e-5;  // that of kernels/broadphase/find_near.hpp
    const GridLevel<Real>& level = terms_.candidates->grid().level(0);
    const Tiles& tiles = *terms_.tiles;
    if (reach <= level.largest_reach) {  // the cells around its own
        const std::int64_t line = tiles.line_of(y);
        return reach_.may_look(line - 1, line + 1);
    }
    const double far =
        (static_cast<double>(reach) + static_cast<double>(level.largest_reach)) * kRoundingMargin;
    return reach_.may_look(tiles.line_of(y - far), tiles.line_of(y + far));
}

/// Drops those of the first `found` near rows that filters keep apart from a row. @return how many are left
template <class Real>
std::size_t ImpactResolver<Real>::keep_touchable(std::int32_t row, std::size_t found) {
    std::int32_t* const rows = near_.data();
    return static_cast<std::size_t>(std::remove_if(rows, rows + found,
                                                   [&](std::int32_t other) {
                                                       return !flights_.bodies->may_touch(
                                                           static_cast<std::size_t>(row),
                                                           static_cast<std::size_t>(other));
                                                   }) -
                                    rows);
}

/// Foresees what other bodies a body can hit from clock `from` on.
template <class Real>
void ImpactResolver<Real>::foresee_near(std::int32_t row, double from) {
    const Flight f = flights_.flight(row);
    const Vec2 now = position_at(f, from, flight_q(from, flights_.drag()));
    const Vec2 way = position_at(f, flights_.end.s, flights_.end.q) - now;
    // No point of the path is farther from `now` than this; others stay within their margins and the
    // overshoot.
    const double travel = std::fabs(way.x) + std::fabs(way.y) +
                          (std::fabs(f.acceleration.x) + std::fabs(f.acceleration.y)) * flights_.end.q;
    const double reach = flights_.radius(row) + travel + out_->overshoot;
    const auto real = [](double value) { return static_cast<Real>(value); };
    if (!may_look(now.y, real(reach * kRoundingUp))) {
        out_->left_bodies.push_back({row, terms_.deflections[static_cast<std::size_t>(row)], from});
        return;
    }
    const auto& radius = flights_.bodies->radius;
    const auto kernel = radius.is_uniform() ? terms_.kernels->find_impacts_near_uniform_radius
                                            : terms_.kernels->find_impacts_near;
    FindImpactsNear<Real> k{real(now.x),
                            real(now.y),
                            real(reach * kRoundingUp),
                            flights_.motion.data(),
                            row,
                            radius.data(),
                            radius.uniform_value(),
                            real(from),
                            real(flights_.end.s),
                            real(terms_.slack),
                            nullptr,
                            0};
    std::size_t found = 0;
    for (std::size_t level = 0; level < terms_.candidates->grid().level_count(); ++level) {
        const auto find_in_level = [&] {
            k.found = near_.data() + found, k.capacity = near_.size() - found;
            return kernel(terms_.candidates->grid().level(level), k);
        };
        std::size_t more = find_in_level();
        while (more == kNoRoom) {
            near_.resize(2 * near_.size() + kFewestNeighbours);
            more = find_in_level();
        }
        found += more;
    }
    if (flights_.bodies->has_filters()) found = keep_touchable(row, found);
    const bool immovable = flights_.is_immovable(row);
    for (std::size_t i = 0; i < found; ++i) {
        const std::int32_t other = near_[i];
        if (other == row || (immovable && flights_.is_immovable(other))) continue;
        // One order for a pair, whichever of the two asks: the same bits and the same ties.
        foresee(row < other ? Meeting{row, other} : Meeting{other, row}, from);
    }
}

template class ImpactResolver<float>;
template class ImpactResolver<double>;

}  // namespace carom
