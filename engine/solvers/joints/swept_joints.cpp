#include "solvers/joints/swept_joints.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace carom {
namespace {

/// The largest mass that a swept joint is taken to swing, in reduced masses of its own two bodies: 64 like
/// bodies, or four of 16 times the mass, the largest ratio in a crowd.
constexpr double kBodiesOfBend = 64;
/// Factor by which the first sweep over rods goes farther. Hinges take 1: more pumps energy into them.
constexpr double kOverRelaxation = 1.3;

// ns that a sweep over a joint takes on one thread, for the executor:
// docs/decisions/0090-crowds-of-mechanisms.md.
constexpr double kNanosecondsToSweep = 5, kNanosecondsToSweepInBundle = 2;
static_assert(kJointBlock == kRowPadding);

/// Hinges that are open by more than this share of a limb, which is from the centre of a body to the hinge
/// and on to the centre of the other one, are closed up to a smaller share of it, in rounds of which each
/// closes a gap in first order of the turn that it takes. docs/decisions/0092-gaps-in-heaps.md.
constexpr double kOpen = 0.018;
constexpr double kLeftOpen = 0.016;
constexpr int kMostRoundsOfClosing = 3;
constexpr double kNanosecondsToClose = 1;  // a part of a joint, on one thread, for the executor

}  // namespace

template <class Real>
bool SweptJoints<Real>::knows(const StoredJoint& joint) {
    return joint.type != JointType::target && joint.type != JointType::gear;
}

template <class Real>
std::size_t SweptJoints<Real>::kind_of(const StoredJoint& joint) {
    if (joint.type == JointType::prismatic || joint.type == JointType::wheel) return kAxles;
    if (joint.type != JointType::distance) return kHinges;
    if (joint.is_spring() || joint.has_lower || joint.has_upper) return kSprings;
    const bool has_arms = joint.anchor_b != Vec2{} || (!joint.is_on_world() && joint.anchor_a != Vec2{});
    return has_arms ? kRodsOfAnchors : kRods;
}

template <class Real>
bool SweptJoints<Real>::has_angle_part(const StoredJoint& joint) {
    return law_of_angle(joint).acts();
}

template <class Real>
DriveLaw SweptJoints<Real>::law_of(const StoredJoint& joint, std::size_t kind) {
    return kind == kAngles ? law_of_angle(joint) : law_of_way(joint);
}

template <class Real>
unsigned SweptJoints<Real>::needs_of(std::size_t kind) {
    constexpr unsigned kNeeds[kKinds] = {kPoints,
                                         kPoints | kArms | kRims,
                                         kPoints | kArms | kRims,
                                         kPoints | kArms | kRims | kDrives,
                                         kPoints | kArms | kRims | kDrives | kAxes,
                                         kRims | kDrives};
    return kNeeds[kind];
}

template <class Real>
template <class Fn>
void SweptJoints<Real>::Kind::for_each_column(const Fn& fn) {
    for (Column<Real>* column : {&start_x, &impulse_x, &impulse_y}) fn(*column, 0u);
    for (Column<Real>* column : {&start_y, &length, &normal_x, &normal_y, &per_length})
        fn(*column, unsigned{kPoints});
    for (Column<Real>* column : {&start_arm_a_x, &start_arm_a_y, &start_arm_b_x, &start_arm_b_y, &arm_a_x,
                                 &arm_a_y, &arm_b_x, &arm_b_y})
        fn(*column, unsigned{kArms});
    for (Column<Real>* column : {&per_rim_a, &per_rim_b, &seen_a, &seen_b}) fn(*column, unsigned{kRims});
    for (Column<Real>* column : {&impulse_z, &impulse_w, &value, &alpha, &gamma, &lower, &upper, &lower_rate,
                                 &upper_rate, &speed, &most})
        fn(*column, unsigned{kDrives});
    for (Column<Real>* column : {&axis_x, &axis_y, &across}) fn(*column, unsigned{kAxes});
}

template <class Real>
void SweptJoints<Real>::Kind::resize(std::size_t places, unsigned needs) {
    a.resize(places), b.resize(places), slot.resize(places), order.resize(places / kJointBlock);
    for_each_column([&](Column<Real>& column, unsigned bit) {
        column.clear();
        column.resize((needs & bit) == bit ? places : 0);
    });
}

template <class Real>
JointColumns<Real> SweptJoints<Real>::Kind::columns() {
    return {a.data(),
            b.data(),
            order.data(),
            start_x.data(),
            start_y.data(),
            length.data(),
            impulse_x.data(),
            impulse_y.data(),
            normal_x.data(),
            normal_y.data(),
            per_length.data(),
            start_arm_a_x.data(),
            start_arm_a_y.data(),
            start_arm_b_x.data(),
            start_arm_b_y.data(),
            arm_a_x.data(),
            arm_a_y.data(),
            arm_b_x.data(),
            arm_b_y.data(),
            per_rim_a.data(),
            per_rim_b.data(),
            seen_a.data(),
            seen_b.data(),
            impulse_z.data(),
            impulse_w.data(),
            value.data(),
            alpha.data(),
            gamma.data(),
            lower.data(),
            upper.data(),
            lower_rate.data(),
            upper_rate.data(),
            speed.data(),
            most.data(),
            axis_x.data(),
            axis_y.data(),
            across.data()};
}

template <class Real>
Real* SweptJoints<Real>::turn_of(BodyRecords<Real>& records) {
    if (Real* const turn = records.turn()) return turn;
    no_turn_.resize(padded(records.rows()));
    return no_turn_.data();
}

template <class Real>
void SweptJoints<Real>::run_group(std::size_t group, Kernel kernel) const {
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        const std::size_t first = kinds_[kind].begin[group], last = kinds_[kind].begin[group + 1];
        if (first == last) continue;
        SweepJoints<Real> k = arguments_[kind];
        k.over_relaxation =
            static_cast<Real>(kind >= kHinges || kernel == Kernel::last ? 1 : kOverRelaxation);
        const JointKernels<Real>& kernels = kernels_->joints[kind];
        const auto run = kernel == Kernel::give    ? kernels.give
                         : kernel == Kernel::first ? kernels.first
                                                   : kernels.next;
        run(k, first, last);
    }
}

/// What a sweep over the joints of a kind has that are in bundles.
template <class Real>
SweepJoints<Real> SweptJoints<Real>::of_bundles(std::size_t kind) const {
    SweepJoints<Real> sweep = arguments_[kind];
    sweep.joints.a = kinds_[kind].of_bundle_a.data(), sweep.joints.b = kinds_[kind].of_bundle_b.data();
    sweep.over_relaxation = Real(1);
    return sweep;
}

/// Bundles share no bodies, neither with each other nor with joints that are in none.
template <class Real>
void SweptJoints<Real>::sweep_bundles(const StepLoops<Real>& loops, Begin begin) const {
    SweepBundles<Real> k{};
    k.hinges = of_bundles(kHinges), k.angles = of_bundles(kAngles);
    k.bundles = bundles_.bundles.data(), k.rows = bundles_.rows.data();
    k.gives = begin == Begin::step, k.begins = begin != Begin::nothing;
    const double work = kNanosecondsToSweepInBundle * static_cast<double>(parts_of_joints_) * 2;
    loops.executor->for_each_task(bundles_.bundles.size(), work, [&](std::size_t bundle) {
        loops.kernels->sweep_bundles(k, bundle, bundle + 1);
    });
}

template <class Real>
double SweptJoints<Real>::close_gaps(const JointStep<Real>& step, const StepLoops<Real>& loops) {
    if (bundles_.branches.empty() || !step.records.turn()) return 0;
    CloseBundles<Real> k{};
    k.hinges = of_bundles(kHinges), k.angles = of_bundles(kAngles).joints;
    k.bundles = bundles_.bundles.data(), k.rows = bundles_.rows.data();
    k.branches = bundles_.branches.data();
    k.open = static_cast<Real>(kOpen), k.left = static_cast<Real>(kLeftOpen), k.rounds = kMostRoundsOfClosing;
    closed_.resize(bundles_.bundles.size());
    loops.executor->for_each_task(
        bundles_.bundles.size(), kNanosecondsToClose * static_cast<double>(parts_of_joints_),
        [&](std::size_t bundle) { closed_[bundle] = loops.kernels->close_bundles(k, bundle, bundle + 1); });
    std::size_t closed = 0, trees = 0;
    for (std::size_t i = 0; i < closed_.size(); ++i) {
        closed += closed_[i];
        if (bundles_.bundles[i].branches > 0) trees += bundles_.bundles[i].mechanisms;
    }
    return static_cast<double>(closed) / static_cast<double>(trees);
}

template <class Real>
void SweptJoints<Real>::sweep(const JointStep<Real>& step, const StepLoops<Real>& loops, Begin begin) {
    for (SweepJoints<Real>& k : arguments_) {
        k.velocity = step.records.velocity.data(), k.displacement = step.records.displacement.data();
        k.turn = turn_of(step.records);
        k.until_end = static_cast<Real>(step.terms.until_end()), k.ends_move = ends_move_;
    }
    if (!bundles_.empty()) sweep_bundles(loops, begin);
    if (!has_joints_of_groups_) return;
    bool any_far = false;
    for (const Kind& kind : kinds_)
        any_far |= groups_.chunks > 1 && kind.begin[groups_.far()] < kind.begin[groups_.far() + 1];
    phases_.clear(), parts_.clear();
    const auto add_sweep = [&](Kernel kernel) {
        const auto add = [&](Part part, PhaseKind phase) {
            parts_.push_back({kernel, part}), phases_.push_back(phase);
        };
        add(Part::chunks, PhaseKind::side_by_side);
        if (any_far) add(Part::far, PhaseKind::alone);
        add(Part::borders, PhaseKind::side_by_side);
    };
    if (begin == Begin::step) add_sweep(Kernel::give);
    add_sweep(begin == Begin::nothing ? Kernel::next : Kernel::first);
    add_sweep(Kernel::last);
    const double work = kNanosecondsToSweep * static_cast<double>(parts_of_joints_) * 2;
    loops.executor->for_each_phase(phases_, groups_.tasks(), work, [&](std::size_t phase, std::size_t task) {
        const auto [kernel, part] = parts_[phase];
        const std::size_t chunk = 2 * task;
        if (part == Part::far) return run_group(groups_.far(), kernel);
        if (part == Part::borders) {
            if (chunk > 0 && groups_.has_border(chunk - 1)) run_group(TaskGroups::across(chunk - 1), kernel);
            return;
        }
        if (chunk >= groups_.chunks) return;
        run_group(TaskGroups::inside(chunk), kernel);
        if (!groups_.has_border(chunk)) return;
        run_group(TaskGroups::across(chunk), kernel);
        run_group(TaskGroups::inside(chunk + 1), kernel);
    });
}

/// What the spring, the motor and the ends of a joint may have given: the motor its impulse times the mean
/// rate of the length or angle, an end that moves its own times its rate, the spring only that part of its
/// impulse that pulls it to its rest, for the rest of it damps (constraints/joints/spring_law.hpp).
template <class Real>
double SweptJoints<Real>::work_of_drive(const JointStep<Real>& step, std::size_t kind, std::size_t i) const {
    const Kind& own = kinds_[kind];
    if ((needs_of(kind) & kDrives) == 0) return 0;
    if (own.impulse_x[i] == 0 && own.impulse_y[i] == 0 && !ends_move_) return 0;
    const bool has_arms = kind != kAngles;
    struct End {
        double rate;          // m/s or rad/s, mean of the substep
        double inverse_mass;  // 1/kg or 1/(kg m²), along the coordinate
    };
    const auto end_of = [&](std::int32_t number, Vec2 arm, double per_rim, double seen) -> End {
        if (number >= first_beyond_) return {};
        const Real* record = &step.records.velocity[4 * static_cast<std::size_t>(number)];
        const auto [x, y, rim] = step.records.free_flight(number, step.terms);
        const double turning = 2 * std::fmax(static_cast<double>(record[3]), 0) * per_rim * per_rim * seen,
                     spin = turning > 0 ? 0.5 * per_rim * seen * (rim + static_cast<double>(record[2])) : 0;
        if (!has_arms) return {spin, turning};
        const Vec2 normal{own.normal_x[i], own.normal_y[i]};
        const double lever = cross(arm, normal);
        return {0.5 * dot(normal, Vec2{x, y} + Vec2{record[0], record[1]}) + spin * lever,
                std::fabs(static_cast<double>(record[3])) + turning * lever * lever};
    };
    const Vec2 arm_a = has_arms ? Vec2{own.arm_a_x[i], own.arm_a_y[i]} : Vec2{},
               arm_b = has_arms ? Vec2{own.arm_b_x[i], own.arm_b_y[i]} : Vec2{};
    const End a = end_of(own.a[i], arm_a, own.per_rim_a[i], own.seen_a[i]),
              b = end_of(own.b[i], arm_b, own.per_rim_b[i], own.seen_b[i]);
    const double inverse = a.inverse_mass + b.inverse_mass, rest = has_arms ? own.length[i] : Real(0),
                 off = static_cast<double>(own.value[i]) - rest,
                 pull = inverse > 0 ? -static_cast<double>(own.alpha[i]) * off / inverse : 0;
    const double of_ends = static_cast<double>(own.impulse_z[i]) * static_cast<double>(own.lower_rate[i]) +
                           static_cast<double>(own.impulse_w[i]) * static_cast<double>(own.upper_rate[i]);
    return (pull + static_cast<double>(own.impulse_y[i])) * (b.rate - a.rate) + of_ends;
}

/// A body goes straight on while it turns, and a joint brings it back to its curved path: it is asked for the
/// velocity v that a substep's path bends by (kernels/joints/sweep_joints.hpp), and its impulse l then does
/// the work l v on top of what a joint along a straight path would take. What l is to give its bodies v is
/// worth v² times the mass that moves; joints that press against contacts have l of any size, which gives
/// bodies no v and no reason to gain.
template <class Real>
double SweptJoints<Real>::work_of_bend(const JointStep<Real>& step, std::size_t kind, std::size_t i) const {
    const Kind& own = kinds_[kind];
    if (kind == kAngles) return 0;
    const Vec2 impulse = impulse_on_b(own, i, kind);
    if (impulse == Vec2{}) return 0;
    const double h = step.terms.substep_dt;
    const bool has_arms = kind != kRods;
    // rad/s · rad, with the bounds of the kernels
    const auto bend_at = [&](double spin) {
        return std::fabs(spin) * std::fmin(h * std::fabs(spin), kMostBend);
    };
    struct End {
        Vec2 velocity, bend;  // m/s, of the anchor
        double inverse_mass;  // 1/kg, of the body
    };
    const auto end_of = [&](std::int32_t number, Vec2 arm, double per_rim) -> End {
        const Real* record = &step.records.velocity[4 * static_cast<std::size_t>(number)];
        const double spin = per_rim * static_cast<double>(record[2]),
                     strain = 4 * h * std::fabs(dot(arm, impulse)) * 2 * per_rim * per_rim *
                              std::fmax(static_cast<double>(record[3]), 0),
                     share = 1 / (1 + strain * strain);
        return {Vec2{record[0], record[1]} + spin * Vec2{-arm.y, arm.x}, (-0.5 * share * bend_at(spin)) * arm,
                std::fabs(static_cast<double>(record[3]))};
    };
    const End a = has_arms ? end_of(own.a[i], {own.arm_a_x[i], own.arm_a_y[i]}, own.per_rim_a[i])
                           : end_of(own.a[i], {}, 0),
              b = has_arms ? end_of(own.b[i], {own.arm_b_x[i], own.arm_b_y[i]}, own.per_rim_b[i])
                           : end_of(own.b[i], {}, 0);
    Vec2 bend = b.bend - a.bend;
    if (own.per_length[i] > 0) {
        const Vec2 normal{own.normal_x[i], own.normal_y[i]};
        const double across = cross(normal, b.velocity - a.velocity), per_length = own.per_length[i];
        bend += (0.5 * bend_at(across * per_length) / per_length) * normal;
    }
    if (kind == kAxles) {
        const Vec2 axis{own.normal_x[i], own.normal_y[i]};
        const double spin = static_cast<double>(own.per_rim_a[i]) *
                            static_cast<double>(
                                step.records.velocity[4 * static_cast<std::size_t>(own.a[i]) + 2]),
                     led = std::clamp(h * spin, -kMostBend, kMostBend) * dot(axis, b.velocity - a.velocity);
        bend += led * Vec2{axis.y, -axis.x};
    }
    const double most = kBodiesOfBend * length_squared(bend) / (a.inverse_mass + b.inverse_mass);
    return std::clamp(-dot(impulse, bend), -most, most);
}

template <class Real>
void SweptJoints<Real>::book(const JointStep<Real>& step, Books& books) const {
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        const Kind& own = kinds_[kind];
        for (std::size_t i = 0; i < own.slot.size(); ++i) {
            if (own.slot[i] < 0) continue;
            if (kind == kAngles) {
                for (const auto& [number, per_rim, sign] :
                     {std::tuple{own.a[i], own.per_rim_a[i] * own.seen_a[i], -0.5},
                      std::tuple{own.b[i], own.per_rim_b[i] * own.seen_b[i], 0.5}}) {
                    const Real* record = &step.records.velocity[4 * static_cast<std::size_t>(number)];
                    if (number >= first_beyond_ || !(record[3] > Real(0))) continue;
                    books.joints +=
                        sign * sum_of_impulses(own, i) * static_cast<double>(per_rim) *
                        (step.records.start_of_substep(number)[2] + static_cast<double>(record[2]));
                }
                continue;
            }
            const Vec2 j = impulse_on_b(own, i, kind);
            const auto work_on = [&](std::int32_t number, Vec2 impulse, Vec2 arm, double per_rim) {
                if (number >= first_beyond_) return -1 * impulse;
                const auto row = static_cast<std::size_t>(number);
                const Real* record = &step.records.velocity[4 * row];
                const auto [x, y, rim] = step.records.start_of_substep(number);
                books.joints += 0.5 * dot(impulse, Vec2{x, y} + Vec2{record[0], record[1]});
                if (record[3] > Real(0))
                    books.joints +=
                        0.5 * per_rim * cross(arm, impulse) * (rim + static_cast<double>(record[2]));
                return Vec2{};
            };
            const bool has_arms = kind != kRods;
            const Vec2 arm_a = has_arms ? Vec2{own.arm_a_x[i], own.arm_a_y[i]} : Vec2{},
                       arm_b = has_arms ? Vec2{own.arm_b_x[i], own.arm_b_y[i]} : Vec2{};
            books.immovable_momentum -=
                work_on(own.a[i], -1 * j, arm_a, has_arms ? own.per_rim_a[i] * own.seen_a[i] : 0);
            books.immovable_momentum -=
                work_on(own.b[i], j, arm_b, has_arms ? own.per_rim_b[i] * own.seen_b[i] : 0);
        }
    }
}

template <class Real>
std::size_t SweptJoints<Real>::bytes() const {
    std::size_t bytes = no_turn_.bytes() + stiffness_.bytes() + breakable_.capacity() * sizeof(Breakable) +
                        moments_.capacity() * sizeof(Moments) + bundles_.bytes() +
                        inertia_of_bundles_.bytes() + longest_of_bundle_.bytes() + hung_x_.bytes() +
                        hung_y_.bytes();
    for (const Kind& kind : kinds_) {
        bytes += kind.a.bytes() + kind.b.bytes() + kind.slot.bytes() + kind.order.bytes() +
                 kind.of_bundle_a.bytes() + kind.of_bundle_b.bytes() +
                 kind.sources.capacity() * sizeof(typename Kind::Source) +
                 kind.drives.capacity() * sizeof(typename Kind::Drive);
        for (const Column<double>* column :
             {&kind.anchor_a_x, &kind.anchor_a_y, &kind.anchor_b_x, &kind.anchor_b_y, &kind.angle_at_zero})
            bytes += column->bytes();
        const_cast<Kind&>(kind).for_each_column(
            [&](Column<Real>& column, unsigned) { bytes += column.bytes(); });
    }
    return bytes;
}

template class SweptJoints<float>;
template class SweptJoints<double>;

}  // namespace carom
