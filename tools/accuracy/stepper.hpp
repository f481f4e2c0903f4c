#pragma once

#include <carom/scene.hpp>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "simulation/simulation.hpp"

namespace carom::accuracy {

/// A run whose result is no answer; the message says why. It is shown, not dropped.
class Failure : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
    double seconds = 0;  ///< of the run until then
};

/// How a case is computed: one point of a chart.
struct Setting {
    Solver solver = Solver::automatic;
    Precision precision = Precision::single_;
    double dt = 0;  ///< s
    int substeps = 1;
    int iterations = 1;    ///< of another engine; solvers of ours have their own number and say 1
    std::string engine{};  ///< another engine, in place of the solver; empty: ours

    friend bool operator==(const Setting&, const Setting&) = default;
};

/// Who computes it: a solver of ours, or another engine.
inline std::string name_of(const Setting& setting) {
    return setting.engine.empty() ? std::string(carom::name_of(setting.solver)) : setting.engine;
}

/// What a run did, in units that do not depend on the machine.
struct Work {
    double body_substeps = 0;  ///< bodies moved, times substeps
    double pair_tests = 0;     ///< pairs looked at
    double impacts = 0;        ///< impulses of single impacts; other engines count none of these
    double total() const { return body_substeps + pair_tests + impacts; }
};

/// Takes a scene through time and counts the time of stepping alone, not of looking at the result.
class Stepper {
  public:
    /// @param longest  s: a run that takes longer is a failure
    /// @param counts   whether another engine shall count its contacts; our solvers always do
    /// @throws carom::Error if the solver refuses the scene
    Stepper(const Scene& scene, const Setting& setting, double longest, bool counts = false);

    /// Whole steps up to `time` [s]. @throws Failure if a body's state is not finite or was taken out, or if
    /// it takes too long
    void advance_to(double time);

    const tool::Simulation& simulation() const { return *simulation_; }
    BodyState state(std::size_t body) const { return simulation_->state(body); }
    /// Of the bodies' states, by one formula for all engines [J].
    double kinetic_energy() const;
    double energy() const;  ///< J, with that in gravity, 0 at the origin
    const Setting& setting() const { return setting_; }
    double seconds() const { return seconds_; }  ///< of this thread's processor, in steps
    Work work() const;

  private:
    void check() const;

    Scene scene_;
    Setting setting_;
    double longest_;
    std::unique_ptr<tool::Simulation> simulation_;
    std::int64_t steps_ = 0;
    double seconds_ = 0;
    double pair_tests_ = 0;
};

}  // namespace carom::accuracy
