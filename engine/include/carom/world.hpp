#pragma once

#include <carom/events.hpp>
#include <carom/ledger.hpp>
#include <carom/profile.hpp>
#include <carom/scene.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace carom {

/// Runs task(0) ... task(count - 1), in any order and on any threads, and returns when all are done. It may
/// throw once no thread is in a task any more: the world then carries out what is left, and all else of the
/// call, on the caller's thread, with the same bits, and throws that exception at the end. The step has been
/// taken then; the next one asks again. `World::step` and `World::overlaps` throw; after any other call the
/// next of these does.
using ParallelFor = std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

/// Asked within a step, on the thread that called it, after every millisecond or so of work: true ends the
/// step. Short steps do not ask. How often depends on the work alone, not on time, threads or instruction
/// sets. What it throws ends the step, too, and comes out of `World::step`.
using ShouldStop = std::function<bool()>;

/// How a world runs; what is left out comes from the scene, then from the defaults.
struct WorldOptions {
    std::optional<Solver> solver{};
    std::optional<int> substeps{};
    std::optional<int> iterations{};
    std::string isa =
        "auto";       ///< "auto" (or CAROM_ISA from the environment), "scalar", "sse2", "avx2", "avx512"
    int threads = 0;  ///< 0: as many as OpenMP gives; results do not depend on it
    ParallelFor parallel_for{};  ///< an embedding program's own threads in place of OpenMP
    ShouldStop should_stop{};    ///< ends a step that is too long; copies of the world ask it, too
    EffectOverrides effects{};   ///< over the scene's own
    /// Events stay until `clear_events`; else those of a step until the next one.
    bool keep_events = false;
};

/// Spans over the columns, without a copy; valid until the next call that changes the world. Rows may be
/// reordered by a step: keep handles, not rows. A column that no effect needs is empty.
template <class Real>
struct BodyView {
    std::size_t count = 0;
    std::span<const Real> position_x, position_y;  ///< m, [count]
    std::span<const Real> velocity_x, velocity_y;  ///< m/s, [count]
    std::span<const Real> angle;                   ///< rad, [count] or empty
    std::span<const Real> angular_velocity;        ///< rad/s, [count] or empty
    std::span<const BodyId> id;                    ///< handle of each row, [count]
};

/// One body's state, converted to double.
struct BodyState {
    Vec2 position;
    double angle = 0;
    Vec2 velocity;
    double angular_velocity = 0;
};

/// How deep bodies and walls overlap now, measured from positions: over all pairs but those of two bodies
/// that never move; sleeping bodies take part, quarantined ones do not. Overlaps are fractions of the smaller
/// body's radius over touching pairs (separation < 0); the radius of a box, capsule or polygon is here its
/// inradius: of a box half of its shorter side.
struct OverlapReport {
    /// Pairs nearer than a tenth of the smallest radius, and walls that are touched; what is no disc counts
    /// there as the disc around it.
    std::int64_t candidates = 0;
    std::int64_t touching = 0;
    double mean = 0;
    double max = 0;
};

/// All state of a simulation, stepped forward. `Real` is the precision of columns and kernels.
///
/// The same scene and calls give the same bits for any number of threads and every instruction set.
template <class Real>
class BasicWorld {
  public:
    /// Validates the scene and makes columns of it. Cost: O(bodies log bodies).
    /// @throws Error as `Scene::validate`, or for options out of range or an instruction set that is missing.
    explicit BasicWorld(const Scene& scene, const WorldOptions& options = {});
    ~BasicWorld();
    /// A world that goes on as the other one does, bit for bit. Cost: that of a save and a restore.
    BasicWorld(const BasicWorld& other);
    BasicWorld& operator=(const BasicWorld& other);
    BasicWorld(BasicWorld&&) noexcept;
    BasicWorld& operator=(BasicWorld&&) noexcept;

    /// Advances the world by dt.
    /// @param dt  s: 0, which changes no bit of any body, or kSmallestStep ... kLargestStep.
    /// @throws Error if dt is out of range; the world is then unchanged. Error (interrupted) if
    /// `WorldOptions::should_stop` said so, or Error (given_up) if solver `event` finds more impacts than a
    /// step may have; the message names the bodies. The step then ends early: the world is as it was at
    /// `time()`, whole, and can go on. Under `event` that is the time of the impact that was next, under
    /// `impulse` the start of the present substep, under `soft` of the step, or of the part of it that bodies
    /// were in where they come so far that it is taken in parts. (Under these two bodies may have woken, and
    /// forces of contacts at rest are found anew.) What `parallel_for` throws; the step has been taken then.
    /// Cost: O(bodies + candidate pairs); no allocation once the world has reached its largest size and its
    /// busiest step.
    void step(double dt);

    std::size_t body_count() const noexcept;
    BodyView<Real> bodies() const noexcept;

    /// The row a body has now. @throws Error (stale_handle)
    std::uint32_t row(BodyId body) const;
    /// @throws Error (stale_handle)
    BodyState state(BodyId body) const;

    /// The geometry of a body in its own frame: the centre of mass at the origin, the angle zero. A polygon
    /// comes recentred, a chain of two points as a segment. Cost: O(1), of a segment or chain O(bodies with
    /// edges); a copy. @throws Error (stale_handle)
    Shape shape(BodyId body) const;

    /// Whether a body sleeps: it stands still, and steps do not look at it. @throws Error (stale_handle)
    bool is_asleep(BodyId body) const;

    /// Adds a body between steps. @throws Error as `Scene::validate`; names need not be unique here.
    /// Cost: O(1) and what wakes; the next step takes O(bodies + contacts) more, as after `remove` and
    /// `set_position`, however many bodies have changed.
    BodyId add(const Body& body);
    /// Removes a body, and its joints; their handles go stale. @throws Error (stale_handle)
    void remove(BodyId body);
    /// Puts a body elsewhere: its centre of mass [m], each component within ±kLargestPosition. Velocity and
    /// angle stay. @throws Error (stale_handle, not_finite, out_of_range); the world is then unchanged.
    void set_position(BodyId body, Vec2 position);
    /// Sets a velocity, as an impulse does: m/s, speed at most kLargestSpeed; rad/s, within
    /// ±kLargestAngularVelocity. Kinematic bodies go on at it. @throws Error as set_position; (inconsistent)
    /// for anything but zero where nothing can move the body: it is static, was quarantined, or its rotation
    /// is fixed. Cost: O(1) and what wakes.
    void set_velocity(BodyId body, Vec2 velocity);
    void set_angular_velocity(BodyId body, double angular_velocity);
    /// Changes what a body touches, from the next step on: joints, velocities and all else stay. It wakes,
    /// and so do sleepers around it; contacts that stay keep their impulses. Cost: that of finding all pairs
    /// anew in the next step; nothing if the filter is the one it has.
    /// @throws Error (stale_handle); (inconsistent) if the solver is `event`, which knows no filters. The
    /// world is then unchanged.
    void set_filter(BodyId body, const Filter& filter);
    /// @throws Error (stale_handle)
    Filter filter(BodyId body) const;

    /// Goes on with another solver from the next step on. Positions, velocities and energy stay; forces of
    /// contacts are found anew; bodies that sleep wake. `plan()` says what runs. A world of `automatic` does
    /// so by itself when a body is added that calls for another solver.
    /// @throws Error (inconsistent) if that solver cannot do what the world has, or steps no World; the world
    /// is then unchanged, but for bodies that woke.
    void set_solver(Solver solver);

    /// Adds a joint between bodies where they stand now; they wake.
    /// @throws Error as `Scene::validate`; (stale_handle) if a body is not there; (inconsistent) if the world
    /// has a solver that knows no joints and was asked for it. Cost: O(joints) in the next step.
    JointId add(const Joint& joint);
    /// Removes a joint; its handle goes stale. A removed body takes its joints along. @throws Error
    /// (stale_handle)
    void remove(JointId joint);
    std::size_t joint_count() const noexcept;
    /// Whether a handle names a joint of this world: it goes stale when the joint breaks, too.
    bool is_alive(JointId joint) const noexcept;
    /// Changes a motor of a revolute, prismatic or wheel joint.
    /// @param speed  rad/s or m/s, within ±kLargestSpeed  @param most  N m or N, >= 0; 0 turns it off
    /// @throws Error (stale_handle, not_finite, out_of_range, inconsistent)
    void set_motor(JointId joint, double speed, double most);
    /// Changes the limits of a distance, revolute or prismatic joint. One that is changed before a step and
    /// was before the last one, the same way, moves through the step, and what it holds gets its velocity (of
    /// the slower of the two changes): a rope that is reeled in, a lift. Else bodies are displaced to it, and
    /// get none.
    /// @param lower  m, of a distance joint >= 0, or rad  @param upper  >= lower, both as in a scene
    /// @throws Error as set_motor
    void set_limits(JointId joint, double lower, double upper);
    /// Moves the target of a target joint [m], within ±kLargestPosition. @throws Error as set_motor
    void set_target(JointId joint, Vec2 target);
    /// Mean force on b in the last step [N], of a joint of a body and the world on the body; of joints that
    /// are swept and cannot break, that of its last substep. @throws Error (stale_handle)
    Vec2 joint_force(JointId joint) const;
    /// Mean torque on b, or on the body, in the last step, about its anchor [N m]. @throws Error
    /// (stale_handle)
    double joint_torque(JointId joint) const;
    /// How far joints are from what they hold, from positions. Cost: O(joints).
    JointErrors joint_errors() const;
    /// The joints that broke in the last step, by the handles they had; `events` says more of them.
    /// Cost: O(joints that broke).
    std::vector<JointId> broken_joints() const;
    /// Where a joint holds a and b now [m], for pictures. @throws Error (stale_handle)
    std::array<Vec2, 2> joint_anchors(JointId joint) const;

    /// What happened in the last step, or since the last `clear_events` (`WorldOptions::keep_events`). Valid
    /// until the next call that changes the world.
    Events events() const noexcept;
    void clear_events() noexcept;
    /// The bodies that overlapped a sensor at the end of the last step, in handle order.
    /// @throws Error (stale_handle). Cost: O(bodies in sensors).
    std::vector<BodyId> sensed(BodyId sensor) const;

    double time() const noexcept;  ///< s, sum of all steps
    /// Energy and momentum now; by cause if the ledger effect is on. Cost: O(bodies).
    Ledger ledger() const;
    /// Seconds by stage and counters since the world was made. Cost: O(contacts of the last
    /// step) for their residual; steps themselves do not pay for it.
    Profile profile() const;
    /// What runs and why. Cost: O(bodies), for Plan::limits.
    Plan plan() const;
    /// Overlaps measured from positions; changes nothing in the world. Cost: as finding all pairs anew, which
    /// steps seldom do: O(bodies + pairs close to each other), and memory for them.
    OverlapReport overlaps() const;
    /// Bodies that were disabled because their state left the limits, in handle order.
    std::vector<BodyId> quarantined() const;
    /// Bytes of the state: what a step depends on and nothing else. Changes as the world runs. Cost: O(1),
    /// nearly.
    std::size_t state_bytes() const;
    /// Writes the state: bodies, candidate pairs, contacts with their impulses, sleep, clock, books.
    /// @param out  room for state_bytes(); more is left as it is
    /// @throws Error (out_of_range) if there is less; nothing is written then
    /// Cost: O(state), a copy of it; no allocation.
    void save_state(std::span<std::byte> out) const;
    /// Goes on from a state as the world that saved it would have, bit for bit, whatever scene this world was
    /// made of, on any number of threads and any instruction set. Handles are those of the saved world;
    /// `profile()` goes on counting. States are of one precision and one build of the library; they are no
    /// file format. A checksum tells bytes that were damaged on their way, not those that were made up:
    /// take states from where programs may come from.
    /// @throws Error (malformed, inconsistent) if the bytes are no such state or are damaged; the world is
    /// then unchanged Cost: O(state); no allocation once the world has been as large.
    void restore_state(std::span<const std::byte> state);
    /// Hash over the bit patterns of position, velocity, angle and spin of all bodies in handle order: equal
    /// where two worlds are, for every instruction set and number of threads. Cost: O(bodies).
    std::uint64_t state_hash() const;

    struct Implementation;

  private:
    std::unique_ptr<Implementation> implementation_;
};

extern template class BasicWorld<float>;
extern template class BasicWorld<double>;

using World = BasicWorld<float>;
using World64 = BasicWorld<double>;

/// The instruction sets compiled in that this machine can run, slowest first: "scalar", "sse2", ...
std::vector<std::string> runnable_instruction_sets();

}  // namespace carom
