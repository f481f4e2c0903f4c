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
/// Cosine of the turn from one segment to the next, at least: what is folded back is no way on.
constexpr double kFold = -0.99;

constexpr std::int32_t kAlone = StandingSegment::kAlone;

/// An end of a segment.
struct End {
    Vec2 at, other;  // m, in the world: of the other end of the segment
    double length;
};

struct Meeting {
    double cosine;
    std::int32_t i, j;  // ends
};

bool lies_on(Vec2 p, const End& end, double near) {
    return distance_squared(p, end.at, end.other) <= near * near;
}

std::int32_t other_end(std::int32_t end) {
    return end ^ 1;
}

/// Joins what is near segments that have changed. Ends that meet, and what these meet, and so on, are joined
/// by themselves: all of such a group are, or none.
template <class Real>
class Joiner {
  public:
    explicit Joiner(WorldState<Real>& world) : world_(world), store_(world.edges) {}

    void join() {
        place_changed();
        for (const std::vector<std::int32_t>* const list : {&store_.changed, &store_.touched})
            for (const std::int32_t number : *list)
                if (segment(number).may_join != 0) note(2 * number), note(2 * number + 1);
        for (std::size_t n = 0; n < ends_.size(); ++n) find_meetings(ends_[n]);
        match();
        store_.placed.swap(store_.changed);
        store_.changed.clear(), store_.touched.clear();
        for (const std::int32_t end : ends_) segment(end / 2).marks = 0;
        std::sort(ends_.begin(), ends_.end());
        for (const std::int32_t end : ends_) make_track(end / 2);
        for (const std::int32_t number : made_) segment(number).marks = 0;
    }

  private:
    static constexpr std::uint32_t kIsMade = 4;  // of StandingSegment::marks; 1 and 2: its ends are noted

    StandingSegment& segment(std::int32_t number) {
        return store_.segments[static_cast<std::size_t>(number)];
    }
    EdgeBody& body(std::int32_t number) { return store_.bodies[static_cast<std::size_t>(number)]; }
    std::size_t row_of(std::int32_t number) { return world_.handles.row_of_slot(body(number).id.index); }
    std::int32_t& joined(std::int32_t end) {
        return segment(end / 2).joined[static_cast<std::size_t>(end % 2)];
    }
    std::int32_t edge_of(std::int32_t end) { return end == kAlone ? -1 : body(end / 2).first; }

    End end_of(std::int32_t number) {
        const StandingSegment& of = segment(number / 2);
        const double length = std::sqrt(length_squared(of.b - of.a));
        return number % 2 == 0 ? End{of.a, of.b, length} : End{of.b, of.a, length};
    }

    void place_changed() {
        for (const std::int32_t number : store_.changed) {
            StandingSegment& of = segment(number);
            of = {};
            const EdgeBody& edges = body(number);
            const std::size_t row = row_of(number);
            const EdgeFrame frame = frame_of(world_, edges, row);
            const Rotation turn = rotation_by(frame.angle);
            const auto in_world = [&](Vec2 point) { return frame.position + rotate(turn, point); };
            EdgeBox box{in_world(store_[edges.first].a), in_world(store_[edges.first].a)};
            for (std::int32_t n = 0; n < edges.count; ++n)
                for (const Vec2 point : {store_[edges.first + n].a, store_[edges.first + n].b})
                    box.include(in_world(point));
            const double rounding = 2 * rounding_of<Real>(box.low, box.high);
            box.low = box.low - Vec2{rounding, rounding}, box.high += Vec2{rounding, rounding};
            store_.standing.insert(number, box);
            if (edges.count != 1 || (world_.bodies.flags_of(row) & kSensor) != 0) continue;
            const Edge& edge = store_[edges.first];
            of.a = in_world(edge.a), of.b = in_world(edge.b), of.may_join = 1;
        }
    }

    void note(std::int32_t end) {
        const std::uint32_t mark = end % 2 == 0 ? 1 : 2;
        if ((segment(end / 2).marks & mark) != 0) return;
        segment(end / 2).marks |= mark;
        joined(end) = kAlone;
        ends_.push_back(end);
    }

    void find_meetings(std::int32_t i) {
        const End one = end_of(i);
        const double farthest = kMostOverlap * one.length;
        store_.standing.find(box_around(one.at, farthest), near_);
        for (const std::int32_t number : near_) {
            if (number == i / 2 || segment(number).may_join == 0) continue;
            for (const std::int32_t j : {2 * number, 2 * number + 1}) {
                const StandingSegment& of = segment(number);
                if (length_squared(one.at - (j % 2 == 0 ? of.a : of.b)) <= farthest * farthest)
                    look_at(i, j, one);
            }
        }
    }

    void look_at(std::int32_t i, std::int32_t j, const End& one) {
        const End other = end_of(j);
        const double shorter = std::fmin(one.length, other.length), near = kSamePlace * shorter;
        if (length_squared(one.at - other.at) > kMostOverlap * kMostOverlap * shorter * shorter ||
            !lies_on(one.at, other, near) || !lies_on(other.at, one, near))
            return;
        const double cosine = dot(one.at - one.other, other.other - other.at) / (one.length * other.length);
        if (!(cosine > kFold) || !world_.bodies.are_filtered_alike(row_of(i / 2), row_of(j / 2))) return;
        note(j);
        if (i < j) meetings_.push_back({cosine, i, j});
    }

    /// The straightest first.
    void match() {
        std::sort(meetings_.begin(), meetings_.end(), [](const Meeting& l, const Meeting& r) {
            if (l.cosine != r.cosine) return l.cosine > r.cosine;
            return l.i != r.i ? l.i < r.i : l.j < r.j;
        });
        for (const Meeting& meeting : meetings_)
            if (joined(meeting.i) == kAlone && joined(meeting.j) == kAlone)
                joined(meeting.i) = meeting.j, joined(meeting.j) = meeting.i;
    }

    /// Where a track begins that leads through a segment from its end a to b.
    std::int32_t begin_of(std::int32_t number) {
        const std::int32_t first = 2 * number;
        std::int32_t begin = first;
        while (joined(begin) != kAlone && other_end(joined(begin)) != first) begin = other_end(joined(begin));
        return joined(begin) == kAlone ? begin : first;  // of a loop, anywhere
    }

    /// Makes a track of all segments that are joined with one; it leads through its first body from a to b.
    void make_track(std::int32_t one) {
        if (segment(one).marks == kIsMade) return;
        std::int32_t track = one;
        const auto for_each_from = [&](std::int32_t begin, const auto& fn) {
            std::int32_t in = begin;
            do {
                fn(in);
                in = joined(other_end(in));
            } while (in != kAlone && in != begin);
        };
        for_each_from(begin_of(one), [&](std::int32_t in) {
            track = std::min(track, in / 2);
            segment(in / 2).marks = kIsMade, made_.push_back(in / 2);
        });
        if (joined(2 * one) == kAlone && joined(2 * one + 1) == kAlone) {
            if (body(one).track >= 0) store_.placed.push_back(one);
            return store_.part(one);
        }
        for_each_from(begin_of(track), [&](std::int32_t in) { put_in(track, in); });
    }

    /// @param in  the end where the track comes in
    void put_in(std::int32_t track, std::int32_t in) {
        StandingSegment& of = segment(in / 2);
        EdgeBody& edges = body(in / 2);
        Edge& edge = store_.edges[static_cast<std::size_t>(edges.first)];
        if (edges.track < 0) {
            of.own_a = edge.a, of.own_b = edge.b, of.own_reach = edges.reach;
            edges.reach = std::sqrt(std::fmax(length_squared(of.a), length_squared(of.b)));
            store_.placed.push_back(in / 2);
        }
        edges.track = track;
        edge.a = in % 2 == 0 ? of.a : of.b, edge.b = in % 2 == 0 ? of.b : of.a;
        edge.previous = edge_of(joined(in)), edge.next = edge_of(joined(other_end(in)));
    }

    WorldState<Real>& world_;
    EdgeStore& store_;
    std::vector<std::int32_t> ends_, near_, made_;
    std::vector<Meeting> meetings_;
};

}  // namespace

template <class Real>
bool join_segments(WorldState<Real>& world) {
    world.edges.placed.clear();
    if (!world.edges.has_changes()) return false;
    Joiner<Real>(world).join();
    return true;
}

template bool join_segments(WorldState<float>&);
template bool join_segments(WorldState<double>&);

}  // namespace carom
