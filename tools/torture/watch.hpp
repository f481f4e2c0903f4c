#pragma once

#include <carom/scene.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "simulation/simulation.hpp"
#include "torture/enclosure.hpp"
#include "torture/options.hpp"
#include "torture/outcome.hpp"

namespace carom::torture {

/// A world on one thread, whose steps are timed one by one. Looking at it is not in the times.
class Watch {
  public:
    /// @param limit  s of processor time of all steps together, after which `step` gives up
    /// @throws carom::Error if the solver refuses the scene
    Watch(const Scene& scene, Solver solver, Precision precision, double limit);

    /// One step of the scene's length. @return false, without a step, once the limit is exceeded
    bool step() { return step(scene_.step.dt); }
    bool step(double dt);
    /// Steps up to a time of the world [s]. @return false once the limit is exceeded
    bool advance_to(double time);
    void set_velocity(std::size_t body, Vec2 velocity) { simulation_->set_velocity(body, velocity); }

    const Scene& scene() const { return scene_; }  ///< with the solver and precision that run
    const tool::Simulation& simulation() const { return *simulation_; }
    BodyState state(std::size_t body) const { return simulation_->state(body); }
    std::int64_t steps() const { return static_cast<std::int64_t>(seconds_.size()); }
    double median_step() const;   ///< s
    double longest_step() const;  ///< s
    /// Longest step over the median of those in which all bodies were awake. That counts as 0.2 ms at least:
    /// a step of a few milliseconds may be the machine.
    double stall() const;
    /// Keeps of each step the shorter of its time here and its time in another run of the same steps [s].
    void take_shorter_times(const Watch& again);
    bool gave_up() const { return spent_ > limit_; }
    /// Empty, or why there are no more steps.
    std::string failure() const;

    double kinetic_energy() const;  ///< J, spin included, of dynamic bodies
    double rms_speed() const;       ///< m/s, of dynamic bodies
    double mean_height() const;     ///< m, of dynamic bodies
    std::size_t quarantined() const { return simulation_->quarantined().size(); }
    std::size_t not_finite() const;  ///< bodies
    /// Dynamic bodies, sensors left out, whose centre is not inside. @param pose  of the enclosure
    std::size_t outside(const Enclosure& enclosure, const BodyState& pose = {}) const;

  private:
    Scene scene_;
    double limit_;
    std::unique_ptr<tool::Simulation> simulation_;
    std::vector<BodyMass> masses_;        // [bodies]
    std::vector<double> seconds_;         // of each step
    std::vector<std::uint8_t> is_awake_;  // whether no body slept in a step
    double spent_ = 0;
};

/// What may give a world energy, by the ledger; nothing does in a passive one.
struct EnergySources {
    bool drives = false;    ///< kinematic bodies
    bool joints = false;    ///< motors, targets, springs, joints that are stretched at the start
    bool overlaps = false;  ///< displacement of what overlaps at the start, or is pressed together
    bool falls = false;     ///< gravity: there is no lowest place
};

/// Follows the energy of a world. Potential energy is 0 where each body is as low as it can be, so that the
/// start's total is what a passive world can ever have in motion.
class EnergyBooks {
  public:
    /// @param lowest  m, of each body's centre, [bodies]
    /// @param least   J: rises are shares of this at least
    EnergyBooks(const Watch& watch, const Scene& scene, std::vector<double> lowest,
                const EnergySources& sources = {}, double least = 0);

    /// After every step.
    void look(const Watch& watch);

    double start() const { return start_; }  ///< J
    /// Largest (E - E0 - given) / (E0 + turnover) so far: what sources gave, and the most they ever had given
    /// or taken.
    double rise() const { return rise_; }
    /// Steps in which restitution gave energy, the sum of what they gave over E0; 0 without a ledger.
    double restitution_gain() const { return restitution_gain_; }
    /// The most that displacement had lifted bodies by, over E0; 0 without a ledger.
    double correction_gain() const { return correction_gain_; }
    /// The world's own check of each step, over E0; zeros without a ledger.
    EnergyExcess excess() const {
        return {excess_.restitution / start_, excess_.correction / start_, excess_.passive / start_};
    }

  private:
    double energy(const Watch& watch) const;
    double given(const EnergyByCause& cause);

    std::vector<double> weight_, lowest_;  // N and m, [bodies]
    EnergySources sources_;
    double least_ = 0, turnover_ = 0;  // J
    double start_ = 0, rise_ = -1, restitution_gain_ = 0, correction_gain_ = 0;
    double last_restitution_ = 0;  // J
    EnergyExcess excess_;          // J
};

/// What a step took: median, longest, and one over the other. None has a mark: times are told.
void tell_times(Outcome& outcome, const Watch& watch);

/// From here on a step of a Watch that goes on for longer than its limit ends this process by SIGPROF: a step
/// cannot be asked to end.
/// @param step  where the number of the step is kept, for the process that waits for this one
void watch_over_steps(std::int64_t* step);

}  // namespace carom::torture
