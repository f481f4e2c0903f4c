#pragma once

#include <carom/scene.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/vec2_math.hpp"
#include "shapes/edge_index.hpp"

// The edges of segments and chains: usually few beside the discs, so they have no columns. A long chain has a
// tree of boxes, so that what looks for edges near a place pays for those alone.

namespace carom {

/// A line between two points, in the frame of its body.
struct Edge {
    Vec2 a, b;                   // m
    std::int32_t body = 0;       // number in EdgeStore::bodies
    std::int32_t previous = -1;  // edge that ends where this begins; -1: none
    std::int32_t next = -1;      // edge that begins where this ends; -1: none
};

/// A body that consists of edges [first, first + count). A number that no body has, until one takes it, has
/// none.
struct EdgeBody {
    BodyId id;
    std::int32_t first = 0, count = 0;
    double reach = 0;                           // m, of the point that is farthest from the body's position
    std::int32_t first_box = 0, box_count = 0;  // in EdgeStore::boxes
    std::int32_t track = -1;  // of a segment that is joined with others (edge_tracks.hpp): the first of their
                              // bodies; then its edge is in the frame of the world
};

/// Ends of two segments may meet where they lie no farther from each other than this share of the shorter
/// one: segments that overlap along a line.
inline constexpr double kMostOverlap = 0.01;

/// What joining knows of a body that is a segment and stands; apart, since steps do not ask for it. Its ends
/// have numbers: twice that of the body, and one more for b.
struct StandingSegment {
    Vec2 a, b;                                           // m, in the world
    Vec2 own_a, own_b;                                   // m, of one in a track, in the frame of its body
    double own_reach = 0;                                // m, likewise
    std::array<std::int32_t, 2> joined{kAlone, kAlone};  // the end that each end is joined with
    std::uint32_t may_join = 0;                          // 1: it may
    std::uint32_t marks = 0;  // what has been listed, while segments are being joined

    static constexpr std::int32_t kAlone = -1;
};

/// Every edge of a world.
struct EdgeStore {
    std::vector<EdgeBody> bodies;
    std::vector<Edge> edges;
    std::vector<EdgeBox> boxes;        // of each body with many edges: level by level, the finest first
    std::vector<std::int32_t> movers;  // numbers of bodies that are not static, ascending
    EdgeIndex standing;                // the others, in the world, by number; but for `changed`. Their boxes
                                       // have room for what places are rounded by
    std::vector<StandingSegment> segments;  // by number
    // Numbers of bodies that came or are elsewhere since segments were joined, and of those near where one
    // was.
    std::vector<std::int32_t> changed, touched;
    std::vector<std::int32_t> placed;  // whose frames may have become others when segments were joined last

    bool empty() const { return bodies.size() == free_.size() + free_with_edge_.size(); }
    const Edge& operator[](std::int32_t edge) const { return edges[static_cast<std::size_t>(edge)]; }
    const EdgeBody& body_of(std::int32_t edge) const {
        return bodies[static_cast<std::size_t>((*this)[edge].body)];
    }

    /// The first body of the track that an edge is in; its own body if it is in none.
    std::int32_t track_of(std::int32_t edge) const {
        const std::int32_t track = body_of(edge).track;
        return track >= 0 ? track : (*this)[edge].body;
    }
    /// To be called before a body is put elsewhere, or other filters hold for it: it is joined with no
    /// segment until they are joined anew. Cost: O(what is near).
    void note_change(BodyId id);
    /// Takes a segment out of its track, if it is in one. The others stay in the frame of the world.
    void part(std::int32_t number);
    /// Whether segments are to be joined anew.
    bool has_changes() const { return !changed.empty() || !touched.empty(); }

    /// Nothing if the shape is none of edges. @param moves  whether the body is not static
    void append(BodyId id, const Shape& shape, bool moves = false);
    /// The segment or chain of a body that has edges. Cost: O(its edges).
    Shape shape_of(BodyId id) const;

    /// Calls fn(edge) for all edges of a body within `reach` [m] of a place in its frame, and for some
    /// others, in their order. Cost: O(log edges + what is found).
    template <class Fn>
    void for_each_near(const EdgeBody& body, Vec2 place, double reach, const Fn& fn) const {
        Levels levels{};
        const std::size_t count = levels_of(body, levels);
        if (count > 0)
            return visit_boxes(body, levels, count - 1, 0, levels[count - 1].count, {place, reach}, fn);
        for (std::int32_t n = 0; n < body.count; ++n) fn(body.first + n);
    }

    /// Calls fn(number) for all bodies that move and those that stand and have a box within `reach` [m] of a
    /// place in the world, in their order. Cost: O(bodies that move + what is found).
    /// @param near  scratch
    template <class Fn>
    void for_each_body_near(Vec2 place, double reach, std::vector<std::int32_t>& near, const Fn& fn) const {
        standing.find(box_around(place, reach), near);
        auto mover = movers.begin();
        for (const std::int32_t number : near) {
            for (; mover != movers.end() && *mover < number; ++mover) fn(*mover);
            fn(number);
        }
        for (; mover != movers.end(); ++mover) fn(*mover);
    }

    struct Removed {
        std::int32_t first = 0, count = 0;
        std::int32_t moved_up = 0;  // by how much later ones did
    };
    /// Takes the edges of a body out. Those of a segment are left to the next one that comes; after those of
    /// a chain, later ones move up. Cost: O(what is near), of a chain O(edges).
    /// @return which they were; none if the body has no edges.
    Removed remove(BodyId id);

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.bodies, self.edges, self.boxes, self.movers, self.standing, self.segments);
        archive(self.changed, self.touched, self.numbers_, self.free_, self.free_with_edge_);
    }

    std::size_t bytes() const;

  private:
    static constexpr std::int32_t kInABox = 8;  // edges, or boxes of the level below
    struct Level {
        std::int32_t first, count;  // boxes
    };
    using Levels = std::array<Level, 11>;  // 8 to that power is more than 32-bit numbers can count
    struct Circle {
        Vec2 place;
        double reach;
    };

    /// The levels of a body's boxes. @return how many there are: none where it has few edges.
    static std::size_t levels_of(const EdgeBody& body, Levels& levels) {
        std::size_t count = 0;
        std::int32_t first = body.first_box, below = body.count;
        while (below > kInABox) {
            below = (below + kInABox - 1) / kInABox;
            levels[count++] = {first, below};
            first += below;
        }
        return count;
    }
    void append_boxes(EdgeBody& body);
    std::int32_t number_of(BodyId id) const;
    std::int32_t take_number(BodyId id, bool is_segment);
    void touch_around(std::int32_t number);

    /// Looks into boxes [begin, end) of a level.
    template <class Fn>
    void visit_boxes(const EdgeBody& body, const Levels& levels, std::size_t level, std::int32_t begin,
                     std::int32_t end, const Circle& circle, const Fn& fn) const {
        constexpr double kRoundingUp = 1 + 1e-12;
        const double near = kRoundingUp * circle.reach * circle.reach;
        for (std::int32_t i = begin; i < end; ++i) {
            const EdgeBox& box = boxes[static_cast<std::size_t>(levels[level].first + i)];
            if (box.distance_squared(circle.place) > near) continue;
            const std::int32_t from = kInABox * i,
                               to =
                                   std::min(from + kInABox, level > 0 ? levels[level - 1].count : body.count);
            if (level > 0) {
                visit_boxes(body, levels, level - 1, from, to, circle, fn);
                continue;
            }
            for (std::int32_t n = from; n < to; ++n) fn(body.first + n);
        }
    }

    std::vector<std::int32_t> numbers_;  // by index of the body's handle; below zero: it has no edges
    // Numbers that no body has, and of these, which have kept the edge of a segment.
    std::vector<std::int32_t> free_, free_with_edge_;
};

}  // namespace carom
