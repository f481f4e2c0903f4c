#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "parallel/executor.hpp"
#include "solvers/manifolds/poses/contact_distance.hpp"
#include "solvers/manifolds/poses/pose_watch.hpp"
#include "state/columns/chunked_list.hpp"
#include "state/shape_frames.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Candidate pairs of convex shapes that cannot touch in a step. The broadphase sees the disc around a shape:
/// of planks most candidate pairs are planks that lie side by side. How far two shapes are apart is at least
/// the gap between the rectangles around them, so a pair is not looked at again before the ways of its two
/// bodies are together as long as that gap; nor, where that is asked, does one count that cannot close in the
/// step along a side.
///
/// Cost: 1 ns a pair and step; 3 ns a pair that is looked at. docs/decisions/0036-distant-pairs.md.
template <class Real>
class DistantPairs {
  public:
    struct Pair {
        std::int32_t a, b;  ///< rows
    };

    bool empty() const { return a_.empty(); }
    void clear();
    /// Pairs go with their bodies when rows change, those of bodies that are gone are dropped.
    /// @param row_now  row_now(former row), negative where its body is gone
    template <class RowNow>
    void follow_rows(const RowNow& row_now) {
        assert(thickness_.size() == count());  // pairs are looked at in the step that adds them
        for (std::size_t n = 0; n < count(); ++n) {
            a_[n] = row_now(a_[n]), b_[n] = row_now(b_[n]);
            if (a_[n] < 0 || b_[n] < 0) thickness_[n] = kTaken;
        }
        close_gaps();
        frame_.clear();
    }
    /// Adds a pair that is to be looked at in the next step.
    void add(std::int32_t a, std::int32_t b) { a_.push_back(a), b_.push_back(b); }
    /// Takes out the pairs that may touch in this step, in the order of their coming.
    /// @param dt  s, of the step
    /// @param sides_part  whether pairs wait, too, that have come near but cannot close along a side
    /// @param poses  of the start of the step
    std::span<const Pair> take_near(const WorldState<Real>& world, double dt, bool sides_part,
                                    const PoseWatch<Real>& poses, const ContactDistance& near,
                                    const ConvexKernels<Real>& kernels, const Executor& executor);

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.a_, self.b_, self.thickness_, self.until_, self.gaps_, self.within_);
        if constexpr (!std::is_const_v<Self>) self.frames_.forget(), self.frame_.clear();
    }

  private:
    static constexpr int kTaken = -1;  // thickness of a pair that was taken out

    std::size_t count() const { return a_.size(); }
    void describe_new_pairs(const WorldState<Real>& world, const Executor& executor);
    void describe_rows(const WorldState<Real>& world, double dt, const PoseWatch<Real>& poses,
                       const Executor& executor);
    void close_gaps();

    Column<std::int32_t> a_, b_;  // rows
    Column<Real> thickness_;      // m, that contacts between them are measured in
    Column<Real> until_;          // m, of what both have come and may come, before which no pair is looked at
    std::size_t gaps_ = 0;        // among them, of pairs that were taken out
    Column<Real> come_, way_;     // m, by row: since pairs were listed, this step included; in this step
    Column<Real> motion_;         // kernels/manifolds/manifold_arguments.hpp
    Column<ShapeFrame<Real>> frame_;  // by row; none: to be made
    std::array<double, 2> within_{};  // ContactDistance of the last step
    std::vector<Pair> taken_;
    ShapeFrames<Real> frames_;
    ChunkedList near_;
};

extern template class DistantPairs<float>;
extern template class DistantPairs<double>;

}  // namespace carom
