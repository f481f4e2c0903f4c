#pragma once

#include <carom/events.hpp>
#include <carom/ledger.hpp>
#include <carom/profile.hpp>
#include <carom/scene.hpp>
#include <carom/world.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace carom::tool {

/// Where a simulation writes one frame: arrays of its own precision in body order, aligned for it. Angles are
/// zero before; a simulation without rotation leaves them so.
struct FrameTarget {
    std::byte* position;  // m, [bodies, 2]
    std::byte* velocity;  // m/s, [bodies, 2]
    std::byte* angle;     // rad, [bodies]
};

/// What `carom run` and `carom explain` need of whatever computes the scene: a World, a World64 or the
/// naive pairwise engine. Bodies are counted as in the scene.
class Simulation {
  public:
    virtual ~Simulation() = default;

    /// @throws carom::Error (interrupted, given_up) if it ended early; the state is that of time()
    virtual void step(double dt) = 0;

    /// @throws carom::Error (not_built_yet) but for worlds
    virtual void set_velocity(std::size_t body, Vec2 velocity);

    virtual std::size_t body_count() const = 0;
    virtual Precision precision() const = 0;
    virtual double time() const = 0;  ///< s
    virtual BodyState state(std::size_t body) const = 0;
    virtual void copy_frame(const FrameTarget& frame) const = 0;

    virtual bool keeps_ledger() const = 0;  ///< whether `ledger()` knows causes
    virtual Ledger ledger() const = 0;
    virtual Profile profile() const = 0;
    virtual Plan plan() const = 0;
    virtual OverlapReport overlaps() const = 0;
    /// The events of the last step.
    virtual Events events() const { return {}; }
    virtual JointErrors joint_errors() const { return {}; }
    /// N, of a joint of the scene on its body b, the mean of the last step; not a number if it is not known.
    virtual Vec2 joint_force(std::size_t) const {
        constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
        return {kUnknown, kUnknown};
    }
    virtual std::vector<std::size_t> quarantined() const = 0;
    virtual std::uint64_t state_hash() const = 0;
    /// All that steps depend on. @throws carom::Error (not_built_yet) but for worlds
    virtual std::vector<std::byte> saved_state() const;
    /// Goes on from what another simulation of the same precision saved.
    /// @throws carom::Error (malformed, inconsistent) if it is nothing that this one could go on from;
    /// (not_built_yet) but for worlds
    virtual void restore_state(std::span<const std::byte> state);
};

/// What a scene does not say: how the machine is used.
struct MachineSettings {
    std::string isa = "auto";
    int threads = 0;  // 0: as many as there are
    ShouldStop should_stop{};
    ParallelFor parallel_for{};  // in place of OpenMP's threads; worlds alone have such loops
};

/// Makes the simulation the scene asks for.
/// @throws carom::Error if the scene, or what it asks of its solver, cannot be.
std::unique_ptr<Simulation> make_simulation(const Scene& scene, const MachineSettings& machine);

std::unique_ptr<Simulation> make_world_simulation(const Scene& scene, const MachineSettings& machine);
std::unique_ptr<Simulation> make_pairwise_simulation(const Scene& scene, const MachineSettings& machine);

}  // namespace carom::tool
