#pragma once

#include <cstdint>
#include <vector>

#include "math/vec2_math.hpp"

namespace carom {

/// Bodies that are in each other at the end of a step, and how they are pushed apart: by displacement alone,
/// each by its share of the inverse masses, one pair after the other, until all are where they may be.
///
/// docs/decisions/0018-crowds.md says when the sweeps of a step leave that to do.
class PositionProjection {
  public:
    struct Pair {
        std::int32_t a, b;        // rows, b < 0: nothing moves it
        Vec2 place;               // m, of b where b < 0
        double reach;             // m, sum of the radii
        double least;             // m, separation that is to be reached, below zero
        double share_a, share_b;  // of a push; they add up to one
    };
    /// A wall or an edge that keeps a body on one side: flat, and it does not give way.
    struct Plane {
        std::int32_t a;
        Vec2 normal;         // into it
        double end, radius;  // m, normal · x of the surface; of the body
    };

    std::vector<Vec2> place;              ///< m, of each row
    std::vector<std::uint8_t> is_marked;  ///< of each row: its neighbours are looked at
    std::vector<std::uint8_t> is_moved;   ///< of each row: pushed by `part`
    std::vector<Pair> pairs;
    std::vector<Plane> planes;

    /// Pushes until no pair lacks more than a tenth of what it may overlap, or as often as is of use.
    /// @return whether any body was pushed.
    /// Cost: O(pairs + planes) a sweep.
    bool part();
    /// Pushes bodies out of the planes. @return whether any was deep in one.
    bool push_from_planes();

    std::size_t bytes() const {
        return place.capacity() * sizeof(Vec2) + is_marked.capacity() + is_moved.capacity() +
               pairs.capacity() * sizeof(Pair) + planes.capacity() * sizeof(Plane);
    }

  private:
    bool push_pair(const Pair& pair);
    bool push_from_plane(const Plane& plane);
};

}  // namespace carom
