#include "narrowphase/convex_edge.hpp"

#include <algorithm>
#include <cmath>

#include "narrowphase/disc_edge.hpp"
#include "narrowphase/placed_pair.hpp"

namespace carom {
namespace {

/// Half the length of a wall [m]: beyond any body, and its square is a number.
constexpr double kFar = 1e15;
/// Edges whose normals are closer than this [rad], and whose lines are in shares of the body's inradius, are
/// one.
constexpr double kSameLine = 1e-3;
/// Sine of the angle between normal and edge below which the body's centre says on which side it is.
constexpr double kEndOn = 0.1;
/// An overlap along the edge's own normal may be so many times that along the nearest way out.
constexpr double kDeeperAlongOwn = 2;
/// Normals this much shorter than 1 along the edge's own are its own: 1e-6 rad.
constexpr double kOwnNormal = 1e-12;

/// Distances beyond a margin by less than this share of the body's size are looked at whole: those of faces
/// and those of points round apart.
constexpr double kRoundingOfGap = 1e-9;

/// A body in its own frame beside one edge after the other: only what is of the edge is written anew.
struct SeenBody {
    const PlacedConvex& body;
    ConvexPair<double> pair;
    int places;                     // of both polygons: two, or as many as the body has vertices
    double heights[kMostVertices];  // m, of the faces over the centre

    explicit SeenBody(const PlacedConvex& of) : body(of), places(std::max(of.shape.count, 2)) {
        for (int i = 0; i < places; ++i) {
            pair.a.x[i] = of.shape.x[i], pair.a.y[i] = of.shape.y[i];
            pair.a.normal_x[i] = of.shape.normal_x[i], pair.a.normal_y[i] = of.shape.normal_y[i];
            heights[i] = of.shape.normal_x[i] * of.shape.x[i] + of.shape.normal_y[i] * of.shape.y[i];
        }
        pair.a.count = of.shape.count, pair.a.last = places - 1;
        pair.b.count = 2, pair.b.last = places - 1;
        const Vec2 origin = rotate_back(of.turn, -of.centre);
        pair.b_x = origin.x, pair.b_y = origin.y;
        pair.radius_a = of.shape.radius, pair.radius_b = 0;
        pair.size = of.shape.inradius;
    }
};

/// An edge and what the body sees of it.
struct SeenEdge {
    const PlacedConvex& body;
    const Edge& edge;
    const ConvexPair<double>& pair;
    Vec2 from, to;            // m, in the frame of the body
    Vec2 left;                // unit normal, likewise
    Face<double> of_a, of_b;  // of either, from which the other is farthest

    SeenEdge(SeenBody& seen, const Edge& line) : body(seen.body), edge(line), pair(seen.pair) {
        from = rotate_back(body.turn, edge.a - body.centre);
        to = rotate_back(body.turn, edge.b - body.centre);
        const Vec2 along = to - from;
        left = 1 / std::sqrt(length_squared(along)) * Vec2{-along.y, along.x};
        Polygons<double>& b = seen.pair.b;
        // From `from` to `to` the outward normal is on the right, on the way back on the left.
        b.x[0] = from.x, b.y[0] = from.y, b.normal_x[0] = -left.x, b.normal_y[0] = -left.y;
        for (int i = 1; i < seen.places; ++i)
            b.x[i] = to.x, b.y[i] = to.y, b.normal_x[i] = left.x, b.normal_y[i] = left.y;
        find_faces(seen);
    }

    /// What farthest_face() says of the body and of the edge, which has two faces back to back.
    void find_faces(const SeenBody& seen) {
        const Polygons<double>& a = pair.a;
        double lowest = dot(left, {a.x[0], a.y[0]}), highest = lowest;
        for (int i = 1; i < a.count; ++i) {
            const double height = dot(left, {a.x[i], a.y[i]});
            lowest = std::min(lowest, height), highest = std::max(highest, height);
        }
        const double on_left = lowest - dot(left, to), on_right = dot(left, from) - highest;
        of_b = on_right > on_left ? Face<double>{on_right, -left.x, -left.y, from.x, from.y, to.x, to.y}
                                  : Face<double>{on_left, left.x, left.y, to.x, to.y, from.x, from.y};
        int best = a.last;
        double farthest = 0;
        for (int end = 0, i = a.last; end < a.count; i = end++) {
            const Vec2 n{a.normal_x[i], a.normal_y[i]};
            const double separation = std::min(dot(n, from), dot(n, to)) - seen.heights[i];
            if (end == 0 || separation > farthest) farthest = separation, best = i;
        }
        const int next = best == a.last ? 0 : best + 1;
        of_a = {a.count > 1 ? farthest : -kNoPoint,
                a.normal_x[best],
                a.normal_y[best],
                a.x[best],
                a.y[best],
                a.x[next],
                a.y[next]};
    }

    /// Whether they are farther apart than `margin` along the normal of a face of either, which is nearer
    /// than their points are: most edges that are looked at are so.
    bool are_apart(double margin) const {
        const double beyond = margin + pair.radius_a + kRoundingOfGap * (margin + body.shape.extent);
        return of_a.separation > beyond || of_b.separation > beyond;
    }

    FacedPair<double> nearest() const {
        FacedPair<double> faced;
        see_face<double>(pair, of_a, of_b, faced);
        return faced;
    }

    /// The manifold with the edge's own normal; without points where the body is not over the edge. What has
    /// just passed its end still is over it: rounding must not put it between two edges.
    /// @param nearest, found  how the pair sees itself, and the manifold of that
    Manifold<double> along_own_normal(double side, const FacedPair<double>& nearest,
                                      Manifold<double> found) const {
        const Vec2 n = side * left;
        const FaceView<double>& view = nearest.view;
        const bool is_seen_from_here = nearest.side < 0 && nearest.normal_x == n.x && nearest.normal_y == n.y;
        // Where all of the body's face is over the edge it does not matter where that ends.
        const bool is_over = view.from < view.to && view.from <= view.low_along &&
                             view.low_along <= view.high_along && view.high_along <= view.to;
        if (!is_seen_from_here || !is_over) {
            FacedPair<double> faced = nearest;
            if (!is_seen_from_here) {
                const bool is_left = side > 0;
                const Vec2 start = is_left ? to : from, end = is_left ? from : to;
                view_from<double>(Face<double>{0, n.x, n.y, start.x, start.y, end.x, end.y}, true, pair,
                                  faced);
            }
            faced.view.from -= kSameLine * pair.size, faced.view.to += kSameLine * pair.size;
            found = manifold_from(faced, body.turn);
        }
        const Vec2 own = -rotate(body.turn, n);
        if (dot(own, {found.normal_x, found.normal_y}) < 1 - kOwnNormal)
            found.separation1 = found.separation2 = kNoPoint;
        return found;
    }
};

Vec2 normal_of(const Manifold<double>& m) {
    return {m.normal_x, m.normal_y};
}
double lowest_of(const Manifold<double>& m) {
    return std::min(m.separation1, m.separation2);
}

/// The left unit normal of an edge.
Vec2 left_normal(const Edge& edge) {
    const Vec2 along = edge.b - edge.a;
    return 1 / std::sqrt(length_squared(along)) * Vec2{-along.y, along.x};
}

/// A place in a manifold, from the origin of b.
Vec2 place_of(const Manifold<double>& m, double lever_b) {
    return m.lever_b_t * normal_of(m) - lever_b * Vec2{-m.normal_y, m.normal_x};
}

/// The point of an edge that is nearest to p.
Vec2 nearest_point(const Edge& edge, Vec2 p) {
    return edge.a + nearest_share(p, edge.a, edge.b) * (edge.b - edge.a);
}

/// Whether a line from the centre of the body to a point passes through another edge of the chain: 1, or only
/// meets its end: 0, or neither: -1.
int crosses(const Edge& other, Vec2 centre, Vec2 point) {
    const Vec2 way = other.b - other.a;
    const double of_point = cross(way, point - other.a), of_centre = cross(way, centre - other.a);
    const double scale = kOwnNormal * length_squared(way);
    if (std::fabs(of_point) <= scale) return 0;
    if (of_point > 0 ? of_centre >= 0 : of_centre <= 0) return -1;
    const double part = of_centre / (of_centre - of_point);
    const double place = dot(centre + part * (point - centre) - other.a, way);
    return place > 0 && place < length_squared(way) ? 1 : -1;
}

/// Sine of the angle by which the chain turns from one edge to the next, positive to the left: towards a body
/// on that side.
double bend(const Edge& edge, const Edge& neighbour, bool is_before) {
    const Vec2 along = edge.b - edge.a, way = neighbour.b - neighbour.a;
    const double sine = cross(along, way) / std::sqrt(length_squared(along) * length_squared(way));
    return is_before ? -sine : sine;
}

/// Whether all that a body touches of an edge lies behind the edge before or after it, or is the corner of a
/// bend towards it: then it has sunk into that one a little, and what is behind is the inside of a corner,
/// which it does not touch.
bool is_behind_neighbour(const SeenEdge& seen, std::span<const Edge> edges, const Manifold<double>& m,
                         double side) {
    const Vec2 point1 = nearest_point(seen.edge, place_of(m, m.lever_b1)),
               point2 = nearest_point(seen.edge, place_of(m, m.lever_b2));
    for (const std::int32_t number : {seen.edge.previous, seen.edge.next}) {
        if (number < 0) continue;
        const Edge& other = edges[static_cast<std::size_t>(number)];
        const int first = crosses(other, seen.body.centre, point1),
                  second = crosses(other, seen.body.centre, point2);
        if (first + second > 0) return true;
        // Neither of two edges in one line has anything behind it, though round-off may bend them.
        const double towards = side * bend(seen.edge, other, number == seen.edge.previous);
        if (first == 0 && second == 0 && towards > kSameLine) return true;
    }
    return false;
}

/// What an edge may push with, of what it would push with were it alone.
/// @param left  its left unit normal
Manifold<double> allowed(const SeenEdge& seen, std::span<const Edge> edges, Vec2 left, double margin) {
    const FacedPair<double> nearest = seen.nearest();
    Manifold<double> found = manifold_from(nearest, seen.body.turn);
    if (lowest_of(found) > margin) return found;
    const Edge& edge = seen.edge;
    const Vec2 push = -normal_of(found);  // from the edge to the body
    const double centre_side = dot(seen.body.centre - edge.a, left) < 0 ? -1 : 1;
    const double lift = dot(push, left);
    const double side = std::fabs(lift) < kEndOn ? centre_side : lift < 0 ? -1 : 1;
    const Vec2 own = side * left;
    const auto nothing = [&] {
        Manifold<double> none = found;
        none.separation1 = none.separation2 = kNoPoint;
        return none;
    };
    const double to_own = dot(push, own);
    const auto flat = [&](double on) {
        const Manifold<double> m = seen.along_own_normal(on, nearest, found);
        return lowest_of(m) > margin ? nothing() : m;
    };
    if (to_own > 1 - kOwnNormal)
        return is_behind_neighbour(seen, edges, found, side) ? nothing() : flat(side);

    // At which end: the place of the lowest point along the edge.
    const bool is_first = found.separation1 <= found.separation2;
    const double lever = is_first ? found.lever_b1 : found.lever_b2;
    const Vec2 point = place_of(found, lever);
    const Vec2 along = edge.b - edge.a;
    const bool at_start = dot(point - edge.a, along) < 0.5 * length_squared(along);
    const std::int32_t neighbour = at_start ? edge.previous : edge.next;
    if (neighbour < 0) {  // what lies flat on a free end lies on the edge
        const Manifold<double> m = to_own < kParallel ? nothing() : flat(side);
        return lowest_of(m) > margin ? found : m;
    }

    const Edge& other = edges[static_cast<std::size_t>(neighbour)];
    const Vec2 others = side * left_normal(other);
    const double cosine = dot(own, others);
    const double to_other = dot(push, others);
    const bool is_convex = side * bend(edge, other, at_start) < 0;
    if (cosine < kParallel && is_convex && to_own >= cosine && to_other >= cosine) {
        const bool is_mine = at_start ? to_own > to_other : to_own >= to_other;
        if (is_mine) return found;
    }
    // Where the chain goes straight on, what has sunk into it may be nearest to a way out along it.
    if (cosine >= kParallel) return flat(centre_side);
    if (to_own >= kParallel) return flat(side);
    // The way out of an overlap may lead away from the neighbour, or across it where both face each other:
    // the nearest that this edge may push along is its own normal, if that is a way out as well.
    if (lowest_of(found) < 0 && (!is_convex || to_other < cosine)) {
        const Manifold<double> m = flat(side);
        const bool is_way_out = lowest_of(m) >= kDeeperAlongOwn * lowest_of(found);
        if (is_way_out && !is_behind_neighbour(seen, edges, m, side)) return m;
    }
    return nothing();
}

/// Levers about b fall along the tangent: r x n = -(r . t).
/// Points of edges in one line: of all the two that are extreme along it.
void take_extremes(ChainManifold& line, const Manifold<double>& m, std::int32_t edge) {
    Manifold<double>& to = line.manifold;
    if (lowest_of(m) < lowest_of(to)) {
        line.edge = edge;
        to.lever_a_t = m.lever_a_t, to.lever_b_t = m.lever_b_t;
    }
    const bool had_two = to.separation2 < kNoPoint, has_two = m.separation2 < kNoPoint;
    const Manifold<double> was = to;
    if (m.lever_b1 > was.lever_b1)
        to.lever_a1 = m.lever_a1, to.lever_b1 = m.lever_b1, to.separation1 = m.separation1;
    const double last_was = had_two ? was.lever_b2 : was.lever_b1, last = has_two ? m.lever_b2 : m.lever_b1;
    if (last < last_was) {
        to.lever_a2 = has_two ? m.lever_a2 : m.lever_a1, to.lever_b2 = last;
        to.separation2 = has_two ? m.separation2 : m.separation1;
    } else if (!had_two) {
        to.lever_a2 = was.lever_a1, to.lever_b2 = was.lever_b1, to.separation2 = was.separation1;
    }
}

/// Two points that are one.
void join_points(Manifold<double>& m, double size) {
    if (m.separation2 >= kNoPoint || m.lever_b1 - m.lever_b2 > kNoLength * size) return;
    if (m.separation2 < m.separation1)
        m.separation1 = m.separation2, m.lever_a1 = m.lever_a2, m.lever_b1 = m.lever_b2;
    m.lever_a2 = m.lever_a1, m.lever_b2 = m.lever_b1, m.separation2 = kNoPoint;
}

}  // namespace

Manifold<double> manifold_on_plane(const PlacedConvex& body, Vec2 normal, Vec2 point) {
    const Vec2 n = rotate_back(body.turn, -normal), at = rotate_back(body.turn, point - body.centre);
    ConvexPair<double> pair;
    take_polygon(body.shape, pair.a);
    pair.b.count = 1, pair.b.last = kMostVertices - 1;
    for (int i = 0; i < kMostVertices; ++i) {
        pair.b.x[i] = at.x, pair.b.y[i] = at.y;
        pair.b.normal_x[i] = n.x, pair.b.normal_y[i] = n.y;
    }
    pair.b_x = at.x, pair.b_y = at.y;
    pair.radius_a = body.shape.radius, pair.radius_b = 0, pair.size = body.shape.inradius;
    FacedPair<double> faced;
    view_from<double>(Face<double>{0, n.x, n.y, at.x, at.y, at.x, at.y}, true, pair, faced);
    faced.view.from = -kFar, faced.view.to = kFar;
    return manifold_from(faced, body.turn);
}

void find_chain_manifolds(const PlacedConvex& body, std::span<const Edge> edges,
                          std::span<const std::int32_t> near, double margin,
                          std::vector<ChainManifold>& found) {
    const double size = body.shape.inradius, reach = kWiderCircle * (body.shape.extent + margin);
    const auto first = static_cast<std::ptrdiff_t>(found.size());
    SeenBody seen_body(body);
    for (const std::int32_t number : near) {
        const Edge& edge = edges[static_cast<std::size_t>(number)];
        if (distance_squared(body.centre, edge.a, edge.b) > reach * reach) continue;
        const SeenEdge seen(seen_body, edge);
        if (seen.are_apart(margin)) continue;
        const Vec2 left = left_normal(edge);
        const Manifold<double> m = allowed(seen, edges, left, margin);
        if (lowest_of(m) > margin) continue;
        const Vec2 n = normal_of(m);
        const double height = dot(n, edge.a);
        const bool is_own = std::fabs(dot(n, left)) > 1 - kSameLine * kSameLine;
        const auto line = std::find_if(found.begin() + first, found.end(), [&](const ChainManifold& other) {
            return is_own && length_squared(n - normal_of(other.manifold)) < kSameLine * kSameLine &&
                   std::fabs(height - other.height) < kSameLine * size;
        });
        if (line == found.end())
            found.push_back({m, number, is_own ? height : kFar});
        else
            take_extremes(*line, m, number);
    }
    for (auto line = found.begin() + first; line != found.end(); ++line) join_points(line->manifold, size);
    std::sort(found.begin() + first, found.end(),
              [](const ChainManifold& l, const ChainManifold& r) { return l.edge < r.edge; });
}

}  // namespace carom
