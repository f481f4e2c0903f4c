#include <algorithm>
#include <array>
#include <cmath>

#include "constraints/joints/spring_law.hpp"
#include "solvers/joints/swept_joints.hpp"

// What swept joints are at the start of a step, and what they leave at its end.

namespace carom {
namespace {

/// Share of an error that a substep takes away, by displacement.
constexpr double kRecovery = 0.4;
/// Largest such correction: in lengths of a rod, in arms of a hinge.
constexpr double kLargestCorrection = 1;
/// Likewise of an angle [rad].
constexpr double kLargestTurn = 0.5;
/// In place of an end that there is not: its impulse stays 0, and what is computed with it finite.
constexpr double kNoEnd = 1e30;

// For the executor: places of a task, and ns a joint on one thread.
constexpr std::size_t kPlacesPerTask = 1024;
constexpr double kNanosecondsToBegin = 5, kNanosecondsToStore = 8;

/// The angle of a body, or of the world [rad].
/// @param row  below 0: of the world
template <class Real>
double angle_of(const Bodies<Real>& bodies, std::int32_t row) {
    return row >= 0 && bodies.has_rotation ? static_cast<double>(bodies.angle[static_cast<std::size_t>(row)])
                                           : 0;
}

}  // namespace

template <class Real>
void SweptJoints<Real>::begin_step(const JointStep<Real>& step, const StepLoops<Real>& loops) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    const auto for_each_task = [&](std::size_t kind, const auto& fn) {
        loops.executor->for_each_chunk(
            places_before_bundles(kind), kPlacesPerTask, kNanosecondsToBegin,
            [&](std::size_t, std::size_t first, std::size_t last) { fn(first, last); });
    };
    const double h = step.terms.substep_dt;
    kernels_ = loops.kernels;
    ends_move_ = step.world.joints.may_move_limits();
    for (Breakable& joint : breakable_) joint.force = {}, joint.torque = 0;
    keeps_drives_ =
        is_loaded_ && !has_springs_ && settings_ == step.world.joints.settings && substep_of_drives_ == h;
    settings_ = ends_move_ ? -1 : step.world.joints.settings, substep_of_drives_ = h;
    if (!is_loaded_) load(step.world);
    longest_ = 0;  // a state that is restored knows nothing of how arms were turned before
    arguments_.assign(kKinds, {});
    stiffness_.begin(static_cast<std::size_t>(first_beyond_));
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        Kind& own = kinds_[kind];
        moments_.resize(std::max(moments_.size(), places_before_bundles(kind)));
        for_each_task(kind, [&](std::size_t first, std::size_t last) {
            if (kind == kRods) return begin_rods(step, own, first, last);
            begin_joints(step, own, kind, first, last);
        });
        if ((needs_of(kind) & kArms) != 0) add_stiffness(own, places_before_bundles(kind));
        SweepJoints<Real>& k = arguments_[kind];
        k.joints = own.columns();
        k.velocity = step.records.velocity.data(), k.displacement = step.records.displacement.data();
        k.turn = turn_of(step.records);
        k.h = real(h), k.half_h = real(h / 2), k.per_h = real(1 / h);
        k.recovery = real(kRecovery);
        k.has_springs = has_springs_, k.has_motors = has_motors_;
    }
    if (!bundles_.empty()) begin_bundles(step, loops);
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        Kind& own = kinds_[kind];
        arguments_[kind].most = real(kind == kHinges || kind == kAxles ? kLargestCorrection * longest_
                                     : kind == kAngles                 ? kLargestTurn
                                                                       : kLargestCorrection);
        if (own.seen_a.empty()) continue;
        const auto seen = [&](std::int32_t row) { return real(stiffness_.seen(step.world.bodies, row, h)); };
        for_each_task(kind, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                own.seen_a[i] = seen(own.a[i]), own.seen_b[i] = seen(own.b[i]);
        });
    }
}

/// Joints of crowds, and what drives them.
template <class Real>
void SweptJoints<Real>::begin_bundles(const JointStep<Real>& step, const StepLoops<Real>& loops) {
    const Bodies<Real>& bodies = step.world.bodies;
    Kind &hinges = kinds_[kHinges], &angles = kinds_[kAngles];
    longest_of_bundle_.resize(bundles_.bundles.size());
    BeginBundles<Real> k{};
    const auto of_bundles = [](Kind& own) {
        JointColumns<Real> columns = own.columns();
        columns.a = own.of_bundle_a.data(), columns.b = own.of_bundle_b.data();
        return columns;
    };
    k.hinges = of_bundles(hinges), k.angles = of_bundles(angles);
    k.bundles = bundles_.bundles.data(), k.rows = bundles_.rows.data();
    k.position_x = bodies.position_x.data(), k.position_y = bodies.position_y.data();
    k.angle = bodies.has_rotation ? bodies.angle.data() : nullptr;
    k.hung_x = hung_x_.data(), k.hung_y = hung_y_.data();
    k.inertia = inertia_of_bundles_.data();
    k.anchor_a_x = hinges.anchor_a_x.data(), k.anchor_a_y = hinges.anchor_a_y.data();
    k.anchor_b_x = hinges.anchor_b_x.data(), k.anchor_b_y = hinges.anchor_b_y.data();
    k.angle_at_zero = angles.angle_at_zero.data();
    k.least_inertia = JointStiffness::kStiffness * step.terms.substep_dt;
    k.longest = longest_of_bundle_.data();
    loops.executor->for_each_task(bundles_.bundles.size(),
                                  kNanosecondsToBegin * static_cast<double>(parts_of_joints_),
                                  [&](std::size_t number) {
                                      loops.kernels->begin_bundles(k, number, number + 1);
                                      const JointBundle& bundle = bundles_.bundles[number];
                                      for (std::size_t i = 0; i < kJointBlock * bundle.angles; ++i)
                                          if (angles.slot[bundle.first_angle + i] >= 0)
                                              begin_drive(step, angles, kAngles, bundle.first_angle + i);
                                  });
    for (const double longest : longest_of_bundle_)
        longest_ = std::max(longest_, static_cast<double>(static_cast<Real>(longest)));
}

/// Does what begin_joint does for rods between centres, without a look at their sources where both bodies
/// move: the difference of two floats has the same bits in both precisions.
template <class Real>
void SweptJoints<Real>::begin_rods(const JointStep<Real>& step, Kind& own, std::size_t first,
                                   std::size_t last) {
    const Real *x = step.world.bodies.position_x.data(), *y = step.world.bodies.position_y.data();
    const std::int32_t *a = own.a.data(), *b = own.b.data(), beyond = first_beyond_;
    Real *start_x = own.start_x.data(), *start_y = own.start_y.data();
    for (std::size_t i = first; i < last; ++i) {
        if (a[i] < beyond && b[i] < beyond)
            start_x[i] = x[b[i]] - x[a[i]], start_y[i] = y[b[i]] - y[a[i]];
        else if (own.slot[i] >= 0)
            begin_joint(step, own, kRods, i,
                        {rotation_by(angle_of(step.world.bodies, own.sources[i].row_a)),
                         rotation_by(angle_of(step.world.bodies, own.sources[i].row_b))});
    }
}

/// The joints of some places, their bodies' cosines and sines by lanes.
template <class Real>
void SweptJoints<Real>::begin_joints(const JointStep<Real>& step, Kind& own, std::size_t kind,
                                     std::size_t first, std::size_t last) {
    const Bodies<Real>& bodies = step.world.bodies;
    constexpr std::size_t kJointsOfBlock = kAnglesOfBlock / 2;
    alignas(64) std::array<double, kAnglesOfBlock> angles{}, cosines, sines;
    cosines.fill(1), sines.fill(0);
    for (std::size_t begin = first; begin < last; begin += kJointsOfBlock) {
        const std::size_t end = std::min(last, begin + kJointsOfBlock);
        if (kind != kAngles && bodies.has_rotation) {
            for (std::size_t i = begin; i < end; ++i) {
                if (own.slot[i] < 0) continue;
                angles[2 * (i - begin)] = angle_of(bodies, own.sources[i].row_a);
                angles[2 * (i - begin) + 1] = angle_of(bodies, own.sources[i].row_b);
            }
            kernels_->convex->turn_angles(angles.data(), cosines.data(), sines.data());
        }
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t a = 2 * (i - begin), b = a + 1;
            if (own.slot[i] >= 0)
                begin_joint(step, own, kind, i,
                            {Rotation{cosines[a], sines[a]}, Rotation{cosines[b], sines[b]}});
        }
    }
}

/// Where a joint is, and how it turns its bodies.
/// @param turns  of both bodies; of angles they are not asked for
template <class Real>
void SweptJoints<Real>::begin_joint(const JointStep<Real>& step, Kind& own, std::size_t kind, std::size_t i,
                                    const std::array<Rotation, 2>& turns) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    const Bodies<Real>& bodies = step.world.bodies;
    struct End {
        Vec2 place, arm;
        double per_rim, angle;
    };
    const auto end_of = [&](std::int32_t number, std::int32_t of, Vec2 anchor, const Rotation& turn) -> End {
        if (of < 0) return {anchor, {}, 0, 0};
        const auto row = static_cast<std::size_t>(of);
        End end{{bodies.position_x[row], bodies.position_y[row]}, {}, 0, 0};
        if (anchor == Vec2{} && (kind == kRods || kind == kRodsOfAnchors)) return end;
        end.angle = angle_of(bodies, of);
        end.per_rim = 1 / rim_of(bodies, row);
        if (kind != kAngles) end.arm = rotate(turn, anchor);
        if (number >= first_beyond_) end.place += end.arm, end.arm = {}, end.per_rim = 0;
        return end;
    };
    const typename Kind::Source& source = own.sources[i];
    const End a = end_of(own.a[i], source.row_a, source.anchor_a, turns[0]),
              b = end_of(own.b[i], source.row_b, source.anchor_b, turns[1]);
    if (!own.alpha.empty()) begin_drive(step, own, kind, i);
    if (kind == kAngles) {
        own.start_x[i] = real(b.angle - a.angle - source.angle);
        own.per_rim_a[i] = real(a.per_rim), own.per_rim_b[i] = real(b.per_rim);
        return;
    }
    own.start_x[i] = real(b.place.x - a.place.x), own.start_y[i] = real(b.place.y - a.place.y);
    if (kind == kRods) return;
    own.start_arm_a_x[i] = real(a.arm.x), own.start_arm_a_y[i] = real(a.arm.y);
    own.start_arm_b_x[i] = real(b.arm.x), own.start_arm_b_y[i] = real(b.arm.y);
    own.per_rim_a[i] = real(a.per_rim), own.per_rim_b[i] = real(b.per_rim);
    Vec2 pull{own.impulse_x[i], own.impulse_y[i]};  // N s, on b
    Vec2 arm_a = a.arm;
    const Vec2 between = (b.place + b.arm) - (a.place + a.arm);
    if (kind == kAxles) {
        const Vec2 axis = rotate(turns[0], source.axis);
        own.axis_x[i] = real(axis.x), own.axis_y[i] = real(axis.y);
        own.normal_x[i] = own.axis_x[i], own.normal_y[i] = own.axis_y[i];
        pull = impulse_on_b(own, i, kind), arm_a += between;
    } else if (kind != kHinges) {
        const double distance = std::sqrt(length_squared(between));
        const double along = gives_way(kind) ? sum_of_impulses(own, i) : pull.x;
        pull = distance > 0 ? (along / distance) * between : Vec2{};
    }
    moments_[i] = {-dot(arm_a, pull), dot(b.arm, pull)};
}

/// Adds up how joints with arms turn their bodies, in the order of their places, and notes the longest arm.
template <class Real>
void SweptJoints<Real>::add_stiffness(const Kind& own, std::size_t places) {
    for (std::size_t i = 0; i < places; ++i) {
        if (own.slot[i] < 0) continue;
        stiffness_.add(own.a[i], moments_[i].of_a), stiffness_.add(own.b[i], moments_[i].of_b);
        for (const Column<Real>* arm :
             {&own.start_arm_a_x, &own.start_arm_a_y, &own.start_arm_b_x, &own.start_arm_b_y})
            longest_ = std::max(longest_, static_cast<double>(std::fabs((*arm)[i])));
    }
}

/// What does not change from step to step, and the impulses of the last one.
template <class Real>
void SweptJoints<Real>::load(const WorldState<Real>& world) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    const auto row_of = [&](BodyId id) {
        return id == BodyId{} ? -1 : static_cast<std::int32_t>(world.handles.row_of_slot(id.index));
    };
    is_loaded_ = true, has_springs_ = has_motors_ = false;
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        Kind& own = kinds_[kind];
        own.sources.resize(own.slot.size());
        own.drives.assign((needs_of(kind) & kDrives) != 0 ? own.slot.size() : 0, {});
        for (std::size_t i = 0; i < own.slot.size(); ++i) {
            if (own.slot[i] < 0) continue;
            const StoredJoint& joint = world.joints[static_cast<std::size_t>(own.slot[i])];
            has_springs_ = has_springs_ || joint.is_spring();
            has_motors_ = has_motors_ || joint.has_motor;
            own.sources[i] = {row_of(joint.a), row_of(joint.b), joint.anchor_a,
                              joint.anchor_b,  joint.angle,     joint.axis};
            if ((needs_of(kind) & kPoints) != 0) own.length[i] = real(joint.length);
            if ((needs_of(kind) & kDrives) == 0)
                own.impulse_x[i] = real(joint.impulse[0]), own.impulse_y[i] = real(joint.impulse[1]);
            if (kind == kAxles) own.across[i] = real(joint.impulse[0]);
        }
    }
    load_bundles(world);
}

template <class Real>
void SweptJoints<Real>::load_bundles(const WorldState<Real>& world) {
    for (const std::size_t kind : {kHinges, kAngles}) {
        Kind& own = kinds_[kind];
        const std::size_t places = bundles_.empty() ? 0 : own.slot.size();
        // Anew from zero: lanes without a mechanism have no arms.
        const auto begin_column = [&](Column<double>& column, std::size_t of) {
            column.clear();
            column.resize(kind == of ? places : 0);
        };
        for (Column<double>* column : {&own.anchor_a_x, &own.anchor_a_y, &own.anchor_b_x, &own.anchor_b_y})
            begin_column(*column, kHinges);
        begin_column(own.angle_at_zero, kAngles);
        for (std::size_t i = places_before_bundles(kind); i < places; ++i) {
            if (own.slot[i] < 0) continue;
            const typename Kind::Source& source = own.sources[i];
            const auto per_rim = [&](std::int32_t row) {
                return row < 0 ? Real(0)
                               : static_cast<Real>(1 / rim_of(world.bodies, static_cast<std::size_t>(row)));
            };
            own.per_rim_a[i] = per_rim(source.row_a), own.per_rim_b[i] = per_rim(source.row_b);
            if (kind == kAngles) {
                own.angle_at_zero[i] = source.angle;
                continue;
            }
            // Where a mechanism hangs is the place of its body 0, which has no arms.
            const Vec2 anchor_a = source.row_a < 0 ? Vec2{} : source.anchor_a;
            own.anchor_a_x[i] = anchor_a.x, own.anchor_a_y[i] = anchor_a.y;
            own.anchor_b_x[i] = source.anchor_b.x, own.anchor_b_y[i] = source.anchor_b.y;
        }
    }
    hung_x_.resize(kJointBlock * bundles_.bundles.size()), hung_y_.resize(hung_x_.size());
    const Kind& hinges = kinds_[kHinges];
    for (std::size_t number = 0; number < bundles_.bundles.size(); ++number) {
        const JointBundle& bundle = bundles_.bundles[number];
        for (std::size_t i = 0; i < kJointBlock * bundle.hinges; ++i) {
            const std::size_t place = bundle.first_hinge + i,
                              of_hung = kJointBlock * number + i % kJointBlock;
            if (hinges.slot[place] < 0 || hinges.sources[place].row_a >= 0) continue;
            hung_x_[of_hung] = hinges.sources[place].anchor_a.x;
            hung_y_[of_hung] = hinges.sources[place].anchor_a.y;
        }
    }
    inertia_of_bundles_.resize(bundles_.rows.size());
    for (std::size_t i = 0; i < bundles_.rows.size(); ++i)
        inertia_of_bundles_[i] =
            bundles_.rows[i] < first_beyond_
                ? JointStiffness::inertia_of(world.bodies, static_cast<std::size_t>(bundles_.rows[i]))
                : 0;
}

/// What springs, drives and bounds a length or an angle. The store is looked at only if something may have
/// changed there: joints lie apart in it.
template <class Real>
void SweptJoints<Real>::begin_drive(const JointStep<Real>& step, Kind& own, std::size_t kind, std::size_t i) {
    if (keeps_drives_) return share_out(own, i, sum_of_impulses(own, i));
    const auto real = [](double value) { return static_cast<Real>(value); };
    const auto slot = static_cast<std::size_t>(own.slot[i]);
    const StoredJoint& joint = step.world.joints[slot];
    const double h = step.terms.substep_dt;
    // A spring that is too stiff for the substep holds as a rod does: as a spring it would close its gap by
    // velocities, and sweeps that have not converged make energy of that.
    const DriveLaw law = law_of(joint, kind);
    const bool is_stiff = law.springs && kTwoPi * joint.frequency * h > kStiffestAlone;
    const bool is_held = is_stiff || law.is_held;
    const double rest_at = kind == kSprings ? joint.length : 0;
    own.lower[i] = real(is_held ? rest_at : law.has_ends && joint.has_lower ? joint.lower.at : -kNoEnd);
    own.upper[i] = real(is_held ? rest_at : law.has_ends && joint.has_upper ? joint.upper.at : kNoEnd);
    own.lower_rate[i] = real(law.has_ends ? joint.lower.rate : 0);
    own.upper_rate[i] = real(law.has_ends ? joint.upper.rate : 0);
    const bool springs = law.springs && !is_stiff;
    SpringTerms terms;
    if (springs)
        terms =
            spring_terms(joint.frequency, joint.damping_ratio, h, step.springs.least_gamma_in_turns(slot));
    own.alpha[i] = real(terms.alpha), own.gamma[i] = real(terms.gamma);
    const double most = law.has_motor ? joint.max_motor * h : 0;
    own.speed[i] = real(joint.motor_speed), own.most[i] = real(most);
    own.drives[i] = {most, springs};
    share_out(own, i, joint.impulse[law.slot]);
}

/// Shares the sum of the impulses of a joint out, which is what the store keeps: a motor has as much of it as
/// it can, the rest is of the end that pushes that way.
template <class Real>
void SweptJoints<Real>::share_out(Kind& own, std::size_t i, double impulse) {
    const auto [most, springs] = own.drives[i];
    own.impulse_x[i] = static_cast<Real>(springs ? impulse : 0);
    if (springs) impulse = 0;
    const double of_motor = std::clamp(impulse, -most, most), of_end = impulse - of_motor;
    own.impulse_y[i] = static_cast<Real>(of_motor);
    own.impulse_z[i] = static_cast<Real>(std::fmax(of_end, 0));
    own.impulse_w[i] = static_cast<Real>(std::fmin(of_end, 0));
}

template <class Real>
void SweptJoints<Real>::note_forces() {
    for (Breakable& joint : breakable_) {
        const Kind& own = kinds_[joint.kind];
        if (joint.kind == kAngles)
            joint.torque += sum_of_impulses(own, joint.place);
        else
            joint.force += impulse_on_b(own, joint.place, joint.kind);
    }
}

/// Joints lie apart in memory, each in one place of a kind: but for its angle, which comes after its points.
template <class Real>
void SweptJoints<Real>::store(JointStore& joints, double substep_dt, double dt,
                              const Executor& executor) const {
    const auto store = [&](const Kind& own, std::size_t kind, std::size_t i) {
        if (own.slot[i] >= 0)
            store_joint(joints[static_cast<std::size_t>(own.slot[i])], own, kind, i, substep_dt);
    };
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        const Kind& own = kinds_[kind];
        executor.for_each_chunk(places_before_bundles(kind), kPlacesPerTask, kNanosecondsToStore,
                                [&](std::size_t, std::size_t first, std::size_t last) {
                                    for (std::size_t i = first; i < last; ++i) store(own, kind, i);
                                });
    }
    // The joints of a mechanism lie side by side, those of its neighbours do not.
    executor.for_each_task(
        bundles_.bundles.size(), kNanosecondsToStore * static_cast<double>(parts_of_joints_),
        [&](std::size_t number) {
            const JointBundle& bundle = bundles_.bundles[number];
            for (std::size_t lane = 0; lane < bundle.mechanisms; ++lane) {
                for (std::size_t j = 0; j < bundle.hinges; ++j)
                    store(kinds_[kHinges], kHinges, bundle.first_hinge + kJointBlock * j + lane);
                for (std::size_t j = 0; j < bundle.angles; ++j)
                    store(kinds_[kAngles], kAngles, bundle.first_angle + kJointBlock * j + lane);
            }
        });
    for (const Breakable& part : breakable_) {
        StoredJoint& joint = joints[static_cast<std::size_t>(kinds_[part.kind].slot[part.place])];
        if (part.kind == kAngles)
            joint.torque = part.torque / dt;
        else
            joint.force = (1 / dt) * part.force;
    }
}

template <class Real>
[[gnu::always_inline]] inline void SweptJoints<Real>::store_joint(StoredJoint& joint, const Kind& own,
                                                                  std::size_t kind, std::size_t i,
                                                                  double substep_dt) {
    if (kind == kAngles) {
        const double impulse = sum_of_impulses(own, i);
        joint.impulse[law_of_angle(joint).slot] = impulse;
        joint.torque = impulse / substep_dt;
        return;
    }
    joint.impulse = {own.impulse_x[i], own.impulse_y[i], 0};
    if (kind == kAxles) joint.impulse = {own.across[i], 0, 0};
    if (gives_way(kind)) joint.impulse[law_of_way(joint).slot] = sum_of_impulses(own, i);
    joint.force = (1 / substep_dt) * impulse_on_b(own, i, kind);
    joint.torque = 0;
}

template class SweptJoints<float>;
template class SweptJoints<double>;

}  // namespace carom
