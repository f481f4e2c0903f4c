#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/grid/uniform_grid.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Surfaces that are nearer than this share of a sleeper's radius count as touching.
inline constexpr double kTouchingShare = 0.05;

/// Where the bodies that sleep are, in a grid of their own.
template <class Real>
class SleeperGrid {
  public:
    /// To be called when bodies have fallen asleep. Those that wake are left out by `near`.
    void forget() { is_old_ = true; }
    /// Builds the grid anew if it was forgotten. Cost: O(sleepers) then.
    void build(const WorldState<Real>& world, const KernelTable<Real>& kernels, const Executor& executor);
    /// Rows of the sleepers that come within `reach` [m] of a place, kTouchingShare of their radius included,
    /// by the discs around them. Valid until the next call.
    std::span<const std::int32_t> near(const WorldState<Real>& world, Vec2 place, double reach);

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.grid_, self.x_, self.y_, self.reach_, self.ids_, self.low_x_, self.low_y_, self.high_x_,
                self.high_y_, self.is_old_);
    }
    /// To be called after the state was read.
    void use(const KernelTable<Real>& kernels) { grid_.use(kernels); }

  private:
    // The bodies that slept when it was built.
    UniformGrid<Real> grid_;
    Column<Real> x_, y_, reach_;  // m
    std::vector<BodyId> ids_;
    double low_x_ = 0, low_y_ = 0, high_x_ = 0, high_y_ = 0;  // m, around all of them
    bool is_old_ = false;
    // Scratch of `near`.
    Column<std::int32_t> places_;
    std::vector<std::int32_t> near_;
};

extern template class SleeperGrid<float>;
extern template class SleeperGrid<double>;

}  // namespace carom
