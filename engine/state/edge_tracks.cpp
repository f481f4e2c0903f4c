#include "state/edge_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "narrowphase/disc_edge.hpp"

namespace carom {
namespace {

/// Ends of two segments are one point if each lies on the other segment but for this share of the shorter
/// one: beyond what rounding leaves of places that a scene computes, below what a disc feels.
constexpr double kSamePlace = 1e-6;
/// They lie no farther from each other than this share: segments that overlap along a line.
constexpr double kMostOverlap = 0.01;
/// Cosine of the turn from one segment to the next, at least: what is folded back is no way on.
constexpr double kFold = -0.99;
/// Ends are sorted by x + this y: squares of a grid have many ends in a line, but few in one along this way.
constexpr double kSlope = 0.618;
constexpr double kSteepest = 1 + kSlope;  // change of that by m of distance, at most

/// An end of a segment.
struct End {
    Vec2 at, other;  // m, in the world: of the other end of the segment
    double length, key;
    std::int32_t body;  // of EdgeStore::bodies
    bool is_b;
};

struct Meeting {
    double cosine;
    std::size_t i, j;  // ends
};

bool lies_on(Vec2 p, const End& end, double near) {
    return distance_squared(p, end.at, end.other) <= near * near;
}

template <class Real>
void list_ends(const WorldState<Real>& world, std::vector<End>& ends) {
    for (std::size_t i = 0; i < world.edges.bodies.size(); ++i) {
        const EdgeBody& body = world.edges.bodies[i];
        const std::size_t row = world.handles.row_of_slot(body.id.index);
        if (body.count != 1 || (world.bodies.flags_of(row) & (kKinematic | kSensor | kDisabled)) != 0)
            continue;
        const EdgeFrame frame = frame_of(world, body, row);
        const Rotation turn = rotation_by(frame.angle);
        const Edge& edge = world.edges[body.first];
        const Vec2 a = frame.position + rotate(turn, edge.a), b = frame.position + rotate(turn, edge.b);
        const double length = std::sqrt(length_squared(b - a));
        const auto number = static_cast<std::int32_t>(i);
        ends.push_back({a, b, length, a.x + kSlope * a.y, number, false});
        ends.push_back({b, a, length, b.x + kSlope * b.y, number, true});
    }
}

template <class Real>
bool are_filtered_alike(const WorldState<Real>& world, std::int32_t one, std::int32_t other) {
    const auto row_of = [&](std::int32_t body) {
        return world.handles.row_of_slot(world.edges.bodies[static_cast<std::size_t>(body)].id.index);
    };
    return world.bodies.are_filtered_alike(row_of(one), row_of(other));
}

/// Ends that coincide, the straightest first.
template <class Real>
std::vector<Meeting> meetings_of(const WorldState<Real>& world, const std::vector<End>& ends) {
    std::vector<std::size_t> order(ends.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        return ends[i].key != ends[j].key ? ends[i].key < ends[j].key : i < j;
    });
    std::vector<Meeting> meetings;
    const auto look_at = [&](std::size_t i, std::size_t j) {
        const End &one = ends[i], &other = ends[j];
        const double shorter = std::fmin(one.length, other.length), near = kSamePlace * shorter;
        if (one.body == other.body ||
            length_squared(one.at - other.at) > kMostOverlap * kMostOverlap * shorter * shorter ||
            !lies_on(one.at, other, near) || !lies_on(other.at, one, near))
            return;
        const double cosine = dot(one.at - one.other, other.other - other.at) / (one.length * other.length);
        if (cosine > kFold && are_filtered_alike(world, one.body, other.body))
            meetings.push_back({cosine, std::min(i, j), std::max(i, j)});
    };
    for (std::size_t n = 0; n < order.size(); ++n)
        for (std::size_t m = n + 1; m < order.size(); ++m) {
            const End &one = ends[order[n]], &other = ends[order[m]];
            if (other.key - one.key > kSteepest * kMostOverlap * one.length) break;
            look_at(order[n], order[m]);
        }
    std::sort(meetings.begin(), meetings.end(), [](const Meeting& l, const Meeting& r) {
        if (l.cosine != r.cosine) return l.cosine > r.cosine;
        return l.i != r.i ? l.i < r.i : l.j < r.j;
    });
    return meetings;
}

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// Makes a track of all segments that are joined with one another.
/// @param joined  by end: the one that it is joined with, or kNone  @param first  an end of one of them
void make_track(EdgeStore& store, const std::vector<End>& ends, const std::vector<std::size_t>& joined,
                std::size_t first, std::int32_t track) {
    const auto other_end = [](std::size_t end) { return end ^ 1U; };
    std::size_t begin = first;  // where the track comes in
    while (joined[begin] != kNone && other_end(joined[begin]) != first) begin = other_end(joined[begin]);
    const bool is_loop = joined[begin] != kNone;
    if (is_loop) begin = first;
    const auto edge_of = [&](std::size_t end) {
        return store.bodies[static_cast<std::size_t>(ends[end].body)].first;
    };
    std::size_t in = begin;
    for (;;) {
        EdgeBody& body = store.bodies[static_cast<std::size_t>(ends[in].body)];
        Edge& edge = store.edges[static_cast<std::size_t>(body.first)];
        body.track = track, body.own_a = edge.a, body.own_b = edge.b;
        const std::size_t out = other_end(in);
        edge.a = ends[in].at, edge.b = ends[out].at;
        edge.previous = joined[in] == kNone ? -1 : edge_of(joined[in]);
        edge.next = joined[out] == kNone ? -1 : edge_of(joined[out]);
        body.own_reach = body.reach;
        body.reach = std::sqrt(std::fmax(length_squared(edge.a), length_squared(edge.b)));
        in = joined[out];
        if (in == kNone || in == begin) return;
    }
}

}  // namespace

template <class Real>
bool join_segments(WorldState<Real>& world) {
    EdgeStore& store = world.edges;
    if (store.is_joined) return false;
    store.is_joined = true;
    std::vector<End> ends;
    list_ends(world, ends);
    const std::vector<Meeting> meetings = meetings_of(world, ends);
    std::vector<std::size_t> joined(ends.size(), kNone);
    for (const Meeting& meeting : meetings)
        if (joined[meeting.i] == kNone && joined[meeting.j] == kNone)
            joined[meeting.i] = meeting.j, joined[meeting.j] = meeting.i;
    for (std::size_t end = 0; end < ends.size(); end += 2) {
        const bool is_alone = joined[end] == kNone && joined[end + 1] == kNone;
        if (!is_alone && store.bodies[static_cast<std::size_t>(ends[end].body)].track < 0)
            make_track(store, ends, joined, end, ends[end].body);
    }
    return true;
}

template bool join_segments(WorldState<float>&);
template bool join_segments(WorldState<double>&);

}  // namespace carom
