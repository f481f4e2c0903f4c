#include "solvers/soft/project_positions.hpp"

#include <algorithm>
#include <cmath>

#include "constraints/support_surface.hpp"
#include "effects/touching.hpp"
#include "narrowphase/disc_edge.hpp"
#include "shapes/walls.hpp"

namespace carom {
namespace {

/// A body that the fastest one hits may be thrown about. Bodies are looked at if that moves farther than this
/// in a step, in radii of theirs.
constexpr double kSwiftWay = 4;
/// A body that ends a step so far from where it would have flown, in radii of its own, may be in another.
constexpr double kDeflected = 0.05;
/// What is left of an overlap, in radii of the smaller body.
constexpr double kLeftOver = 0.02;
/// A body that is pushed may be pushed into others, which are looked at in the next of so many rounds.
constexpr int kRoundsOfProjection = 32;
/// A body that is deeper in another after that, in radii of the smaller, is put back.
constexpr double kStuck = 0.06;
/// The mark of a row that was deflected; others are marked by 1.
constexpr std::uint8_t kDeflectedMark = 3;

/// The plane of a wall; body and radius are left open.
PositionProjection::Plane wall_of(const Walls& walls, std::int32_t side) {
    const Vec2 n = wall_normal(side);
    const Vec2 corner = wall_corner(walls, side);
    return {-1, n, dot(n, corner), 0};
}

/// Whether a contact carries more than the cap on pushes stands for.
template <class Real>
bool is_loaded(const StepView<Real>& step, std::size_t pair) {
    const ContactRows<Real>& pairs = step.graph.pairs;
    const double cap = step.settings.largest_correction;
    const double push =
        step.settings.effects.radius_varies ? cap * step.settings.smaller_radius(pairs, pair) : cap;
    return static_cast<double>(pairs.normal_impulse[pair]) * step.terms.substep_dt >
           static_cast<double>(pairs.mass[pair]) * push;
}

}  // namespace

/// Marks discs of less than `largest` [m] that have not ended where free flight or rest would have taken
/// them.
/// @return whether there are any
template <class Real>
bool EndProjection<Real>::mark_deflected(const Inputs& in, double largest) {
    bool any = false;
    const double dt = in.flight.dt;
    const Column<Real>&motion = in.flight.motion, &displacement = in.step.records.displacement;
    const Vec2 fall = 0.5 * dt * dt * in.world.gravity;
    for (std::size_t row = 0; row < in.step.records.moving(); ++row) {
        const double radius = in.world.bodies.radius[row];
        if (radius >= largest || !in.world.bodies.is_moving_disc(row)) continue;
        const Vec2 off{
            static_cast<double>(displacement[2 * row]) - dt * static_cast<double>(motion[4 * row + 2]),
            static_cast<double>(displacement[2 * row + 1]) - dt * static_cast<double>(motion[4 * row + 3])};
        const double least = kDeflected * radius;
        // Neither at rest nor in free flight.
        if (std::min(length_squared(off), length_squared(off - fall)) < least * least) continue;
        projection_.is_marked[row] = kDeflectedMark, any = true;
    }
    return any;
}

/// Marks bodies that are deep in another one or in a wall now, where one of the two is a disc of less than
/// `largest` [m]. @return whether there are any
template <class Real>
bool EndProjection<Real>::mark_stuck(const Inputs& in, double largest) {
    bool any = false;
    const Bodies<Real>& bodies = in.world.bodies;
    const ContactGraph<Real>& graph = in.step.graph;
    const auto end_of = [&](std::size_t row) { return in.step.records.end_of(row, in.flight); };
    const auto mark = [&](std::int32_t row) {
        projection_.is_marked[static_cast<std::size_t>(row)] |= 1;
        any = true;
    };
    graph.pairs.for_each([&](std::size_t i) {
        if (in.step.settings.smaller_radius(graph.pairs, i) >= largest) return;
        const auto a = static_cast<std::size_t>(graph.pairs.a[i]),
                   b = static_cast<std::size_t>(graph.pairs.b[i]);
        const double of_a = bodies.radius[a], of_b = bodies.radius[b];
        const double reach = of_a + of_b - kStuck * std::min(of_a, of_b);
        if (length_squared(end_of(b) - end_of(a)) > reach * reach) return;
        mark(graph.pairs.a[i]), mark(graph.pairs.b[i]);
    });
    graph.supports.for_each([&](std::size_t i) {
        const Partner support = graph.supports.partner(i);
        if (!support.is_wall()) return;
        const auto row = static_cast<std::size_t>(graph.supports.a[i]);
        const double radius = bodies.radius[row];
        if (radius >= largest) return;
        const PositionProjection::Plane wall = wall_of(*in.world.walls, support.side());
        if (dot(wall.normal, end_of(row)) + (1 - kStuck) * radius > wall.end) mark(graph.supports.a[i]);
    });
    return any;
}

/// Marks the bodies of pairs that were deep in each other at the start of the step.
template <class Real>
void EndProjection<Real>::mark_deep(const Inputs& in) {
    const ContactRows<Real>& pairs = in.step.graph.pairs;
    const ContactSettings& settings = in.step.settings;
    pairs.for_each([&](std::size_t i) {
        if (!pairs.is_live[i / kContactBlock] ||
            static_cast<double>(pairs.separation[i]) >
                -settings.deep_overlap(settings.smaller_radius(pairs, i)) ||
            is_loaded(in.step, i))
            return;
        for (const std::int32_t row : {pairs.a[i], pairs.b[i]})
            projection_.is_marked[static_cast<std::size_t>(row)] |= 1;
    });
}

/// Lists bodies that were thrown out of their margins within this step: the candidate pairs know nothing of
/// what they meet there.
template <class Real>
void EndProjection<Real>::find_thrown(const Inputs& in) {
    const std::vector<Vec2>& place = projection_.place;
    thrown_.clear();
    for (std::size_t row = 0; row < in.step.records.moving(); ++row)
        if (projection_.is_marked[row] == kDeflectedMark &&
            in.flight.candidates.outside_of_margin(row, in.world.bodies.radius[row], place[row]) > 0)
            thrown_.push_back(static_cast<std::int32_t>(row));
    const auto x = [&](std::int32_t row) { return place[static_cast<std::size_t>(row)].x; };
    std::sort(thrown_.begin(), thrown_.end(), [&](std::int32_t left, std::int32_t right) {
        return x(left) < x(right) || (x(left) == x(right) && left < right);
    });
}

/// Lists two bodies if they are near each other.
template <class Real>
void EndProjection<Real>::list_pair(const Inputs& in, std::int32_t row_a, std::int32_t row_b,
                                    bool is_loaded) {
    const Bodies<Real>& bodies = in.world.bodies;
    const Column<Real>& motion = in.flight.motion;
    const auto a = static_cast<std::size_t>(row_a), b = static_cast<std::size_t>(row_b);
    if (in.world.has_filters() && !in.world.may_collide(a, b)) return;
    const double of_a = bodies.radius[a], of_b = bodies.radius[b], smaller = std::min(of_a, of_b);
    const double near = of_a + of_b + smaller;
    if (length_squared(projection_.place[b] - projection_.place[a]) > near * near) return;
    const Vec2 before{static_cast<double>(motion[4 * b]) - static_cast<double>(motion[4 * a]),
                      static_cast<double>(motion[4 * b + 1]) - static_cast<double>(motion[4 * a + 1])};
    // What was there at the start goes no faster than the cap, and what is pressed together is left to the
    // sweeps: pushed apart it would press on others, which push back.
    const double apart = std::sqrt(length_squared(before)) - of_a - of_b +
                         (is_loaded ? 0 : kPushRadiiPerSecond * smaller * in.flight.dt);
    const double inverse_a = bodies.inverse_mass(a), inverse_b = bodies.inverse_mass(b);
    const double share_a = inverse_a / (inverse_a + inverse_b);
    projection_.pairs.push_back(
        {row_a, row_b, {}, of_a + of_b, std::min(apart, -kLeftOver * smaller), share_a, 1 - share_a});
}

/// Lists candidate pairs of which one body is marked.
template <class Real>
void EndProjection<Real>::list_pairs_of_marked(const Inputs& in) {
    const ContactRows<Real>& pairs = in.step.graph.pairs;
    pairs.for_each([&](std::size_t i) {
        const std::int32_t a = pairs.a[i], b = pairs.b[i];
        const int marks = projection_.is_marked[static_cast<std::size_t>(a)] |
                          projection_.is_marked[static_cast<std::size_t>(b)];
        if (marks != 0) list_pair(in, a, b, marks != kDeflectedMark && is_loaded(in.step, i));
    });
}

/// Lists pairs of thrown bodies and what is around them now.
template <class Real>
void EndProjection<Real>::list_pairs_of_thrown(const Inputs& in) {
    const auto radius_of = [&](std::int32_t row) {
        return static_cast<double>(in.world.bodies.radius[static_cast<std::size_t>(row)]);
    };
    const auto is_disc = [&](std::int32_t row) {
        return in.world.bodies.is_disc(static_cast<std::size_t>(row));
    };
    double largest = 0;
    for (const std::int32_t row : thrown_) largest = std::max(largest, radius_of(row));
    for (std::size_t i = 0; i < thrown_.size(); ++i) {
        const auto row = static_cast<std::size_t>(thrown_[i]);
        const Vec2 place = projection_.place[row];
        const std::size_t found =
            in.flight.candidates.find_around(row, 2 * radius_of(thrown_[i]), place, near_rows_);
        for (std::size_t k = 0; k < found; ++k)
            if (near_rows_[k] != thrown_[i] && is_disc(near_rows_[k]))
                list_pair(in, thrown_[i], near_rows_[k], false);
        const double near = 3 * largest;
        for (std::size_t k = i + 1; k < thrown_.size(); ++k) {
            if (projection_.place[static_cast<std::size_t>(thrown_[k])].x > place.x + near) break;
            list_pair(in, thrown_[i], thrown_[k], false);
        }
    }
}

template <class Real>
void EndProjection<Real>::list_wall(const Inputs& in, std::int32_t disc, std::int32_t side) {
    PositionProjection::Plane& wall = projection_.planes.emplace_back(wall_of(*in.world.walls, side));
    wall.a = disc, wall.radius = in.world.bodies.radius[static_cast<std::size_t>(disc)];
}

/// Lists a support if it is near: an edge as a plane, a body as one half of a pair.
template <class Real>
void EndProjection<Real>::list_support(const Inputs& in, std::int32_t disc, Partner support) {
    if (support.is_wall()) return list_wall(in, disc, support.side());
    const WorldState<Real>& world = in.world;
    const Bodies<Real>& bodies = world.bodies;
    const auto row = static_cast<std::size_t>(disc);
    const double radius = bodies.radius[row];
    const Vec2 x = projection_.place[row];
    if (support.is_edge()) {
        const Edge& edge = world.edges[support.edge_number()];
        const EdgePose& pose = in.flight.edges.pose_of(edge);
        const Vec2 p = rotate_back(pose.end_turn, x - pose.end_position);
        const double share = nearest_share(p, edge.a, edge.b);
        if (!is_touched_here(p, share, world.edges, edge)) return;
        const Vec2 d = point_at(edge.a, edge.b, share) - p;
        const double distance = std::sqrt(length_squared(d));
        if (!(distance > 0) || distance > 2 * radius) return;
        const Vec2 n = rotate(pose.end_turn, (1 / distance) * d);
        projection_.planes.push_back({disc, n, dot(n, x) + distance, radius});
        return;
    }
    const auto other = static_cast<std::size_t>(support.row());
    const double dt = in.flight.dt;
    const Vec2 place{bodies.position_x[other] + dt * bodies.velocity_x[other],
                     bodies.position_y[other] + dt * bodies.velocity_y[other]};
    const double of_other = bodies.radius[other], near = radius + of_other;
    if (length_squared(place - x) > (near + radius) * (near + radius)) return;
    projection_.pairs.push_back({disc, -1, place, near, -kLeftOver * std::min(radius, of_other), 1, 0});
}

/// Lists the supports of marked bodies, and all walls for those that were thrown.
template <class Real>
void EndProjection<Real>::list_supports(const Inputs& in) {
    if (in.world.walls)
        for (const std::int32_t row : thrown_)
            for (const std::int32_t side : kWallSides)
                if (has_wall(*in.world.walls, side)) list_wall(in, row, side);
    const ContactRows<Real>& supports = in.step.graph.supports;
    supports.for_each([&](std::size_t i) {
        if (projection_.is_marked[static_cast<std::size_t>(supports.a[i])])
            list_support(in, supports.a[i], supports.partner(i));
    });
}

template <class Real>
void EndProjection<Real>::push_in_rounds(const Inputs& in, bool any_deflected) {
    for (int round = 0; round < kRoundsOfProjection; ++round) {
        projection_.pairs.clear(), projection_.planes.clear();
        find_thrown(in);
        list_supports(in);
        projection_.push_from_planes();  // first: a body behind a wall meets those before it
        list_pairs_of_marked(in);
        list_pairs_of_thrown(in);
        if (!projection_.part()) break;
        bool any_new = false;
        for (std::size_t row = 0; row < in.step.records.moving(); ++row) {
            any_new |= projection_.is_moved[row] && !projection_.is_marked[row];
            projection_.is_marked[row] |= projection_.is_moved[row];
        }
        if (!any_new && !any_deflected) break;
    }
}

/// The share of the way of a body, up to where it is now, on which it meets no other.
template <class Real>
double EndProjection<Real>::free_share(const Inputs& in, std::int32_t row, Vec2 way) {
    const auto i = static_cast<std::size_t>(row);
    const Vec2 from = projection_.place[i] - way;
    const double radius = in.world.bodies.radius[i], squared = length_squared(way);
    double free = 1;
    const auto stop_at = [&](std::int32_t other) {
        const auto j = static_cast<std::size_t>(other);
        if (other == row || !in.world.bodies.is_disc(j) ||
            (in.world.has_filters() && !in.world.may_collide(i, j)))
            return;
        const double reach = (radius + static_cast<double>(in.world.bodies.radius[j])) * (1 - kLeftOver);
        const Vec2 apart = from - projection_.place[j];
        const DiscApproach<double> discs(apart.x, apart.y, way.x, way.y, reach);
        const double discriminant = discs.discriminant();
        if (!(discs.approach < 0) || !(discriminant > 0)) return;
        free = std::min(free, std::max(0.0, discs.time_of_impact(discriminant)));
    };
    const std::size_t found = in.flight.candidates.find_around(i, 2 * radius + 0.5 * std::sqrt(squared),
                                                               from + 0.5 * way, near_rows_);
    for (std::size_t k = 0; k < found; ++k) stop_at(near_rows_[k]);
    for (const std::int32_t other : thrown_) stop_at(other);
    return free;
}

/// What is left between two that cannot be pushed apart, one in the middle of a row that is full: the one
/// that came the longer way goes back on it to where it first met another.
template <class Real>
void EndProjection<Real>::put_back_thrown(const Inputs& in) {
    std::vector<Vec2>& place = projection_.place;
    for (const PositionProjection::Pair& pair : projection_.pairs) {
        if (pair.b < 0) continue;
        const Vec2 d = place[static_cast<std::size_t>(pair.b)] - place[static_cast<std::size_t>(pair.a)];
        if (std::sqrt(length_squared(d)) - pair.reach > kStuck / kLeftOver * pair.least) continue;
        const auto way_of = [&](std::int32_t row) {
            const auto i = static_cast<std::size_t>(row);
            return place[i] - in.flight.start_of(i);
        };
        const std::int32_t row =
            length_squared(way_of(pair.b)) > length_squared(way_of(pair.a)) ? pair.b : pair.a;
        const auto i = static_cast<std::size_t>(row);
        if (projection_.is_marked[i] != kDeflectedMark) continue;
        const Vec2 way = way_of(row), from = place[i] - way;
        place[i] = from + free_share(in, row, way) * way, projection_.is_moved[i] = 1;
    }
}

template <class Real>
void EndProjection<Real>::project(const StepView<Real>& step, const WorldState<Real>& world,
                                  const StepFlight<Real>& flight, bool has_deep_pairs) {
    const double largest = flight.fastest * flight.dt / kSwiftWay;  // m, of discs that may be thrown about
    const bool any_small = largest > flight.candidates.smallest_radius();
    if (!any_small && !has_deep_pairs) return;
    const Inputs in{step, world, flight};
    const std::size_t count = step.records.count();
    projection_.is_marked.assign(count, 0);
    const bool any_deflected = any_small && mark_deflected(in, largest);
    const bool any_stuck = any_small && mark_stuck(in, largest);
    if (has_deep_pairs) mark_deep(in);
    if (!any_deflected && !any_stuck && !has_deep_pairs) return;
    projection_.is_moved.assign(count, 0);
    projection_.place.resize(count);
    projection_.pairs.reserve(2 * count);  // as many as a crowd has: rare ones need no memory
    for (std::size_t row = 0; row < count; ++row) projection_.place[row] = step.records.end_of(row, flight);
    push_in_rounds(in, any_deflected);
    put_back_thrown(in);
    for (std::size_t row = 0; row < count; ++row) {
        if (!projection_.is_moved[row]) continue;
        const Vec2 moved = projection_.place[row] - flight.start_of(row);
        step.records.displacement[2 * row] = static_cast<Real>(moved.x);
        step.records.displacement[2 * row + 1] = static_cast<Real>(moved.y);
    }
}

template class EndProjection<float>;
template class EndProjection<double>;

}  // namespace carom
