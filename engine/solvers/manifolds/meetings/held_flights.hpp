#pragma once

#include <cstdint>
#include <vector>

#include "broadphase/edge_candidates.hpp"
#include "math/vec2_math.hpp"
#include "solvers/manifolds/list/manifold_list.hpp"
#include "solvers/manifolds/poses/piece_items.hpp"
#include "solvers/manifolds/poses/pose_watch.hpp"
#include "state/world_state.hpp"

namespace carom {

/// How bodies fly in a step: with their velocities, but no farther into static bodies and edges than up to
/// them. Walls have nothing behind them that could be met.
///
/// What a program sets presses too: a player that walks into a wall, or down onto the floor, has a velocity
/// into it in every step. The wall takes that at once. A look at what a body meets in the step that took it
/// to fly on through the wall would find the side of the next brick in its way, behind the face of this one.
/// docs/decisions/0065-corners-that-pass.md.
template <class Real>
class HeldFlights {
  public:
    void clear() { faces_.clear(), held_.clear(); }
    /// Whether a body comes into a plane in a step by so much that it could meet another behind it.
    /// @param normal     from the body towards the plane  @param gap  m, to it; below zero counts as none
    /// @param thickness  m, of the contact  @param dt  s
    static bool comes_into(Vec2 velocity, Vec2 normal, double gap, double thickness, double dt);
    /// A plane that stands still holds a body. @param gap  as comes_into
    void hold(std::size_t row, Vec2 normal, double gap) {
        faces_.push_back({static_cast<std::int32_t>(row), normal, gap});
    }
    /// Faces that bodies pressed on in the step before, and surfaces that they touched, hold them.
    void hold_what_pressed(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                           const PieceItems<Real>& items, const PoseWatch<Real>& poses, double dt,
                           const ManifoldList<Real>& pairs, const ManifoldList<Real>& surfaces);
    /// Finds the velocities of bodies that are held. To be called when all planes are known.
    void settle(const Bodies<Real>& bodies, double dt);

    /// Whether some body is held.
    bool hold_any() const { return !held_.empty(); }
    /// m/s
    Vec2 velocity(const Bodies<Real>& bodies, std::size_t row) const;
    /// Calls fn(row, velocity [m/s]) for each body that is held.
    template <class Fn>
    void for_each(const Fn& fn) const {
        for (const Held& held : held_) fn(static_cast<std::size_t>(held.row), held.velocity);
    }
    std::size_t bytes() const { return held_.capacity() * sizeof(Held) + faces_.capacity() * sizeof(Face); }

  private:
    struct Held {
        std::int32_t row;
        Vec2 velocity;  // m/s
    };
    struct Face {
        std::int32_t row;
        Vec2 normal;  // from the body towards it
        double gap;   // m
    };

    std::vector<Face> faces_;
    std::vector<Held> held_;  // by row
};

extern template class HeldFlights<float>;
extern template class HeldFlights<double>;

}  // namespace carom
