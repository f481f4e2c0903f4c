#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "parallel/executor.hpp"
#include "solvers/manifolds/contact_distance.hpp"
#include "solvers/manifolds/pose_watch.hpp"
#include "state/chunked_list.hpp"
#include "state/shape_frames.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Candidate pairs of convex shapes that cannot touch in a step. The broadphase sees the disc around a shape:
/// of planks most candidate pairs are planks that lie side by side. How far two shapes are apart is at least
/// the gap between the rectangles around them, so a pair is not looked at again before the ways of its two
/// bodies are together as long as that gap.
///
/// Cost: 2 ns a pair and step; 15 ns a pair that is looked at. docs/decisions/0036-distant-pairs.md.
template <class Real>
class DistantPairs {
  public:
    struct Pair {
        std::int32_t a, b;  ///< rows
        Real thickness;     ///< m, that contacts between them are measured in
        Real until;         ///< m, of the ways of both, before which the pair is not looked at
    };

    bool empty() const { return pairs_.empty(); }
    void clear() { pairs_.clear(); }
    /// Adds a pair that is to be looked at in the next step.
    void add(const WorldState<Real>& world, std::int32_t a, std::int32_t b);
    /// Takes out the pairs that may touch in this step, in the order of their coming.
    /// @param poses  of the start of the step
    std::span<const Pair> take_near(const WorldState<Real>& world, const PoseWatch<Real>& poses,
                                    const ContactDistance& near, const Executor& executor);

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.pairs_);
        if constexpr (!std::is_const_v<Self>) self.frames_.forget();
    }

  private:
    using Frame = ShapeFrame<Real>;
    static Real gap(const Frame& a, const Real* pose_a, const Frame& b, const Real* pose_b);

    std::vector<Pair> pairs_, taken_;
    ShapeFrames<Real> frames_;
    ChunkedList near_;
};

extern template class DistantPairs<float>;
extern template class DistantPairs<double>;

}  // namespace carom
