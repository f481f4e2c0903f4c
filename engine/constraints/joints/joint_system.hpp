#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "constraints/coupled_impulses.hpp"
#include "constraints/joints/free_rows.hpp"
#include "constraints/joints/joint_rows.hpp"
#include "constraints/joints/spring_law.hpp"
#include "math/cycle_finder.hpp"

namespace carom {

/// A body of a system of joints.
struct SystemBody {
    JointPose pose;
    Vec2 velocity;                    // m/s
    double spin = 0;                  // rad/s
    double inverse_mass = 0;          // 1/kg; 0: nothing moves it
    double inverse_inertia = 0;       // 1/(kg m²); 0: nothing turns it
    double seen_inverse_inertia = 0;  // with the stiffness of taut joints: JointSystem::stiffen
};

/// Bodies and the joints between them, solved exactly: a tree of joints by elimination, leaves first, in the
/// time of O(joints) whatever the masses; joints that close loops, motors and limits by a Schur complement
/// over the tree.
///
/// The system of velocities is M dv = J^T l, J dv + S l = e, with the compliance S of springs. Seen from a
/// leaf, a body with the inertia matrix I and its joint to the parent, with rows J_b of the body and J_p of
/// the parent: eliminating the body leaves (J_b I^-1 J_b^T + S) l = e - J_p dv_p, and eliminating l adds
/// J_p^T (J_b I^-1 J_b^T + S)^-1 J_p to the inertia matrix of the parent. So one goes from the leaves to the
/// roots, which are the world, bodies that nothing moves, or one body of each free group, and back.
/// Nothing is subtracted on the way in, so a chain with 50,000 times the mass of a link at its end is as
/// exact as one without.
/// Source: Baraff 1996, Linear-time dynamics using Lagrange multipliers.
///
/// The rows are curved: what is asked for is not J v = 0 but that the path ends where it should,
/// c(q + h v) = c(q), found by Newton's method with the Jacobian of the start. A tangent path keeps no
/// energy: it loses w² h of the kinetic energy a second. How far c(q) is off is corrected by displacement
/// alone and feeds no velocity. docs/decisions/0026-joints.md.
class JointSystem {
  public:
    /// Rows that close loops, beyond which the complement is dearer than sweeps.
    static constexpr std::size_t kMostLoopRows = 48;
    /// Such rows, motors and limits.
    static constexpr std::size_t kMostExtraRows = 128;

    /// Body 0 is the world: at rest in the origin.
    std::vector<SystemBody> bodies;

    /// A joint of bodies by their numbers.
    struct Member {
        const StoredJoint* joint = nullptr;
        std::int32_t a = 0, b = 0;
        std::int32_t gear = -1;           // number among the gears, if it is one
        double least_gamma = 0;           // of a spring that meets with others: spring_law.hpp
        SpringTerms whole, half;          // of the springs, for the length of a substep
        std::array<double, 3> impulse{};  // N s, of this substep, by slot; what it has given so far
        Vec2 force;                       // N s, on b: sum of all impulses of this step
        double torque = 0;                // N m s, on b, about its anchor
    };
    std::vector<Member> joints;

    /// What presses on a body of the system, at a point: corrections do not displace the one into the other.
    struct Load {
        std::int32_t body = 0;
        std::array<double, 3> along{};                 // what a unit push gives the body [N s, N s, N m s]
        std::int32_t other = 0;                        // what presses, by a number that tells it from others
        std::array<double, 3> other_along{};           // what a unit push gives that
        double inverse_mass = 0, inverse_inertia = 0;  // of that; 0: nothing moves it
        double separation = 0;                         // m
        double push = 0;                               // kg m, of the last correction
    };
    std::vector<Load> loads;

    /// Makes joint number `joint` a gear of two others by their numbers; below zero: of its own bodies.
    void add_gear(std::size_t joint, std::int32_t first, std::int32_t second);

    /// Finds the order of elimination. To be called when bodies or joints have changed.
    void plan();
    std::size_t loop_count() const { return loops_.size(); }
    std::size_t loop_rows() const { return loop_rows_; }
    /// Rows that motors and limits can have.
    std::size_t drive_rows() const { return drive_rows_; }
    bool is_small_enough() const {
        return loop_rows_ <= kMostLoopRows && loop_rows_ + drive_rows_ <= kMostExtraRows;
    }

    /// Which share of a substep's impulses is asked for.
    enum class Part : std::uint8_t { whole, half };

    /// Terms of springs for substeps of h.
    void set_substep(double h);
    /// Limits may move until the end of the step.
    /// @param until_end  s, from the start of the substep that is prepared next
    void set_until_end(double until_end) { until_end_ = until_end; }
    /// Rows at the present positions, and their factors. Begins impulses anew, once the inertias that bodies
    /// seem to have are known from those of the substep before (stiffen).
    /// @param keeps  whether impulses go on from the substep before, of which velocities tell already
    void prepare(Part part, bool keeps = false);
    /// Gives bodies the impulses that joints have.
    void give_impulses();
    /// Forgets what joints have given and taken since `prepare`; velocities stay as they are.
    void forget_impulses();
    /// Displaces bodies so that what is held is where it should be, as far as the rows of `prepare` tell.
    /// @param least  m: errors below it are left
    /// @param length  m, of the system: joints are corrected by a tenth of it at most
    /// @return whether anything moved
    bool correct_positions(double least, double length);
    /// Draws bodies to targets.
    void pull();
    /// Velocities that end on what is held after h; adds to the impulses.
    /// @param rounds  of Newton's method, >= 1
    /// @param least  m/s: of what rows lack, at which no further round is made
    void solve_curved(int rounds, double least = 0);
    /// Velocities along what is held now: J v = 0.
    void solve_flat();
    /// The work [J] that springs, motors, limits that move, targets and bodies that move by themselves do
    /// with the impulses given since `prepare`, at the velocities that bodies have now.
    double work_of_drives();
    /// Multiplies the impulses that the joints have given since `prepare`; velocities stay as they are.
    void scale(double share);
    /// Adds what the joints have given since `prepare` to their forces.
    void note_forces();

    using Vector = std::array<double, 3>;
    /// An impulse on a body.
    struct Blow {
        std::size_t body;
        Vector impulse;  // N s, N s, N m s
    };
    /// What motors and limits do where a blow is answered.
    enum class Drives : std::uint8_t {
        in_a_blow,  ///< limits that are reached push, motors do nothing: a blow takes no time
        as_solved,  ///< those hold that the last solve found between their ends
        no_motors,  ///< limits as solved; motors give what they are told to, as blows (push_motor)
    };
    /// What blows change the velocities of all bodies by, while joints hold at the rows of `prepare`.
    /// Velocities and impulses stay as they are. Cost: O(joints), and O(rows²) of loops.
    void answer(std::span<const Blow> blows, Drives drives);
    /// m/s, m/s, rad/s: of a body that can move, by the last blows.
    const Vector& answer_of(std::size_t body) const { return change_[body]; }
    /// Adds what the joints gave in answer to the last blows to their forces.
    void note_answer();
    /// The last blows take place: velocities change, and impulses by what the joints gave in answer.
    void take_answer() { take_velocities(); }
    /// A motor, to be solved together with what acts on bodies (solvers/soft/joints/heavy_loads.hpp).
    struct Motor {
        std::size_t extra;          // its row
        double impulse, low, high;  // N s, of this substep so far, and within what it is
        double lack;                // m/s, what its velocity is below the one it asks for
        double alone;               // 1/kg, its inverse mass, were it the only row of the system
    };
    /// All motors, in an order that stays the same until `plan`.
    void list_motors(std::vector<Motor>& motors) const;
    /// Adds what an impulse of a motor gives bodies.
    void push_motor(const Motor& motor, double impulse, std::vector<Blow>& blows) const;
    /// What unit impulses change velocities by, all at once, where that is linear: as_solved or no_motors.
    /// Sides 3 i, 3 i + 1 and 3 i + 2 push the body asked[i] along x, along y and about its centre; behind
    /// them is one for each motor, in their order, if motors give what they are told to. Cost: O(joints) a
    /// side, in lanes; O(rows²) of loops.
    void find_answers(std::span<const std::size_t> asked, Drives drives);
    /// Whether the limits that hold now are those that held when answers to impulses without motors were
    /// found; if not, a blow has another answer.
    bool answers_hold() const;
    /// m/s, m/s, rad/s: of a body that was asked for.
    Vector answer_to(std::size_t side, std::size_t body) const { return answers_.at(body, side); }
    double answer_to(std::size_t side, const Motor& motor) const;  ///< m/s, of the motor's row
    void add_to_motor(const Motor& motor, double impulse) { extras_[motor.extra].impulse += impulse; }
    /// Moves bodies through h; for tests and for systems that nothing else moves.
    void advance();

    /// Largest error of what is held, by the rows of `prepare` [m]: an angle counts with the larger arm.
    double largest_error() const { return largest_error_; }
    /// Impulses and shares of a step before are those of whole substeps: for the first `prepare` of a step.
    /// @param is_rigid  whether taut loops are held as others are
    void begin_step(bool is_rigid = false) { part_ = Part::whole, is_rigid_ = is_rigid; }
    Part part() const { return part_; }
    /// What taut loops hold [J]. It goes on from step to step with the impulses.
    double held() const { return held_; }
    void set_held(double joules) { held_ = joules; }
    std::size_t bytes() const;

  private:
    // A Vector: vx, vy, spin, or what changes them.
    struct Symmetric {  // 3 × 3
        double xx, xy, xz, yy, yz, zz;
    };
    /// A body but the roots, with the joint to its parent; or a root.
    struct Link {
        std::int32_t body = 0, joint = -1, parent = 0;
        bool is_b = true;  // whether the body is b of its joint
        bool parent_moves = false;
        int rows = 0;
        std::array<Vector, 3> own, others, reach;  // J_b, J_p, J_b I^-1
        Symmetric inverse;                         // I^-1
        // (J_b I^-1 J_b^T + S) = L D L^T
        double l10 = 0, l20 = 0, l21 = 0;
        Vector inverse_d{};
        Vector half_way{};  // of a solve
    };
    /// A row that is no part of the tree: of a loop, a motor or a limit.
    struct Extra {
        std::int32_t joint;
        std::int32_t row;
        double low, high;    // N s, of its impulse in this substep
        double impulse = 0;  // N s, so far
    };
    /// A gear, gear_joint.hpp: what it couples, and the rows of that at the present positions.
    struct Coordinate {
        std::int32_t joint;  // below zero: the angle of body b
        std::int32_t a, b;   // bodies
        JointRow row{};
    };
    struct Gear {
        std::int32_t joint;  // its own number
        std::array<Coordinate, 2> coordinates;
    };
    /// The part of an extra row that is a body's, if that can move.
    struct RowPart {
        std::size_t body;
        Vector row;
    };
    /// Pushes on all bodies, or what they change, for several right sides at once.
    struct Sides {
        std::size_t count = 0;
        std::vector<double> values;  // [bodies][3][count]
        double* of(std::size_t body) { return &values[body * 3 * count]; }
        Vector at(std::size_t body, std::size_t side) const {
            const double* x = &values[body * 3 * count + side];
            return {x[0], x[count], x[2 * count]};
        }
        void reset(std::size_t body_count, std::size_t sides) {
            count = sides, values.assign(body_count * 3 * sides, 0);
        }
        void add(std::size_t body, std::size_t side, const Vector& push) {
            for (std::size_t c = 0; c < 3; ++c) of(body)[c * count + side] += push[c];
        }
    };
    /// Factors of free rows.
    struct Factors {
        FreeRows softened, filtered;
        bool are_known = false, is_filter_known = false;  // of matrix_ as it is
    };
    enum class End : std::uint8_t { none, low, high };  // where the impulse of an extra row is

    /// What taut joints add to the inertia that a substep sees.
    ///
    /// A light body between taut joints turns about their common line with w = sqrt(T r / I), and substeps of
    /// length h follow that up to w h = 2. An arm r under a pull of T resists turning with the stiffness
    /// k = sum r · l / h over the joints' impulses l; the inertia seen is max(I, h² k), so that w h <= 1
    /// always. Added always it would pump energy.
    void stiffen(double share);
    void measure_rows();
    void factor() { factor_tree(), couple_extras(); }
    void factor_tree();
    void factor_link(Link& link);
    void add_to_parent(const Link& link);
    static double dot3(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static Symmetric inverse_of(const Symmetric& m);
    static Vector times(const Symmetric& m, const Vector& v) {
        return {m.xx * v[0] + m.xy * v[1] + m.xz * v[2], m.xy * v[0] + m.yy * v[1] + m.yz * v[2],
                m.xz * v[0] + m.yz * v[1] + m.zz * v[2]};
    }
    template <int kRows>
    static void solve_block(const Link& link, Vector& e);
    template <int kRows>
    void go_in(Link& link);
    template <int kRows>
    void go_out(Link& link);
    template <int kRows>
    void go_in_sides(const Link& link, double* half_way, Sides& sides);
    template <int kRows>
    void go_out_sides(const Link& link, double* half_way, Sides& sides);
    void solve_tree_of(Sides& sides);
    double row_velocity(std::size_t joint, int row) const;
    Vector row_of_body(std::size_t joint, int row, bool of_b) const;

    /// Solves the tree: right side rhs_ by row, impulses given in pushed_; changes of velocities to change_,
    /// impulses to answer_.
    void solve_tree();
    void solve_all();
    static constexpr double kUnbounded = 1e301;  // bound of an impulse: none

    void part_motors_from_limits();
    void find_displacements(double share);
    double find_small_displacements(double share, double most, double length);
    double displacement_of(const Link& link, double length) const;
    double farthest_displacement(double length) const;
    void press_loads();
    void displace(double share);
    void measure_values();
    void measure_anew();
    bool correct_once(double least, double length);
    double sum_of_errors() const;

    /// A loop that is taut in one direction among the rows of its last joint, and how far.
    struct TautLoop {
        std::size_t first, rows;  // of extras_, at most two
        std::array<double, 2> direction;
        double share;     // of it that is a spring: 1 where it is straight, 0 where it is not taut
        double softness;  // 1/kg, of the spring
    };
    void soften_taut_loops();
    /// Calls fn(extra row) and sums along the direction of a taut loop.
    template <class Fn>
    static double along(const TautLoop& loop, const Fn& fn) {
        double sum = 0;
        for (std::size_t k = 0; k < loop.rows; ++k) sum += loop.direction[k] * fn(loop.first + k);
        return sum;
    }
    /// What a row of a loop gave in the whole substep before [N s].
    double& pulled_of(const Extra& extra) {
        return pulled_[static_cast<std::size_t>(extra.joint)][row_of(extra).slot];
    }
    const JointRow& row_of(const Extra& extra) const {
        return rows_[static_cast<std::size_t>(extra.joint)].row[static_cast<std::size_t>(extra.row)];
    }

    void list_extras();
    void couple_extras();
    void list_parts();
    void find_columns();
    void push_row(std::size_t extra, double impulse);
    /// Calls fn(body, its part of a row): for both bodies of a joint, up to four of a gear.
    template <class Fn>
    void for_each_part(std::size_t joint, int row, const Fn& fn) const;
    void measure_gear(Gear& gear);
    template <class PoseOf>
    double value_of_gear(const Gear& gear, const PoseOf& pose_of) const;
    /// The parts of an extra row.
    std::span<const RowPart> parts_of(std::size_t extra) const {
        return std::span(parts_).subspan(first_part_[extra], first_part_[extra + 1] - first_part_[extra]);
    }
    double change_of_row(std::size_t extra) const;
    /// What for: which rows are free differs.
    enum class Use : std::uint8_t { solve, answer };
    void solve_bounded(Use use);
    bool change_ends(bool all);
    bool follow_curves(int rounds, double least);
    void follow_tangents();
    void take_back_gain(double before);
    void recall_extras();
    void list_driven(std::vector<std::array<double, 2>>& driven) const;
    double driven_work();
    double kinetic_energy() const;
    template <class Fn>
    double energy_of_taut_loops(const Fn& pull_of) const;
    void limit_pulls();
    void hold_what_was_taken(double before);
    void solve_free(Use use);
    const Factors& factor_free(Use use);
    void filter(const Factors& factors, std::vector<double>& x, std::size_t sides);
    bool holds(std::size_t extra, Drives drives) const;
    void find_right_sides(bool is_curved);
    void move_poses();
    void take_velocities();
    double largest_right_side() const;
    void keep_velocities();
    void restore_velocities();
    static Vec2 impulse_on_b(const JointRows& rows, const std::array<double, 3>& impulse);
    void add_force(std::size_t joint, const JointRow& row, double impulse);

    std::vector<Link> links_;          // parents before children
    std::vector<std::int32_t> loops_;  // joints that are no part of the tree
    std::vector<Gear> gears_;
    std::size_t loop_rows_ = 0, drive_rows_ = 0;
    bool closes_loops_ = false;  // whether any of them is no gear
    bool has_springs_ = false;
    double h_ = 0;          // s
    double until_end_ = 0;  // s
    Part part_ = Part::whole;
    bool is_rigid_ = false;
    double largest_error_ = 0;
    std::vector<TautLoop> taut_;
    double held_ = 0;             // J, what they have taken from motion and may give back
    double held_before_ = 0;      // J, likewise at `prepare`
    std::vector<Vector> pulled_;  // N s, by joint and slot, of loops: in the whole substep before

    std::vector<JointRows> rows_;                                 // by joint
    std::vector<std::array<double, JointRows::kMost>> softness_;  // by joint and row: S, and alpha C m
    std::vector<std::array<double, JointRows::kMost>> pull_;
    std::vector<JointPose> moved_;                         // by body: where its velocity takes it
    std::vector<Symmetric> inertia_;                       // by body
    std::vector<Vector> pushed_, change_;                  // by body
    std::vector<Vector> rhs_, answer_;                     // by joint: of its firm rows
    std::vector<Vector> kept_velocities_, kept_impulses_;  // before a solve
    std::vector<Extra> kept_extras_;
    std::vector<std::array<double, 2>> driven_, driven_before_;
    std::vector<Extra> extras_;
    std::vector<double> extra_rhs_, low_, high_;  // by extra row
    std::vector<RowPart> parts_;                  // of extra rows
    std::vector<std::size_t> first_part_;         // by extra row, and the end
    Sides columns_;                               // by extra row: changes of velocities by an impulse of 1
    Sides answers_;                               // find_answers
    std::vector<std::size_t> asked_;              // bodies for which they hold
    std::vector<double> held_back_;               // [free rows][sides]
    std::vector<double> half_way_;                // [links][3][sides]
    std::vector<double> alone_;                   // by extra row: its diagonal, were it the only one
    std::vector<double> matrix_, solution_, residual_;
    std::vector<double> unfiltered_;
    std::array<Factors, 2> factors_;  // by use
    std::vector<End> state_;          // by extra row
    std::vector<double> stiffness_;   // by body: sum of arm · impulse, m N s
    std::vector<double> weight_;      // by body: how many times as heavy it counts; 1 but in corrections
    bool is_weighted_ = false;        // whether it is factored so
    std::vector<std::size_t> free_;
    std::vector<std::size_t> answered_with_;   // rows that held in the last find_answers
    std::vector<JointPose> kept_poses_;        // by body: before a correction
    CoupledImpulses pushes_;                   // of loads
    std::vector<Vector> alone_displacements_;  // by body: without them
    std::vector<Blow> blows_;                  // of all of them
    std::vector<std::size_t> loaded_;          // bodies that they press on
    std::vector<End> kept_state_;              // by extra row: before a blow is answered
    CycleFinder<std::vector<End>> cycle_;      // of state_
};

template <class Fn>
void JointSystem::for_each_part(std::size_t joint, int row, const Fn& fn) const {
    const Member& member = joints[joint];
    if (member.gear < 0) {
        fn(static_cast<std::size_t>(member.a), row_of_body(joint, row, false));
        fn(static_cast<std::size_t>(member.b), row_of_body(joint, row, true));
        return;
    }
    const auto& [first, second] = gears_[static_cast<std::size_t>(member.gear)].coordinates;
    for (const auto& [of, by] : {std::pair{&first, -member.joint->ratio}, std::pair{&second, 1.0}}) {
        const JointRow& r = of->row;
        fn(static_cast<std::size_t>(of->a), Vector{-by * r.n.x, -by * r.n.y, -by * r.ja});
        fn(static_cast<std::size_t>(of->b), Vector{by * r.n.x, by * r.n.y, by * r.jb});
    }
}

}  // namespace carom
