#pragma once

#include <carom/scene.hpp>

#include <cstdint>
#include <vector>

#include "math/vec2_math.hpp"

// The edges of segments and chains: few beside the discs, so they have no columns.

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
    double reach = 0;  // m, of the point that is farthest from the body's position
};

/// Every edge of a world.
struct EdgeStore {
    std::vector<EdgeBody> bodies;
    std::vector<Edge> edges;

    bool empty() const { return bodies.empty(); }
    const Edge& operator[](std::int32_t edge) const { return edges[static_cast<std::size_t>(edge)]; }
    const EdgeBody& body_of(std::int32_t edge) const {
        return bodies[static_cast<std::size_t>((*this)[edge].body)];
    }

    /// Nothing if the shape is none of edges.
    void append(BodyId id, const Shape& shape);
    /// The segment or chain of a body that has edges. Cost: O(bodies with edges + its edges).
    Shape shape_of(BodyId id) const;

    struct Removed {
        std::int32_t first = 0, count = 0;
    };
    /// Takes the edges of a body out; later ones move up. Cost: O(edges).
    /// @return which they were; none if the body has no edges.
    Removed remove(BodyId id);

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.bodies, self.edges);
    }

    std::size_t bytes() const {
        return bodies.capacity() * sizeof(EdgeBody) + edges.capacity() * sizeof(Edge);
    }
};

}  // namespace carom
