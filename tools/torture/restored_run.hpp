#pragma once

#include <memory>

#include "torture/watch.hpp"

namespace carom::torture {

/// A second world that goes on from a state that the watched one saved, on another instruction set, the
/// scalar one: it has to reach the same bits.
class RestoredRun {
  public:
    /// @throws std::runtime_error if it refuses the state
    explicit RestoredRun(const Watch& watch);

    void step(double dt) { simulation_->step(dt); }
    bool agrees_with(const Watch& watch) const;

  private:
    std::unique_ptr<tool::Simulation> simulation_;
};

}  // namespace carom::torture
