#pragma once

#include <carom/events.hpp>
#include <carom/joints.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "state/bodies.hpp"
#include "state/handles.hpp"
#include "state/joint_limit.hpp"

namespace carom {

enum class JointType : std::uint8_t { distance, revolute, prismatic, weld, wheel, target, gear };

/// In place of the slot of a joint: none.
inline constexpr std::uint32_t kNoJoint = UINT32_MAX;

/// A joint as a world keeps it: what was asked for, as numbers, and what it did last. The solver makes
/// columns of those that it solves by lanes (solvers/soft/joints/).
struct StoredJoint {
    BodyId a, b;  // b is always a body; kNoBody in a: the world
    JointType type = JointType::revolute;
    bool collide = false, has_lower = false, has_upper = false, has_motor = false;
    bool is_held = true;        // whether the length of a distance joint is: a rope's is not
    bool is_exchanged = false;  // whether a is what was given as b
    bool is_free = true;        // whether its group touched nothing in the last step
    bool is_listed = false;     // whether the store knows that its limits may move
    Vec2 anchor_a, anchor_b;    // m, in the frame of the body, or of the world
    Vec2 axis{1, 0};            // of length 1, in the frame of a
    double angle = 0;           // rad, of b against a, at which its angle counts as 0; of
                                // a gear, what constraints/joints/gear_joint.hpp says
    double length = 0;          // m
    JointLimit lower, upper;
    double motor_speed = 0, max_motor = 0;              // m/s or rad/s; N or N m
    double frequency = 0, damping_ratio = 0;            // Hz; 0: rigid
    double ratio = 1;                                   // of a gear
    std::uint32_t first = kNoJoint, second = kNoJoint;  // slots of the joints that a gear couples, or none
    Vec2 target;                                        // m
    double max_force = 0;                               // N
    double break_force = std::numeric_limits<double>::infinity();
    double break_torque = std::numeric_limits<double>::infinity();
    // What it did last.
    std::array<double, 3> impulse{};  // N s, of a substep, of its rows: constraints/joints/joint_rows.hpp
    Vec2 force;                       // N, on b
    double torque = 0;                // N m, on b
    double held = 0;  // J, what taut loops of its group have taken from its motion; its first joint has it

    bool is_on_world() const { return a == BodyId{}; }
    bool is_spring() const { return frequency > 0; }
    /// Whether what is counted of b against a is kept with the other sign; a length has none.
    bool turns_sign() const { return is_exchanged && type != JointType::distance; }
    /// A way, an angle or a speed of b against a, as it was given, in the order in which the bodies are kept.
    double as_kept(double value) const { return turns_sign() ? -value : value; }
    bool may_break() const {
        constexpr double kUnbreakable = std::numeric_limits<double>::infinity();
        return break_force < kUnbreakable || break_torque < kUnbreakable;
    }
    bool has_moving_limit() const { return lower.rate != 0 || upper.rate != 0; }
};

/// Two bodies of one mechanism that were in each other when it was joined.
struct BuiltInPair {
    BodyId a, b;
};

/// Every joint of a world. Slots stay; a removed joint leaves a hole that the next one fills.
class JointStore {
  public:
    /// Counts changes after which what was derived from joints is to be made anew.
    std::int64_t version = 0;
    /// Counts changes of motors and limits, which the solver may have copies of.
    std::int64_t settings = 0;

    bool empty() const { return count_ == 0; }
    std::size_t count() const { return count_; }
    std::size_t slots() const { return slots_.size(); }
    bool has(std::size_t slot) const { return slots_[slot].is_used; }
    StoredJoint& operator[](std::size_t slot) { return slots_[slot].joint; }
    const StoredJoint& operator[](std::size_t slot) const { return slots_[slot].joint; }
    JointId id_of(std::size_t slot) const {
        return JointId::of(static_cast<std::uint32_t>(slot), slots_[slot].generation);
    }

    JointId add(const StoredJoint& joint);
    /// Removes a joint, and the gears that couple it.
    void remove(std::size_t slot);
    /// Removes the joints of a body that is removed.
    void remove_of(BodyId body);

    /// Limits that a joint has from the next step on; they may move in it.
    /// @param low, high  as they were given [m or rad]
    void set_limits(std::size_t slot, double low, double high);
    /// How limits move in a step. To be called at its start, once more if it ended early.
    void begin_limits(double dt);
    void end_limits(double dt);
    bool may_move_limits() const { return !moving_.empty(); }

    bool is_alive(JointId id) const {
        return id.index < slots_.size() && slots_[id.index].is_used &&
               slots_[id.index].generation == id.generation;
    }
    /// @throws Error (stale_handle) naming the call.
    std::size_t slot_of(JointId id, std::string_view where) const;

    /// Calls fn(slot, joint) for each joint, in the order of slots.
    template <class Fn>
    void for_each(const Fn& fn) const {
        for (std::size_t slot = 0; slot < slots_.size(); ++slot)
            if (slots_[slot].is_used) fn(slot, slots_[slot].joint);
    }

    /// Whether these two bodies do not touch: a joint of theirs says so, or they are a built-in pair. Cost:
    /// O(joints and built-in pairs that body `a` or `b` has).
    bool excludes(BodyId a, BodyId b) const;

    /// Pairs that do not touch before they have come apart (solvers/joints/built_in_pairs.hpp).
    std::span<const BuiltInPair> built_in_pairs() const { return built_in_; }
    /// Slots of joints that were added since the last call; some may be removed by now.
    std::vector<std::uint32_t> take_added_slots() { return std::exchange(added_, {}); }
    bool may_have_built_in_pairs() const { return !added_.empty() || !built_in_.empty(); }
    /// The pairs are listed no more for which is_free(pair). @return whether there are any
    template <class IsFree>
    bool let_touch(const IsFree& is_free) {
        if (std::erase_if(built_in_, is_free) == 0) return false;
        list_excluded();
        return true;
    }
    void add_built_in(std::span<const BuiltInPair> pairs);

    std::vector<JointBreak> broken;  ///< in the last step, or since events were cleared
    /// Whether any has broken since a time [s].
    bool have_broken_since(double time) const { return !broken.empty() && broken.back().time > time; }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.version, self.count_, self.slots_, self.free_, self.broken, self.built_in_, self.added_,
                self.moving_);
        if constexpr (!std::is_const_v<Self>) self.list_excluded();
    }
    std::size_t bytes() const;

  private:
    struct Slot {
        StoredJoint joint;
        std::uint32_t generation = 0;
        bool is_used = true;
    };
    void list_excluded();

    std::size_t count_ = 0;
    std::vector<Slot> slots_;
    std::vector<std::uint32_t> free_, added_;
    std::vector<std::uint32_t> moving_;  // slots of joints whose limits may move
    std::vector<BuiltInPair> built_in_;
    // Pairs of bodies that do not touch, sorted: the upper half of a pair is the lower slot of a body. Those
    // of slot i are first_excluded_[i] ... first_excluded_[i + 1].
    std::vector<std::uint64_t> excluded_;
    std::vector<std::uint32_t> first_excluded_;
};

/// The joint in numbers.
/// @param a, b  state of its bodies now; of the world at rest in the origin
/// @param joint  that has been validated
struct JointBody {
    Vec2 position;
    double angle = 0;
};
StoredJoint stored_joint(const Joint& joint, const JointBody& a, const JointBody& b);

}  // namespace carom
