#pragma once

#include <memory>

#include "torture/hard/hard_run.hpp"
#include "torture/watch.hpp"

namespace carom::torture {

/// A hard case's world in a process of `carom torture`: its steps are timed, and end with the limit.
class WatchedRun final : public HardRun {
  public:
    /// @param limit  s of processor time, of all steps together
    /// @throws carom::Error if the solver refuses the scene
    WatchedRun(const Scene& scene, Solver solver, Precision precision, double limit)
        : watch_(scene, solver, precision, limit), limit_(limit) {}

    bool step(double dt) override { return watch_.step(dt); }
    const Scene& scene() const override { return watch_.scene(); }
    BodyState state(std::size_t body) const override { return watch_.state(body); }
    double energy() const override { return watch_.simulation().ledger().energy.total(); }
    double unexplained() const override {
        return watch_.simulation().keeps_ledger() ? watch_.simulation().ledger().energy_by_cause.unexplained
                                                  : 0;
    }
    double driven() const override {
        return watch_.simulation().keeps_ledger() ? watch_.simulation().ledger().energy_by_cause.drive : 0;
    }
    double overlap() const override { return watch_.simulation().overlaps().max; }
    double joint_gap() const override { return watch_.simulation().joint_errors().max; }
    std::size_t quarantined() const override { return watch_.quarantined(); }
    std::size_t asleep() const override {
        return static_cast<std::size_t>(watch_.simulation().profile().asleep);
    }
    void set_velocity(std::size_t body, Vec2 velocity) override { watch_.set_velocity(body, velocity); }
    std::unique_ptr<HardRun> another(const Scene& scene) const override {
        return std::make_unique<WatchedRun>(scene, watch_.scene().accuracy.solver,
                                            watch_.scene().accuracy.precision, limit_);
    }

    const Watch& watch() const { return watch_; }

  private:
    Watch watch_;
    double limit_;
};

}  // namespace carom::torture
