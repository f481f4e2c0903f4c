#pragma once

#include <array>
#include <vector>

#include "constraints/joints/drive_law.hpp"
#include "constraints/task_groups.hpp"
#include "kernels/joints/joint_arguments.hpp"
#include "parallel/phases.hpp"
#include "solvers/joints/joint_bundles.hpp"
#include "solvers/joints/joint_step.hpp"
#include "solvers/joints/joint_stiffness.hpp"

namespace carom {

/// Joints of groups that are too entangled to be solved exactly, or so many and small that it is not worth
/// it: swept by lanes, with the impulses of the step before to start from. A joint is swept in up to two
/// parts, that of its points and that of its angle: a weld is a hinge whose angle has both its ends at 0, a
/// slider an axle of which that is so.
///
/// They have task groups of their own (constraints/task_groups.hpp), by rows alone: bodies in the order of
/// their rows. In each the joints of a kind are sorted by colour, and a run over a group is one call of a
/// kernel.
///
/// Mechanisms of a crowd share no bodies: those of hinges are swept each on its own, a lane each
/// (joint_bundles.hpp). Their joints come last in the columns.
template <class Real>
class SweptJoints {
  public:
    /// Substeps a step where there are joints of this kind, unless a scene says otherwise.
    static constexpr int kSubsteps = 6;

    /// Whether the kernels know a joint.
    static bool knows(const StoredJoint& joint);

    /// Sorts the joints. @param slots  of those that the kernels know
    /// @param crowd  slots of each group of a crowd, of bodies that move
    /// @return slots of joints that found no colour, or hang on what moves by itself. Cost: O(joints)
    std::vector<std::size_t> sort(const WorldState<Real>& world, std::vector<std::size_t> slots,
                                  const std::vector<std::vector<std::size_t>>& crowd);
    /// Rows beyond the bodies that joints name: the world, and what never moves, once for each group and each
    /// bundle, so that no two tasks write to one.
    std::size_t rows_beyond() const { return groups_.count() + bundles_.bundles.size(); }
    bool empty() const { return parts_of_joints_ == 0; }
    std::size_t joints() const { return joints_; }
    std::size_t colours() const { return colours_; }
    /// Whether sweeps are long enough for more than one thread.
    bool has_long_loops() const { return groups_.chunks > 1 || bundles_.bundles.size() > 1; }

    /// Where the joints are at the start of a step.
    void begin_step(const JointStep<Real>& step, const StepLoops<Real>& loops);
    /// Those that a substep takes: a number of next sweeps, after the first of a substep, after that which
    /// gives impulses at the start of a step.
    enum class Begin : std::uint8_t { step, substep, nothing };
    void sweep(const JointStep<Real>& step, const StepLoops<Real>& loops, Begin begin);
    /// Closes hinges of crowds that are open by more than a share of their limbs, by displacement, in
    /// mechanisms that are trees. @return the share of these in which one was
    double close_gaps(const JointStep<Real>& step, const StepLoops<Real>& loops);
    /// The work of the joints in this substep, and what they gave to what nothing moves.
    void book(const JointStep<Real>& step, Books& books) const;
    /// Adds what joints that may break gave in this substep to what they have given in the step.
    void note_forces();
    /// What the store keeps of a step: forces of its last substep, of joints that may break those of all of
    /// it.
    /// @param dt  s, of the step
    void store(JointStore& joints, double substep_dt, double dt, const Executor& executor) const;

    /// Calls fn(row) for every row that has such a joint.
    template <class Fn>
    void for_each_row(const Fn& fn) const {
        for (const Kind& kind : kinds_)
            for (std::size_t i = 0; i < kind.slot.size(); ++i)
                if (kind.slot[i] >= 0) fn(kind.a[i]), fn(kind.b[i]);
    }
    /// Calls fn(a, b, work, bend) for each joint: the work that it may do in this substep [J], of its spring
    /// and motor, and of what keeps bodies on paths that bend.
    template <class Fn>
    void for_each_drive(const JointStep<Real>& step, const Fn& fn) const {
        for (std::size_t kind = 0; kind < kinds_.size(); ++kind)
            for (std::size_t i = 0; i < kinds_[kind].slot.size(); ++i)
                if (kinds_[kind].slot[i] >= 0)
                    fn(kinds_[kind].a[i], kinds_[kind].b[i], work_of_drive(step, kind, i),
                       work_of_bend(step, kind, i));
    }
    /// Multiplies the impulses of each joint by share_of(a, b); velocities stay as they are.
    template <class ShareOf>
    void scale(const ShareOf& share_of) {
        for (Kind& own : kinds_)
            for (std::size_t i = 0; i < own.slot.size(); ++i) {
                const auto share = static_cast<Real>(own.slot[i] >= 0 ? share_of(own.a[i], own.b[i]) : 1);
                if (share == 1) continue;
                for (Column<Real>* impulse :
                     {&own.impulse_x, &own.impulse_y, &own.impulse_z, &own.impulse_w, &own.across})
                    if (!impulse->empty()) (*impulse)[i] *= share;
            }
    }
    std::size_t bytes() const;

  private:
    /// The joints of one kernel, by group and colour; padding has the slot -1.
    struct Kind {
        Column<std::int32_t> a, b, slot;
        Column<std::int32_t> of_bundle_a, of_bundle_b;  // numbers of bodies in their bundle; before bundles 0
        Column<RowOrder> order;                         // of each kJointBlock places
        Column<Real> start_x, start_y, length, impulse_x, impulse_y, normal_x, normal_y, per_length;
        Column<Real> start_arm_a_x, start_arm_a_y, start_arm_b_x, start_arm_b_y;
        Column<Real> arm_a_x, arm_a_y, arm_b_x, arm_b_y, per_rim_a, per_rim_b, seen_a, seen_b;
        Column<Real> impulse_z, impulse_w, value, alpha, gamma, lower, upper, lower_rate, upper_rate, speed,
            most;
        Column<Real> axis_x, axis_y, across;
        std::vector<std::size_t> begin;  // of each group, and the end
        /// What a joint is made of, in the order of the columns: joints themselves lie apart in memory.
        struct Source {
            std::int32_t row_a, row_b;  // below zero: the world
            Vec2 anchor_a, anchor_b;    // m, in the frame of the body, or of the world
            double angle;               // rad, at which the angle counts as 0
            Vec2 axis;                  // no unit, in the frame of a
        };
        std::vector<Source> sources;
        /// What drives a joint.
        struct Drive {
            double most = 0;       // N s or N m s, of its motor in a substep
            bool springs = false;  // softly
        };
        std::vector<Drive> drives;
        // Joints in bundles have their anchors in the frames of their bodies here [m], and the angles that
        // count as 0 [rad].
        Column<double> anchor_a_x, anchor_a_y, anchor_b_x, anchor_b_y, angle_at_zero;

        /// @param needs  which columns, bits of Needs
        void resize(std::size_t places, unsigned needs);
        void find_order();
        JointColumns<Real> columns();
        template <class Fn>
        void for_each_column(const Fn& fn);
    };
    enum : std::size_t { kRods, kRodsOfAnchors, kHinges, kSprings, kAxles, kAngles, kKinds };
    enum Needs : unsigned { kPoints = 1, kArms = 2, kRims = 4, kDrives = 8, kAxes = 16 };
    static unsigned needs_of(std::size_t kind);
    /// The part of a joint that is about points, and whether it has one about its angle.
    static std::size_t kind_of(const StoredJoint& joint);
    static bool has_angle_part(const StoredJoint& joint);
    /// What acts on the coordinate of a kind that gives way.
    static DriveLaw law_of(const StoredJoint& joint, std::size_t kind);
    static bool gives_way(std::size_t kind) { return kind >= kSprings; }
    Real* turn_of(BodyRecords<Real>& records);
    void add_bundles();
    SweepJoints<Real> of_bundles(std::size_t kind) const;
    void sweep_bundles(const StepLoops<Real>& loops, Begin begin) const;
    void load(const WorldState<Real>& world);
    void begin_joints(const JointStep<Real>& step, Kind& own, std::size_t kind, std::size_t first,
                      std::size_t last);
    void begin_joint(const JointStep<Real>& step, Kind& own, std::size_t kind, std::size_t i,
                     const std::array<Rotation, 2>& turns);
    void begin_rods(const JointStep<Real>& step, Kind& own, std::size_t first, std::size_t last);
    void begin_drive(const JointStep<Real>& step, Kind& own, std::size_t kind, std::size_t i);
    void share_out(Kind& own, std::size_t i, double impulse);
    void begin_bundles(const JointStep<Real>& step, const StepLoops<Real>& loops);
    void load_bundles(const WorldState<Real>& world);
    /// Places of a kind that are in no bundle.
    std::size_t places_before_bundles(std::size_t kind) const { return kinds_[kind].begin.back(); }
    void add_stiffness(const Kind& own, std::size_t places);
    [[gnu::always_inline]] static inline void store_joint(StoredJoint& joint, const Kind& own,
                                                          std::size_t kind, std::size_t i, double substep_dt);
    /// The impulse of a spring, a rope or an angle, or along an axle: along the length [N s] or about the
    /// angle [N m s].
    static double sum_of_impulses(const Kind& own, std::size_t i) {
        return static_cast<double>(own.impulse_x[i]) + static_cast<double>(own.impulse_y[i]) +
               static_cast<double>(own.impulse_z[i]) + static_cast<double>(own.impulse_w[i]);
    }
    /// The impulse on b of the part of a joint that is about points [N s].
    static Vec2 impulse_on_b(const Kind& own, std::size_t i, std::size_t kind) {
        if (kind == kHinges) return {own.impulse_x[i], own.impulse_y[i]};
        const Vec2 normal{own.normal_x[i], own.normal_y[i]};
        if (!gives_way(kind)) return static_cast<double>(own.impulse_x[i]) * normal;
        const Vec2 along = sum_of_impulses(own, i) * normal;
        if (kind != kAxles) return along;
        return along + static_cast<double>(own.across[i]) * Vec2{-normal.y, normal.x};
    }

    double work_of_drive(const JointStep<Real>& step, std::size_t kind, std::size_t i) const;
    double work_of_bend(const JointStep<Real>& step, std::size_t kind, std::size_t i) const;

    /// A part of a joint that may break: a blow may fall in any substep.
    struct Breakable {
        std::size_t kind, place;
        Vec2 force;         // N s, in this step so far
        double torque = 0;  // N m s
    };
    std::vector<Breakable> breakable_;

    std::vector<Kind> kinds_;  // kKinds of them; none where no joint is swept, as in most worlds
    TaskGroups groups_;
    JointBundles bundles_;
    Column<double> inertia_of_bundles_, longest_of_bundle_, hung_x_,
        hung_y_;  // kernels/joints/joint_arguments.hpp
    std::size_t joints_ = 0, parts_of_joints_ = 0, colours_ = 0;
    std::int32_t first_beyond_ = 0;      // row
    bool has_joints_of_groups_ = false;  // whether some joint is in no bundle
    bool is_loaded_ = false;             // whether columns have what the store keeps
    bool ends_move_ = false;             // in this step, of some joint
    // What drives of all joints were made of: JointStore::settings, s of a substep; -1: they may have
    // changed.
    std::int64_t settings_ = -1;
    double substep_of_drives_ = 0;
    bool keeps_drives_ = false;  // in this step: they are those of the step before
    bool has_springs_ = false;   // some joint springs
    bool has_motors_ = false;    // some joint has a motor
    double longest_ = 0;         // m, arm of hinges
    JointStiffness stiffness_;
    std::vector<std::size_t> closed_;  // mechanisms that were closed last, by bundle
    /// How far joints turn their bodies back: arm times impulse of a substep [N s m].
    struct Moments {
        double of_a, of_b;
    };
    std::vector<Moments> moments_;              // of the present kind, by place
    Column<Real> no_turn_;                      // in place of turns in worlds where nothing turns
    std::vector<SweepJoints<Real>> arguments_;  // by kind
    const KernelTable<Real>* kernels_ = nullptr;
    enum class Kernel : std::uint8_t { give, first, next, last };
    enum class Part : std::uint8_t { chunks, far, borders };
    struct Phase {
        Kernel kernel;
        Part part;
    };
    std::vector<PhaseKind> phases_;
    std::vector<Phase> parts_;
    void run_group(std::size_t group, Kernel kernel) const;
};

extern template class SweptJoints<float>;
extern template class SweptJoints<double>;

}  // namespace carom
