// What the sweeps of a step cannot see: bodies that are deflected within it, and then move by their own size,
// and many that are deep in each other. At the step's end they are looked at where they are by then.
#include <algorithm>
#include <cmath>

#include "constraints/support_surface.hpp"
#include "effects/touching.hpp"
#include "narrowphase/disc_edge.hpp"
#include "shapes/walls.hpp"
#include "solvers/soft/soft_solver.hpp"

namespace carom {
namespace {

/// A body that the fastest one hits may be thrown about. Bodies are looked at if that moves farther than this
/// in a step, in radii of theirs.
constexpr double kSwiftWay = 4;
/// Of its own radius: who ends a step so far from where it would have flown may be in somebody.
constexpr double kDeflected = 0.05;
/// Of the smaller radius: what is left of an overlap.
constexpr double kLeftOver = 0.02;
/// A body that is pushed may be pushed into others, which are looked at in the next of so many rounds.
constexpr int kRounds = 32;
/// Of the smaller radius: who is deeper after that is put back.
constexpr double kStuck = 0.06;
/// Of a row that was deflected; others are marked by 1.
constexpr std::uint8_t kDeflectedMark = 3;

/// Body and radius are left open.
PositionProjection::Plane wall_of(const Walls& walls, std::int32_t side) {
    const Vec2 n = wall_normal(side);
    const Vec2 corner = wall_corner(walls, side);
    return {-1, n, dot(n, corner), 0};
}

}  // namespace

/// Where a body is at the end of the step, before anything is parted.
template <class Real>
Vec2 SoftSolver<Real>::place_of(std::size_t row, const Column<Real>& motion) const {
    return Vec2{motion[4 * row], motion[4 * row + 1]} +
           Vec2{displacement_[2 * row], displacement_[2 * row + 1]};
}

/// Marks who has not ended where free flight or rest would have taken it, among discs of less than `largest`
/// [m]. @return whether anybody was.
template <class Real>
bool SoftSolver<Real>::mark_deflected(const WorldState<Real>& world, const Column<Real>& motion,
                                      double largest) {
    bool any = false;
    const Vec2 fall = 0.5 * dt_ * dt_ * world.gravity;
    for (std::size_t row = 0; row < count_; ++row) {
        const double radius = world.bodies.radius[row];
        if (radius >= largest || world.bodies.is_immovable(row)) continue;
        const Vec2 off{
            static_cast<double>(displacement_[2 * row]) - dt_ * static_cast<double>(motion[4 * row + 2]),
            static_cast<double>(displacement_[2 * row + 1]) - dt_ * static_cast<double>(motion[4 * row + 3])};
        const double least = kDeflected * radius;
        // Neither at rest nor in free flight.
        if (std::min(length_squared(off), length_squared(off - fall)) < least * least) continue;
        parting_.is_marked[row] = kDeflectedMark, any = true;
    }
    return any;
}

/// Marks who is deep in another one or in a wall now, where one of the two is a disc of less than `largest`
/// [m].
/// @return whether anybody is.
template <class Real>
bool SoftSolver<Real>::mark_stuck(const WorldState<Real>& world, const Column<Real>& motion, double largest) {
    bool any = false;
    const Bodies<Real>& bodies = world.bodies;
    const auto mark = [&](std::int32_t row) {
        parting_.is_marked[static_cast<std::size_t>(row)] |= 1;
        any = true;
    };
    graph.pairs.for_each([&](std::size_t i) {
        if (smaller_radius(i) >= largest) return;
        const auto a = static_cast<std::size_t>(graph.pairs.a[i]),
                   b = static_cast<std::size_t>(graph.pairs.b[i]);
        const double of_a = bodies.radius[a], of_b = bodies.radius[b];
        const double reach = of_a + of_b - kStuck * std::min(of_a, of_b);
        if (length_squared(place_of(b, motion) - place_of(a, motion)) > reach * reach) return;
        mark(graph.pairs.a[i]), mark(graph.pairs.b[i]);
    });
    graph.supports.for_each([&](std::size_t i) {
        const Partner support = graph.supports.partner(i);
        if (!support.is_wall()) return;
        const auto row = static_cast<std::size_t>(graph.supports.a[i]);
        const double radius = bodies.radius[row];
        if (radius >= largest) return;
        const PositionProjection::Plane wall = wall_of(*world.walls, support.side());
        if (dot(wall.normal, place_of(row, motion)) + (1 - kStuck) * radius > wall.end)
            mark(graph.supports.a[i]);
    });
    return any;
}

/// Marks the bodies of pairs that were deep in each other at the start of the step.
template <class Real>
void SoftSolver<Real>::mark_deep() {
    graph.pairs.for_each([&](std::size_t i) {
        if (!graph.pairs.is_live[i / kContactBlock] ||
            static_cast<double>(graph.pairs.separation[i]) > -deep_overlap(smaller_radius(i)) || is_loaded(i))
            return;
        for (const std::int32_t row : {graph.pairs.a[i], graph.pairs.b[i]})
            parting_.is_marked[static_cast<std::size_t>(row)] |= 1;
    });
}

/// Lists two bodies if they are near each other.
template <class Real>
void SoftSolver<Real>::list_parted_pair(const Bodies<Real>& bodies, const Column<Real>& motion,
                                        std::int32_t row_a, std::int32_t row_b, bool is_loaded) {
    const auto a = static_cast<std::size_t>(row_a), b = static_cast<std::size_t>(row_b);
    const double of_a = bodies.radius[a], of_b = bodies.radius[b], smaller = std::min(of_a, of_b);
    const double near = of_a + of_b + smaller;
    if (length_squared(parting_.place[b] - parting_.place[a]) > near * near) return;
    const Vec2 before{static_cast<double>(motion[4 * b]) - static_cast<double>(motion[4 * a]),
                      static_cast<double>(motion[4 * b + 1]) - static_cast<double>(motion[4 * a + 1])};
    // What was there at the start goes no faster than the cap, and what is pressed together is left to the
    // sweeps: pushed apart it would press on others, who push back.
    const double apart = std::sqrt(length_squared(before)) - of_a - of_b +
                         (is_loaded ? 0 : kPushRadiiPerSecond * smaller * dt_);
    const double inverse_a = bodies.inverse_mass(a), inverse_b = bodies.inverse_mass(b);
    const double share_a = inverse_a / (inverse_a + inverse_b);
    parting_.pairs.push_back(
        {row_a, row_b, {}, of_a + of_b, std::min(apart, -kLeftOver * smaller), share_a, 1 - share_a});
}

/// Lists who was thrown out of its margin within this step: the candidate pairs know nothing of whom it meets
/// there.
template <class Real>
void SoftSolver<Real>::find_thrown(const Bodies<Real>& bodies, const Candidates<Real>& candidates) {
    thrown_.clear();
    for (std::size_t row = 0; row < count_; ++row)
        if (parting_.is_marked[row] == kDeflectedMark &&
            candidates.outside_of_margin(row, bodies.radius[row], parting_.place[row]) > 0)
            thrown_.push_back(static_cast<std::int32_t>(row));
    const auto x = [&](std::int32_t row) { return parting_.place[static_cast<std::size_t>(row)].x; };
    std::sort(thrown_.begin(), thrown_.end(), [&](std::int32_t left, std::int32_t right) {
        return x(left) < x(right) || (x(left) == x(right) && left < right);
    });
}

template <class Real>
void SoftSolver<Real>::list_pairs_of_thrown(const Bodies<Real>& bodies, const Column<Real>& motion,
                                            const Candidates<Real>& candidates) {
    double largest = 0;
    for (const std::int32_t row : thrown_)
        largest = std::max(largest, static_cast<double>(bodies.radius[static_cast<std::size_t>(row)]));
    for (std::size_t i = 0; i < thrown_.size(); ++i) {
        const auto row = static_cast<std::size_t>(thrown_[i]);
        const Vec2 place = parting_.place[row];
        const std::size_t found =
            candidates.find_around(row, 2 * static_cast<double>(bodies.radius[row]), place, near_rows_);
        for (std::size_t k = 0; k < found; ++k)
            if (near_rows_[k] != thrown_[i])
                list_parted_pair(bodies, motion, thrown_[i], near_rows_[k], false);
        const double near = 3 * largest;
        for (std::size_t k = i + 1; k < thrown_.size(); ++k) {
            if (parting_.place[static_cast<std::size_t>(thrown_[k])].x > place.x + near) break;
            list_parted_pair(bodies, motion, thrown_[i], thrown_[k], false);
        }
    }
}

/// Whether a contact carries more than the cap on pushes stands for.
template <class Real>
bool SoftSolver<Real>::is_loaded(std::size_t pair) const {
    const double push = radius_varies_ ? push_ * smaller_radius(pair) : push_;
    return static_cast<double>(graph.pairs.normal_impulse[pair]) * substep_dt_ >
           static_cast<double>(graph.pairs.mass[pair]) * push;
}

/// Lists who is near somebody marked.
template <class Real>
void SoftSolver<Real>::list_parted_pairs(const Bodies<Real>& bodies, const Column<Real>& motion) {
    graph.pairs.for_each([&](std::size_t i) {
        const std::int32_t a = graph.pairs.a[i], b = graph.pairs.b[i];
        const int marks =
            parting_.is_marked[static_cast<std::size_t>(a)] | parting_.is_marked[static_cast<std::size_t>(b)];
        if (marks != 0) list_parted_pair(bodies, motion, a, b, marks != kDeflectedMark && is_loaded(i));
    });
}

/// What is left between two that cannot be pushed apart, one in the middle of a row that is full: the one
/// that came the longer way goes back on it to where it first met somebody.
template <class Real>
void SoftSolver<Real>::put_back_thrown(const Bodies<Real>& bodies, const Column<Real>& motion,
                                       const Candidates<Real>& candidates) {
    for (const PositionProjection::Pair& pair : parting_.pairs) {
        if (pair.b < 0) continue;
        const Vec2 d = parting_.place[static_cast<std::size_t>(pair.b)] -
                       parting_.place[static_cast<std::size_t>(pair.a)];
        if (std::sqrt(length_squared(d)) - pair.reach > kStuck / kLeftOver * pair.least) continue;
        const auto way_of = [&](std::int32_t row) {
            const auto i = static_cast<std::size_t>(row);
            return parting_.place[i] - Vec2{motion[4 * i], motion[4 * i + 1]};
        };
        const std::int32_t row =
            length_squared(way_of(pair.b)) > length_squared(way_of(pair.a)) ? pair.b : pair.a;
        const auto i = static_cast<std::size_t>(row);
        if (parting_.is_marked[i] != kDeflectedMark) continue;
        const Vec2 way = way_of(row), from = parting_.place[i] - way;
        const double radius = bodies.radius[i], squared = length_squared(way);
        double free = 1;  // share of the way
        const auto stop_at = [&](std::int32_t other) {
            const auto j = static_cast<std::size_t>(other);
            if (other == row) return;
            const double reach = (radius + static_cast<double>(bodies.radius[j])) * (1 - kLeftOver);
            const Vec2 apart = from - parting_.place[j];
            const DiscApproach<double> discs(apart.x, apart.y, way.x, way.y, reach);
            const double discriminant = discs.discriminant();
            if (!(discs.approach < 0) || !(discriminant > 0)) return;
            free = std::min(free, std::max(0.0, discs.time_of_impact(discriminant)));
        };
        const std::size_t found =
            candidates.find_around(i, 2 * radius + 0.5 * std::sqrt(squared), from + 0.5 * way, near_rows_);
        for (std::size_t k = 0; k < found; ++k) stop_at(near_rows_[k]);
        for (const std::int32_t other : thrown_) stop_at(other);
        parting_.place[i] = from + free * way, parting_.is_moved[i] = 1;
    }
}

template <class Real>
void SoftSolver<Real>::list_parted_supports(const WorldState<Real>& world,
                                            const EdgeCandidates<Real>& edges) {
    const Bodies<Real>& bodies = world.bodies;
    const auto add_wall = [&](std::int32_t disc, std::int32_t side) {
        PositionProjection::Plane& wall = parting_.planes.emplace_back(wall_of(*world.walls, side));
        wall.a = disc, wall.radius = bodies.radius[static_cast<std::size_t>(disc)];
    };
    if (world.walls)
        for (const std::int32_t row : thrown_) {
            for (const std::int32_t side : kWallSides)
                if (has_wall(*world.walls, side)) add_wall(row, side);
        }
    graph.supports.for_each([&](std::size_t i) {
        const std::int32_t disc = graph.supports.a[i];
        const Partner support = graph.supports.partner(i);
        const auto row = static_cast<std::size_t>(disc);
        if (!parting_.is_marked[row]) return;
        const double radius = bodies.radius[row];
        const Vec2 x = parting_.place[row];
        if (support.is_edge()) {
            const Edge& edge = world.edges[support.edge_number()];
            const EdgePose& pose = edges.pose_of(edge);
            const Vec2 p = rotate_back(pose.end_turn, x - pose.end_position);
            const double share = nearest_share(p, edge.a, edge.b);
            if (!is_touched_here(p, share, world.edges, edge)) return;
            const Vec2 d = point_at(edge.a, edge.b, share) - p;
            const double distance = std::sqrt(length_squared(d));
            if (!(distance > 0) || distance > 2 * radius) return;
            const Vec2 n = rotate(pose.end_turn, (1 / distance) * d);
            parting_.planes.push_back({disc, n, dot(n, x) + distance, radius});
        } else if (support.is_wall()) {
            add_wall(disc, support.side());
        } else {
            const auto other = static_cast<std::size_t>(support.row());
            const Vec2 place{bodies.position_x[other] + dt_ * bodies.velocity_x[other],
                             bodies.position_y[other] + dt_ * bodies.velocity_y[other]};
            const double of_other = bodies.radius[other], near = radius + of_other;
            if (length_squared(place - x) > (near + radius) * (near + radius)) return;
            parting_.pairs.push_back({disc, -1, place, near, -kLeftOver * std::min(radius, of_other), 1, 0});
        }
    });
}

template <class Real>
void SoftSolver<Real>::project_positions(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                                         const Column<Real>& motion, const Candidates<Real>& candidates,
                                         double fastest) {
    const double largest = fastest * dt_ / kSwiftWay;  // m, of discs that may be thrown about
    const bool any_small = largest > candidates.smallest_radius();
    if (!any_small && !is_crowded_) return;
    parting_.is_marked.assign(count_, 0);
    const bool any_deflected = any_small && mark_deflected(world, motion, largest);
    const bool any_stuck = any_small && mark_stuck(world, motion, largest);
    if (is_crowded_) mark_deep();
    if (!any_deflected && !any_stuck && !is_crowded_) return;
    parting_.is_moved.assign(count_, 0);
    parting_.place.resize(count_);
    for (std::size_t row = 0; row < count_; ++row) parting_.place[row] = place_of(row, motion);
    for (int round = 0; round < kRounds; ++round) {
        parting_.pairs.clear(), parting_.planes.clear();
        find_thrown(world.bodies, candidates);
        list_parted_supports(world, edges);
        parting_.push_from_planes();  // first: who is behind a wall meets those before it
        list_parted_pairs(world.bodies, motion);
        list_pairs_of_thrown(world.bodies, motion, candidates);
        if (!parting_.part()) break;
        bool any_new = false;
        for (std::size_t row = 0; row < count_; ++row) {
            any_new |= parting_.is_moved[row] && !parting_.is_marked[row];
            parting_.is_marked[row] |= parting_.is_moved[row];
        }
        if (!any_new && !any_deflected) break;
    }
    put_back_thrown(world.bodies, motion, candidates);
    for (std::size_t row = 0; row < count_; ++row) {
        if (!parting_.is_moved[row]) continue;
        displacement_[2 * row] =
            static_cast<Real>(parting_.place[row].x - static_cast<double>(motion[4 * row]));
        displacement_[2 * row + 1] =
            static_cast<Real>(parting_.place[row].y - static_cast<double>(motion[4 * row + 1]));
    }
}

template void SoftSolver<float>::put_back_thrown(const Bodies<float>&, const Column<float>&,
                                                 const Candidates<float>&);
template void SoftSolver<double>::put_back_thrown(const Bodies<double>&, const Column<double>&,
                                                  const Candidates<double>&);
template Vec2 SoftSolver<float>::place_of(std::size_t, const Column<float>&) const;
template Vec2 SoftSolver<double>::place_of(std::size_t, const Column<double>&) const;
template bool SoftSolver<float>::mark_stuck(const WorldState<float>&, const Column<float>&, double);
template bool SoftSolver<double>::mark_stuck(const WorldState<double>&, const Column<double>&, double);
template bool SoftSolver<float>::is_loaded(std::size_t) const;
template bool SoftSolver<double>::is_loaded(std::size_t) const;
template bool SoftSolver<float>::mark_deflected(const WorldState<float>&, const Column<float>&, double);
template bool SoftSolver<double>::mark_deflected(const WorldState<double>&, const Column<double>&, double);
template void SoftSolver<float>::mark_deep();
template void SoftSolver<double>::mark_deep();
template void SoftSolver<float>::list_parted_pair(const Bodies<float>&, const Column<float>&, std::int32_t,
                                                  std::int32_t, bool);
template void SoftSolver<double>::list_parted_pair(const Bodies<double>&, const Column<double>&, std::int32_t,
                                                   std::int32_t, bool);
template void SoftSolver<float>::find_thrown(const Bodies<float>&, const Candidates<float>&);
template void SoftSolver<double>::find_thrown(const Bodies<double>&, const Candidates<double>&);
template void SoftSolver<float>::list_pairs_of_thrown(const Bodies<float>&, const Column<float>&,
                                                      const Candidates<float>&);
template void SoftSolver<double>::list_pairs_of_thrown(const Bodies<double>&, const Column<double>&,
                                                       const Candidates<double>&);
template void SoftSolver<float>::list_parted_pairs(const Bodies<float>&, const Column<float>&);
template void SoftSolver<double>::list_parted_pairs(const Bodies<double>&, const Column<double>&);
template void SoftSolver<float>::list_parted_supports(const WorldState<float>&, const EdgeCandidates<float>&);
template void SoftSolver<double>::list_parted_supports(const WorldState<double>&,
                                                       const EdgeCandidates<double>&);
template void SoftSolver<float>::project_positions(const WorldState<float>&, const EdgeCandidates<float>&,
                                                   const Column<float>&, const Candidates<float>&, double);
template void SoftSolver<double>::project_positions(const WorldState<double>&, const EdgeCandidates<double>&,
                                                    const Column<double>&, const Candidates<double>&, double);

}  // namespace carom
