#pragma once

#include <carom/scene.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/vec2_math.hpp"

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

/// A body that consists of edges [first, first + count).
struct EdgeBody {
    BodyId id;
    std::int32_t first = 0, count = 0;
    double reach = 0;                           // m, of the point that is farthest from the body's position
    std::int32_t first_box = 0, box_count = 0;  // in EdgeStore::boxes
    std::int32_t track = -1;  // of a segment that is joined with others (edge_tracks.hpp): the first of their
                              // bodies; then its edge is in the frame of the world
    Vec2 own_a{}, own_b{};    // m, of such a segment, in the frame of its body
    double own_reach = 0;     // m, likewise
};

/// A box, in the frame of a body, around edges that follow each other, or around such boxes.
struct EdgeBox {
    Vec2 low, high;  // m

    double distance_squared(Vec2 p) const {
        const double x = std::max({low.x - p.x, p.x - high.x, 0.0}),
                     y = std::max({low.y - p.y, p.y - high.y, 0.0});
        return x * x + y * y;
    }
};

/// Every edge of a world.
struct EdgeStore {
    std::vector<EdgeBody> bodies;
    std::vector<Edge> edges;
    std::vector<EdgeBox> boxes;  // of each body with many edges: level by level, the finest first
    bool is_joined = false;      // segments that lie end to end

    bool empty() const { return bodies.empty(); }
    const Edge& operator[](std::int32_t edge) const { return edges[static_cast<std::size_t>(edge)]; }
    const EdgeBody& body_of(std::int32_t edge) const {
        return bodies[static_cast<std::size_t>((*this)[edge].body)];
    }

    /// The first body of the track that an edge is in; its own body if it is in none.
    std::int32_t track_of(std::int32_t edge) const {
        const std::int32_t track = body_of(edge).track;
        return track >= 0 ? track : (*this)[edge].body;
    }
    /// To be called before segments are put elsewhere: each is alone, until they are joined anew.
    /// Cost: O(bodies with edges) if they were joined.
    void part();

    /// Nothing if the shape is none of edges.
    void append(BodyId id, const Shape& shape);
    /// The segment or chain of a body that has edges. Cost: O(bodies with edges + its edges).
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

    struct Removed {
        std::int32_t first = 0, count = 0;
    };
    /// Takes the edges of a body out; later ones move up. Cost: O(edges).
    /// @return which they were; none if the body has no edges.
    Removed remove(BodyId id);

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.bodies, self.edges, self.boxes, self.is_joined);
    }

    std::size_t bytes() const {
        return bodies.capacity() * sizeof(EdgeBody) + edges.capacity() * sizeof(Edge) +
               boxes.capacity() * sizeof(EdgeBox);
    }

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
};

}  // namespace carom
