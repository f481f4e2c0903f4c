#pragma once

#include "broadphase/edge_candidates.hpp"
#include "isa/kernel_table.hpp"
#include "state/world_state.hpp"

#include <vector>

namespace carom {

/// How far convex shapes are from each other and from edges now, pair by pair, where they touch.
template <class Real>
class ShapeSeparations {
  public:
    explicit ShapeSeparations(const WorldState<Real>& world);

    /// Two rows, not both discs, neither of them edges.
    void add(std::int32_t a, std::int32_t b);
    /// A row and an edge, as an edge of any chain: ends count.
    void add(std::int32_t row, const Edge& edge, const EdgePose& pose);

    /// Calls touch(separation [m], < 0, smaller inradius of the two [m], whether the other one is an edge)
    /// for the pairs that overlap; of two compounds for the two pieces that overlap most, as a share of
    /// that inradius. Cost: about 20 ns a pair of pieces.
    template <class Touch>
    void for_each_touching(const KernelTable<Real>& kernels, const Touch& touch) {
        find(kernels);
        for (std::size_t pair = 0; pair < begin_.size(); ++pair) {
            const std::size_t end = pair + 1 < begin_.size() ? begin_[pair + 1] : a_.size();
            double separation = 0, inradius = 1;
            for (std::size_t item = begin_[pair]; item < end; ++item) {
                const double own = std::fmin(separation1_[item], separation2_[item]);
                const double own_inradius = std::fmin(inradius_of(a_[item]), inradius_of(b_[item]));
                if (own / own_inradius < separation / inradius) separation = own, inradius = own_inradius;
            }
            if (!(separation < 0)) continue;
            touch(separation, inradius, static_cast<std::size_t>(b_[begin_[pair]]) >= first_edge_);
        }
    }

  private:
    /// Calls fn(item) for the pieces of a row, or for itself.
    template <class Fn>
    void for_each_piece(std::int32_t row, const Fn& fn) const;
    void find(const KernelTable<Real>& kernels);
    void add_pose(Vec2 place, Rotation turn);
    double inradius_of(std::int32_t row) const {
        return shapes_[static_cast<std::size_t>(shape_[static_cast<std::size_t>(row)])].inradius;
    }

    const ShapeStore<Real>* store_;
    std::size_t rows_;                       // of bodies
    std::size_t first_edge_;                 // behind them pieces of compounds, then edges
    std::vector<std::int32_t> first_piece_;  // by row; empty without compounds
    std::vector<std::size_t> begin_;         // of each pair among the pairs of pieces below
    Column<std::int32_t> a_, b_, shape_;
    Column<Real> pose_;
    Column<ConvexShape<Real>> shapes_;
    Column<Real> separation1_, separation2_;
};

extern template class ShapeSeparations<float>;
extern template class ShapeSeparations<double>;

}  // namespace carom
