#include "broadphase/edge_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "narrowphase/disc_edge.hpp"
#include "state/edge_tracks.hpp"

namespace carom {
namespace {

// The margin of an edge that moves: this many steps of its fastest point, but no more than this many of the
// largest radius, unless a single step needs more. It has to last a little longer than the margins of the
// discs that a wall carries, because with it all pairs are found anew; what it costs is that two or three
// layers of discs are looked at instead of one.
constexpr double kStepsOfEdge = 6;
constexpr double kLargestEdgeMargin = 4;
constexpr double kOwnEdgeMargin = 1.25;  // ways of one step that the margin of a fast edge is

// Discs that leave their margins get new ones where they are. Pairs are found as if every reach was larger by
// this share of the usual radius, so that most of these discs need not be looked at again.
constexpr double kAllowance = 0.5;

// An edge that is long beside the discs is looked at in pieces, so that the search stays near it. More pieces
// than this share of the bodies would cost more than to look at all of them.
constexpr double kBodiesPerPiece = 4;
constexpr double kMostPieces = 1024;  // of an edge that has left its margin

// Pairs are counted into rows if there are more of them than one for so many rows: a row costs as much as a
// comparison of a pair, of which there are about ten. Small worlds need no memory for that.
constexpr double kPairsOfRow = 0.1;
constexpr std::size_t kFewPairs = 256;

/// Farthest that a point of the body is from where it was.
double way_between(Vec2 from, double from_angle, Vec2 to, double to_angle, double reach) {
    return std::sqrt(length_squared(to - from)) + std::fabs(to_angle - from_angle) * reach;
}

/// Calls fn(row, its place, its reach and the margin) for each body that edges can stop.
template <class Real, class Fn>
void for_each_disc(const WorldState<Real>& world, const Candidates<Real>& candidates, double margin,
                   const Fn& fn) {
    for (std::size_t row = 0; row < world.bodies.moving(); ++row)
        if ((world.bodies.flags_of(row) & kNotInGrid) == 0 && !world.bodies.is_immovable(row))
            fn(static_cast<std::int32_t>(row),
               Vec2{candidates.grid().built_x()[row], candidates.grid().built_y()[row]},
               static_cast<double>(candidates.first_reach(row)) + margin);
}

}  // namespace

template <class Real>
void EdgeCandidates<Real>::place(const WorldState<Real>& world, double dt) {
    const EdgeStore& edges = world.edges;
    poses_.resize(edges.bodies.size());
    if (!are_rows_known_) find_rows(world);
    if (are_placed_) {
        for (const std::vector<std::int32_t>* const list : {&edges.placed, &edges.movers})
            for (const std::int32_t body : *list) place_body(world, dt, static_cast<std::size_t>(body));
        return;
    }
    for (std::size_t body = 0; body < poses_.size(); ++body)
        if (edges.bodies[body].count > 0) place_body(world, dt, body);
    are_placed_ = true;
}

template <class Real>
void EdgeCandidates<Real>::find_rows(const WorldState<Real>& world) {
    const EdgeStore& edges = world.edges;
    are_rows_known_ = true, have_standing_tracks_ = false;
    auto mover = edges.movers.begin();
    for (std::size_t i = 0; i < poses_.size(); ++i) {
        const EdgeBody& body = edges.bodies[i];
        if (mover != edges.movers.end() && static_cast<std::size_t>(*mover) == i) {
            ++mover;
        } else if (body.count > 0) {
            poses_[i].row = world.handles.row_of_slot(body.id.index);
            have_standing_tracks_ = have_standing_tracks_ || body.count > 1 || body.track >= 0;
        }
    }
}

template <class Real>
void EdgeCandidates<Real>::place_body(const WorldState<Real>& world, double dt, std::size_t number) {
    const Bodies<Real>& bodies = world.bodies;
    const EdgeBody& body = world.edges.bodies[number];
    EdgePose& pose = poses_[number];
    pose.row = world.handles.row_of_slot(body.id.index);
    const std::size_t row = pose.row;
    pose.takes_part = (bodies.flags_of(row) & kDisabled) == 0;
    const auto [position, angle] = frame_of(world, body, row);
    pose.position = position;
    pose.end_position = pose.position + dt * Vec2{bodies.velocity_x[row], bodies.velocity_y[row]};
    if (pose.angle != angle) pose.turn = rotation_by(angle);  // most edges never turn
    pose.angle = angle;
    const double spin = bodies.has_rotation ? static_cast<double>(bodies.angular_velocity[row]) : 0;
    pose.end_angle = pose.angle + dt * spin;
    pose.end_turn = spin == 0 ? pose.turn : rotation_by(pose.end_angle);
}

template <class Real>
void EdgeCandidates<Real>::settle(const WorldState<Real>& world) {
    const Bodies<Real>& bodies = world.bodies;
    for (const std::int32_t mover : world.edges.movers) {
        EdgePose& pose = poses_[static_cast<std::size_t>(mover)];
        const auto [position, angle] =
            frame_of(world, world.edges.bodies[static_cast<std::size_t>(mover)], pose.row);
        pose.end_position = position;
        if (!bodies.has_rotation || pose.end_angle == angle) continue;
        pose.end_angle = angle;
        pose.end_turn = rotation_by(pose.end_angle);
    }
}

template <class Real>
bool EdgeCandidates<Real>::has_left_margin(std::size_t mover, std::size_t body) const {
    const EdgePose& pose = poses_[body];
    const FoundAt& found = found_at_[mover];
    if (pose.end_position == found.position && pose.end_angle == found.angle) return false;
    return way_between(found.position, found.angle, pose.end_position, pose.end_angle, found.reach) >
           found.margin;
}

template <class Real>
bool EdgeCandidates<Real>::has_left_margin(const WorldState<Real>& world) const {
    const std::vector<std::int32_t>& movers = world.edges.movers;
    for (std::size_t i = 0; i < movers.size() && i < found_at_.size(); ++i)
        if (has_left_margin(i, static_cast<std::size_t>(movers[i]))) return true;
    return false;
}

template <class Real>
void EdgeCandidates<Real>::give_margin(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                       std::size_t mover, std::size_t body) {
    const EdgePose& pose = poses_[body];
    const double reach = world.edges.bodies[body].reach,
                 way = way_between(pose.position, pose.angle, pose.end_position, pose.end_angle, reach);
    const double margin =
        std::fmax(kOwnEdgeMargin * way,
                  std::fmin(kStepsOfEdge * way, kLargestEdgeMargin * candidates.largest_radius()));
    found_at_[mover] = {pose.position, pose.turn, pose.angle, reach, margin};
}

template <class Real>
void EdgeCandidates<Real>::find(const WorldState<Real>& world, const Candidates<Real>& candidates) {
    pairs_.clear(), new_pairs_.clear(), added_ = 0;
    allowance_ = kAllowance * candidates.usual_radius();
    const EdgeStore& edges = world.edges;
    found_at_.resize(edges.movers.size());
    if (edges.empty()) return;
    double largest_reach = 0;
    const Bodies<Real>& bodies = world.bodies;
    for (std::size_t row = 0; row < bodies.moving(); ++row)
        if ((bodies.flags_of(row) & kNotInGrid) == 0)
            largest_reach = std::fmax(largest_reach, static_cast<double>(candidates.first_reach(row)));
    const double farther = allowance_ + candidates.largest_drift();
    for (std::size_t i = 0; i < found_at_.size(); ++i) {
        const auto body = static_cast<std::size_t>(edges.movers[i]);
        give_margin(world, candidates, i, body);
        if (poses_[body].takes_part && largest_reach > 0)
            find_of_body(world, candidates, body, found_at_[i].margin + farther, largest_reach);
    }
    if (largest_reach == 0) return;
    // A query for each disc costs about as much as one for each edge.
    if (edges.standing.count() > bodies.moving()) {
        find_standing(world, candidates, farther);
    } else {
        auto mover = edges.movers.begin();
        for (std::size_t i = 0; i < poses_.size(); ++i)
            if (mover != edges.movers.end() && static_cast<std::size_t>(*mover) == i)
                ++mover;
            else
                find_of_body(world, candidates, i, farther, largest_reach);
    }
    sort_pairs(bodies.moving());
}

/// Sorts the pairs: they are counted into their rows, where most come by edge already; if they are few beside
/// the rows, they are compared.
template <class Real>
void EdgeCandidates<Real>::sort_pairs(std::size_t rows) {
    if (pairs_.size() < kFewPairs ||
        static_cast<double>(pairs_.size()) < kPairsOfRow * static_cast<double>(rows)) {
        std::sort(pairs_.begin(), pairs_.end());
        return;
    }
    first_of_row_.assign(rows + 1, 0);
    for (const EdgePair& pair : pairs_) ++first_of_row_[static_cast<std::size_t>(pair.row) + 1];
    std::partial_sum(first_of_row_.begin(), first_of_row_.end(), first_of_row_.begin());
    unsorted_.swap(pairs_), pairs_.resize(unsorted_.size());
    for (const EdgePair& pair : unsorted_) pairs_[first_of_row_[static_cast<std::size_t>(pair.row)]++] = pair;
    for (auto first = pairs_.begin(), last = first; first != pairs_.end(); first = last) {
        while (last != pairs_.end() && last->row == first->row) ++last;
        if (!std::is_sorted(first, last)) std::sort(first, last);
    }
}

/// All discs that can touch an edge of one body.
template <class Real>
void EdgeCandidates<Real>::find_of_body(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                        std::size_t number, double margin, double largest_reach) {
    const EdgeBody& body = world.edges.bodies[number];
    if (static_cast<std::size_t>(body.count) > world.bodies.moving())
        return find_near_discs(world, candidates, number, margin);
    for (std::int32_t n = 0; n < body.count; ++n)
        find_near_edge(world, candidates, body.first + n, margin, largest_reach);
}

template <class Real>
void EdgeCandidates<Real>::add_strays(const WorldState<Real>& world, const Candidates<Real>& candidates) {
    new_pairs_.clear();
    const EdgeStore& edges = world.edges;
    if (edges.empty()) return;
    for (const std::int32_t stray : candidates.strays()) {
        const auto row = static_cast<std::size_t>(stray);
        if (world.bodies.is_immovable(row)) continue;
        const Vec2 p{candidates.built_x()[row], candidates.built_y()[row]};
        const double reach = static_cast<double>(candidates.reach()[row]) + candidates.largest_drift();
        if (candidates.farther_than_first(row) <= allowance_) continue;
        std::size_t mover = 0;
        edges.for_each_body_near(p, reach, near_bodies_, [&](std::int32_t number) {
            const auto i = static_cast<std::size_t>(number);
            FoundAt at{poses_[i].position, poses_[i].turn};
            if (mover < edges.movers.size() && edges.movers[mover] == number) at = found_at_[mover++];
            if (!poses_[i].takes_part || is_forbidden(world, stray, poses_[i])) return;
            const Vec2 place = rotate_back(at.turn, p - at.position);
            const double near = candidates.reach()[row] + at.margin + candidates.largest_drift();
            edges.for_each_near(edges.bodies[i], place, near, [&](std::int32_t edge) {
                if (distance_squared(place, edges[edge].a, edges[edge].b) < near * near)
                    add_pair({stray, edge});
            });
        });
    }
    for (std::size_t mover = 0; mover < found_at_.size(); ++mover) {
        const auto body = static_cast<std::size_t>(edges.movers[mover]);
        if (!has_left_margin(mover, body)) continue;
        give_margin(world, candidates, mover, body);
        if (poses_[body].takes_part) add_around_edges(world, candidates, body, found_at_[mover].margin);
    }
    added_ += new_pairs_.size();
}

template <class Real>
void EdgeCandidates<Real>::add_pair(EdgePair pair) {
    const auto where = std::lower_bound(pairs_.begin(), pairs_.end(), pair);
    if (where != pairs_.end() && *where == pair) return;
    pairs_.insert(where, pair);
    new_pairs_.push_back(pair);
}

/// What the edges of a body reach where they are now: as find_near_edge, but by the margins that discs have
/// now.
template <class Real>
void EdgeCandidates<Real>::add_around_edges(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                            std::size_t number, double own_margin) {
    const EdgeBody& body = world.edges.bodies[number];
    const double margin = own_margin + allowance_ + candidates.largest_drift();
    for (std::int32_t edge = body.first; edge < body.first + body.count; ++edge) {
        const EdgePose& pose = poses_[number];
        const Vec2 a = pose.position + rotate(pose.turn, world.edges[edge].a),
                   b = pose.position + rotate(pose.turn, world.edges[edge].b);
        const double length = std::sqrt(length_squared(b - a)), rounding = rounding_of<Real>(a, b);
        const double half = std::fmax(margin, candidates.largest_radius());
        const double pieces = std::fmax(1, std::fmin(std::ceil(length / (2 * half)), kMostPieces));
        for (double piece = 0; piece < pieces; ++piece) {
            const Vec2 middle = a + ((piece + 0.5) / pieces) * (b - a);
            const std::size_t found =
                candidates.find_margins_near(middle, 0.5 * length / pieces + margin + rounding, near_);
            for (std::size_t n = 0; n < found; ++n) {
                const auto row = static_cast<std::size_t>(near_[n]);
                if (world.bodies.is_immovable(row) || is_forbidden(world, near_[n], pose)) continue;
                const double near = static_cast<double>(candidates.reach()[row]) + margin + rounding;
                if (distance_squared(Vec2{candidates.built_x()[row], candidates.built_y()[row]}, a, b) <
                    near * near)
                    add_pair({near_[n], edge});
            }
        }
    }
}

template <class Real>
void EdgeCandidates<Real>::follow_rows(std::span<const std::int32_t> now,
                                       std::span<const std::uint8_t> is_elsewhere) {
    forget_rows();
    const auto is_gone = [&](EdgePair& pair) {
        pair.row = now[static_cast<std::size_t>(pair.row)];
        return pair.row < 0 || is_elsewhere[static_cast<std::size_t>(pair.row)];
    };
    std::erase_if(pairs_, is_gone);
    std::sort(pairs_.begin(), pairs_.end());
}

/// The same pairs as of find_near_edge for each edge of a body, found disc by disc.
template <class Real>
void EdgeCandidates<Real>::find_near_discs(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                           std::size_t number, double margin) {
    for_each_disc(world, candidates, margin, [&](std::int32_t disc, Vec2 p, double reach) {
        find_near_disc(world, disc, p, reach, number);
    });
}

/// Likewise for all bodies that stand.
template <class Real>
void EdgeCandidates<Real>::find_standing(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                         double margin) {
    for_each_disc(world, candidates, margin, [&](std::int32_t disc, Vec2 p, double reach) {
        world.edges.standing.find(box_around(p, reach), near_bodies_);
        for (const std::int32_t number : near_bodies_)
            find_near_disc(world, disc, p, reach, static_cast<std::size_t>(number));
    });
}

template <class Real>
void EdgeCandidates<Real>::find_near_disc(const WorldState<Real>& world, std::int32_t disc, Vec2 p,
                                          double wanted, std::size_t number) {
    const EdgeBody& body = world.edges.bodies[number];
    const EdgePose& pose = poses_[number];
    if (is_forbidden(world, disc, pose)) return;
    const double most_rounding = 2 * rounding_of<Real>(pose.position, {body.reach, body.reach});
    world.edges.for_each_near(body, rotate_back(pose.turn, p - pose.position), wanted + most_rounding,
                              [&](std::int32_t edge) {
                                  const Vec2 a = pose.position + rotate(pose.turn, world.edges[edge].a),
                                             b = pose.position + rotate(pose.turn, world.edges[edge].b);
                                  const double near = wanted + rounding_of<Real>(a, b);
                                  if (distance_squared(p, a, b) < near * near) pairs_.push_back({disc, edge});
                              });
}

template <class Real>
void EdgeCandidates<Real>::find_near_edge(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                          std::int32_t number, double margin, double largest_reach) {
    const Edge& edge = world.edges[number];
    const EdgePose& pose = pose_of(edge);
    const Vec2 a = pose.position + rotate(pose.turn, edge.a), b = pose.position + rotate(pose.turn, edge.b);
    const Bodies<Real>& bodies = world.bodies;
    const double length = std::sqrt(length_squared(b - a));
    const double rounding = rounding_of<Real>(a, b);
    // Half a piece and the margin are to be no more than the size of a cell: the quickest kind of query.
    // Where the margin is larger than that, pieces of its size look at the least cells.
    const double half = std::fmax(largest_reach - margin, margin);
    const double most = std::fmax(1, static_cast<double>(bodies.moving()) / kBodiesPerPiece);
    const double pieces = std::fmax(1, std::fmin(std::ceil(length / (2 * half)), std::floor(most)));
    for (double piece = 0; piece < pieces; ++piece) {
        const Vec2 middle = a + ((piece + 0.5) / pieces) * (b - a);
        std::size_t found = candidates.find_near(middle, 0.5 * length / pieces + margin + rounding, near_);
        if (world.has_filters()) {
            std::int32_t* const rows = near_.data();
            found = static_cast<std::size_t>(
                std::remove_if(rows, rows + found,
                               [&](std::int32_t row) { return is_forbidden(world, row, pose); }) -
                rows);
        }
        for (std::size_t n = 0; n < found; ++n) {
            const auto row = static_cast<std::size_t>(near_[n]);
            if (bodies.is_immovable(row)) continue;
            const Vec2 p{candidates.grid().built_x()[row], candidates.grid().built_y()[row]};
            const double share = nearest_share(p, a, b);
            // Each disc belongs to the piece it is nearest to.
            if (std::fmin(std::floor(share * pieces), pieces - 1) != piece) continue;
            const double near = static_cast<double>(candidates.first_reach(row)) + margin + rounding;
            if (length_squared(p - point_at(a, b, share)) < near * near) pairs_.push_back({near_[n], number});
        }
    }
}

template class EdgeCandidates<float>;
template class EdgeCandidates<double>;

}  // namespace carom
