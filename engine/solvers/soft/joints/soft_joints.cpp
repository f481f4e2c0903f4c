#include "solvers/soft/joints/soft_joints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/validation/wording.hpp"
#include "sleeping/islands.hpp"

namespace carom {
namespace {

/// Work of a substep on a joint that is solved exactly, on one thread: for the executor.
constexpr double kNanosecondsToSolve = 400;
/// A crowd: groups that could be swept as well as solved exactly, whose exact solve is at least so much work,
/// in DirectJoints::work: two ragdolls.
constexpr std::size_t kWorkOfCrowd = 200;
/// Joints of such a group at least, more where it hangs on what stands, so that a crowd of pendulums is none;
/// and the largest ratio of masses in it, and where it hangs of what may fall on it to its lightest body.
constexpr std::size_t kFewestJoints = 2;
constexpr std::size_t kFewestJointsOfHung = 4;
constexpr double kLargestMassRatio = 16;
/// Free trees that are a crowd under gravity, however little work they are, and one alone that is not small:
/// they will lie on something, and have no energy then that an exact solve would keep.
/// docs/decisions/0097-crowds-that-hang.md.
constexpr std::size_t kFewestFree = 2;
/// Groups that hang on what stands, below which these are of no crowd:
/// docs/decisions/0097-crowds-that-hang.md.
constexpr std::size_t kFewestHung = 4;
/// Joints of a group that is small, at most: each blow on it is answered by all of them (decision 0059).
constexpr std::size_t kMostJointsOfSmall = 16;
/// Share of a crowd that has open hinges where it is torn: docs/decisions/0092-gaps-in-heaps.md.
constexpr double kTorn = 0.05;

}  // namespace

template <class Real>
void SoftJoints<Real>::find_groups(const WorldState<Real>& world) {
    if (is_known_ && version_ == world.joints.version) return;
    is_known_ = true, version_ = world.joints.version;
    direct_.clear(), swept_groups_ = 0;
    const std::size_t rows = world.bodies.count;
    const auto row_of = [&](BodyId id) {
        return id == BodyId{} ? SIZE_MAX : std::size_t{world.handles.row_of_slot(id.index)};
    };
    const auto moves = [&](std::size_t row) { return row < rows && !world.bodies.is_immovable(row); };
    Islands islands;
    islands.reset(rows);
    struct Member {
        std::int32_t island;
        std::size_t slot;
    };
    std::vector<Member> members;
    joined_.clear(), joined_.resize(rows);
    breakable_.clear();
    world.joints.for_each([&](std::size_t slot, const StoredJoint& joint) {
        const std::size_t a = row_of(joint.a), b = row_of(joint.b);
        if (joint.may_break()) breakable_.push_back(slot);
        if (moves(a) && moves(b)) islands.join(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b));
    });
    world.joints.for_each([&](std::size_t slot, const StoredJoint& joint) {
        const std::size_t a = row_of(joint.a), b = row_of(joint.b);
        if (!moves(a) && !moves(b)) return;  // they sleep, or were quarantined
        for (const std::size_t row : {a, b})
            if (moves(row)) joined_[row] = Real(1);
        members.push_back({islands.island_of(static_cast<std::int32_t>(moves(a) ? a : b)), slot});
    });
    first_of_group_.resize(rows);
    for (std::size_t row = 0; row < rows; ++row)
        first_of_group_[row] =
            joined_[row] > Real(0) ? islands.island_of(static_cast<std::int32_t>(row)) : -1;
    // In the order of slots within a group, and groups by their first slot: rows do not bear on it.
    std::vector<std::size_t> first_slot(rows, SIZE_MAX);
    for (const Member& member : members)
        first_slot[static_cast<std::size_t>(member.island)] =
            std::min(first_slot[static_cast<std::size_t>(member.island)], member.slot);
    std::stable_sort(members.begin(), members.end(), [&](const Member& left, const Member& right) {
        const std::size_t of_left = first_slot[static_cast<std::size_t>(left.island)],
                          of_right = first_slot[static_cast<std::size_t>(right.island)];
        return of_left != of_right ? of_left < of_right : left.slot < right.slot;
    });
    std::vector<std::size_t> to_sweep, slots;
    /// A group that may be of a crowd.
    struct Candidate {
        std::size_t group;  // of direct_
        bool hangs;
        std::vector<std::size_t> slots;
    };
    std::vector<Candidate> crowd;
    double heaviest = 0;  // kg, of all bodies
    for (std::size_t row = 0; row < rows; ++row)
        if (moves(row)) heaviest = std::fmax(heaviest, static_cast<double>(world.bodies.mass[row]));
    std::vector<DirectJoints<Real>> beside;
    for (std::size_t i = 0; i < members.size();) {
        slots.clear();
        const std::int32_t island = members[i].island;
        for (; i < members.size() && members[i].island == island; ++i) slots.push_back(members[i].slot);
        DirectJoints<Real> group(world, slots);
        if (is_rattle || group.is_small_enough()) {
            if (!is_rattle && is_fit_for_crowd(world, slots, heaviest))
                crowd.push_back({direct_.size(), hangs(world, slots), slots});
            direct_.push_back(std::move(group));
            continue;
        }
        ++swept_groups_;
        // Gears are solved with all that they couple.
        std::vector<std::size_t> geared;
        for (const std::size_t slot : slots) {
            const StoredJoint& joint = world.joints[slot];
            if (joint.type != JointType::gear) continue;
            geared.push_back(slot);
            for (const std::uint32_t coupled : {joint.first, joint.second})
                if (coupled != kNoJoint) geared.push_back(coupled);
        }
        std::sort(geared.begin(), geared.end());
        geared.erase(std::unique(geared.begin(), geared.end()), geared.end());
        if (!geared.empty()) beside.emplace_back(world, geared);
        for (const std::size_t slot : slots) {
            if (std::binary_search(geared.begin(), geared.end(), slot)) continue;
            if (SweptJoints<Real>::knows(world.joints[slot]))
                to_sweep.push_back(slot);
            else
                beside.emplace_back(world, std::vector<std::size_t>{slot});
        }
    }
    const auto hanging =
        std::count_if(crowd.begin(), crowd.end(), [](const Candidate& c) { return c.hangs; });
    if (static_cast<std::size_t>(hanging) < kFewestHung)
        std::erase_if(crowd, [](const Candidate& c) { return c.hangs; });
    std::size_t work = 0;
    for (const Candidate& candidate : crowd) work += direct_[candidate.group].work();
    if (work < kWorkOfCrowd) {
        std::erase_if(crowd, [&](const Candidate& c) { return c.hangs || direct_[c.group].loops() > 0; });
        const auto is_long = [](const Candidate& c) { return c.slots.size() > kMostJointsOfSmall; };
        const bool are_enough =
            crowd.size() >= kFewestFree || std::any_of(crowd.begin(), crowd.end(), is_long);
        if (world.gravity == Vec2{} || !are_enough) crowd.clear();
    }
    crowd_groups_ = crowd.size();
    crowd_hangs_ = std::any_of(crowd.begin(), crowd.end(), [](const Candidate& c) { return c.hangs; });
    std::vector<std::vector<std::size_t>> of_crowd;  // slots of each of its groups
    for (std::size_t i = crowd.size(); i-- > 0;)
        direct_.erase(direct_.begin() + static_cast<std::ptrdiff_t>(crowd[i].group));
    for (Candidate& candidate : crowd) of_crowd.push_back(std::move(candidate.slots));
    for (const std::size_t slot : swept_.sort(world, to_sweep, of_crowd))
        beside.emplace_back(world, std::vector<std::size_t>{slot});
    first_beside_ = direct_.size();
    for (DirectJoints<Real>& joint : beside) direct_.push_back(std::move(joint));
    group_of_.assign(rows, -1);
    for (std::size_t i = 0; i < first_beside_; ++i)
        for (const std::int32_t row : direct_[i].rows())
            if (row >= 0 && moves(static_cast<std::size_t>(row)))
                group_of_[static_cast<std::size_t>(row)] = static_cast<std::int32_t>(i);
    blows_.set_groups(group_of_, first_beside_);
    springs_.find(world);
}

/// Whether a group of joints hangs on the world, or on a body that nothing moves.
template <class Real>
bool SoftJoints<Real>::hangs(const WorldState<Real>& world, const std::vector<std::size_t>& slots) {
    return std::any_of(slots.begin(), slots.end(),
                       [&](std::size_t slot) { return is_hung(world, world.joints[slot]); });
}

/// Whether sweeps hold a group of joints in a heap as well as an exact solve: bodies of like masses, and
/// kinds that the kernels know. Nothing of it moves by itself.
/// @param heaviest  kg, of all bodies that move
template <class Real>
bool SoftJoints<Real>::is_fit_for_crowd(const WorldState<Real>& world, const std::vector<std::size_t>& slots,
                                        double heaviest) {
    const bool is_hanging = hangs(world, slots);
    if (slots.size() < (is_hanging ? kFewestJointsOfHung : kFewestJoints)) return false;
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (const std::size_t slot : slots) {
        const StoredJoint& joint = world.joints[slot];
        if (!SweptJoints<Real>::knows(joint)) return false;
        for (const BodyId id : {joint.a, joint.b}) {
            if (id == BodyId{}) continue;  // the world
            const std::size_t row = world.handles.row_of_slot(id.index);
            if (row >= world.bodies.count || (world.bodies.flags_of(row) & kKinematic) != 0) return false;
            if (world.bodies.is_immovable(row)) continue;
            const auto mass = static_cast<double>(world.bodies.mass[row]);
            least = std::fmin(least, mass), most = std::fmax(most, mass);
        }
    }
    // What hangs cannot give way to what falls on it.
    return (is_hanging ? heaviest : most) <= kLargestMassRatio * least;
}

/// Lists the contacts of groups, and marks those of which a body can touch something in this step.
template <class Real>
void SoftJoints<Real>::find_touching(const JointStep<Real>& step, const StepView<Real>& contacts,
                                     const PathSolver<Real>& paths, double dt) {
    group_touches_.assign(first_beside_, 0), contacts_.clear();
    if (first_beside_ == 0) return;
    const Bodies<Real>& bodies = step.world.bodies;
    const auto speed_of = [&](std::size_t row) {
        return std::fabs(static_cast<double>(bodies.velocity_x[row])) +
               std::fabs(static_cast<double>(bodies.velocity_y[row]));
    };
    const auto look = [&](const ContactRows<Real>& rows, std::size_t i, std::int32_t a, std::int32_t b) {
        const auto row = static_cast<std::size_t>(a);
        double near = 0.05 * static_cast<double>(bodies.radius[row]) + dt * speed_of(row);
        if (b >= 0 && static_cast<std::size_t>(b) < bodies.count)
            near += dt * speed_of(static_cast<std::size_t>(b));
        if (!(rows.normal_impulse[i] > 0) && static_cast<double>(rows.separation[i]) > near) return;
        mark(a, b, group_touches_);
    };
    const ContactRows<Real>& pairs = contacts.graph.pairs;
    pairs.for_each([&](std::size_t i) {
        if (!pairs.is_live[i / kContactBlock] || !are_joined(pairs.a[i], pairs.b[i])) return;
        contacts_.pairs.push_back(i), look(pairs, i, pairs.a[i], pairs.b[i]);
    });
    contacts.supports.for_each([&](std::size_t i) {
        if (!are_joined(contacts.supports.a[i], -1)) return;
        contacts_.supports.push_back(i), look(contacts.supports, i, contacts.supports.a[i], -1);
    });
    if (!bodies.has_shapes) return;
    std::size_t number = 0;
    paths.for_each([&](const PathContact<Real>& contact) {
        if (are_joined(contact.near, contact.far)) {
            contacts_.paths.push_back(number);
            mark(contact.near, contact.far, group_touches_);
        }
        ++number;
    });
}

/// Marks groups on which a contact presses, beside those that are marked.
template <class Real>
void SoftJoints<Real>::find_pressed(const StepView<Real>& contacts, const PathSolver<Real>& paths,
                                    std::vector<std::uint8_t>& groups) const {
    groups.resize(first_beside_);
    const ContactRows<Real>&pairs = contacts.graph.pairs, &supports = contacts.supports;
    for (const std::size_t i : contacts_.pairs)
        if (pairs.normal_impulse[i] > 0) mark(pairs.a[i], pairs.b[i], groups);
    for (const std::size_t i : contacts_.supports)
        if (supports.normal_impulse[i] > 0) mark(supports.a[i], -1, groups);
    contacts_.for_each_path(paths, [&](const PathContact<Real>& contact, std::size_t) {
        if (contact.link.normal1[contact.lane] + contact.link.normal2[contact.lane] > 0)
            mark(contact.near, contact.far, groups);
    });
}

template <class Real>
void SoftJoints<Real>::begin_step(const JointStep<Real>& step, const StepView<Real>& contacts,
                                  const PathSolver<Real>& paths, const StepFlights& flights) {
    if (flights.is_first()) step.world.joints.begin_limits(flights.length_of_step());
    find_touching(step, contacts, paths, flights.length());
    touches_ = false;
    springs_.begin_step(step.terms.substep_dt);
    for (std::size_t i = 0; i < direct_.size(); ++i) {
        const bool is_beside = i >= first_beside_, touches = is_beside || group_touches_[i] != 0;
        touches_ = touches_ || (touches && !is_beside);
        direct_[i].begin_step(step, touches, is_beside, is_rattle);
    }
    is_pressed_.clear();
    if (touches_) find_pressed(contacts, paths, is_pressed_);
    if (!swept_.empty()) swept_.begin_step(step, contacts.loops);
}

template <class Real>
void SoftJoints<Real>::solve(const JointStep<Real>& step, const StepLoops<Real>& loops, int substep) {
    using Begin = typename SweptJoints<Real>::Begin;
    if (!swept_.empty()) swept_.sweep(step, loops, substep == 0 ? Begin::step : Begin::substep);
    // Before contacts push bodies apart, so that they answer what this makes of overlaps.
    if (open_share_ > 0) swept_.close_gaps(step, loops);
    std::size_t joints = 0;
    for (std::size_t i = 0; i < first_beside_; ++i) joints += direct_[i].joints();
    loops.executor->for_each_task(first_beside_, kNanosecondsToSolve * static_cast<double>(joints),
                                  [&](std::size_t i) { direct_[i].solve_first(step, substep); });
    for (std::size_t i = first_beside_; i < direct_.size(); ++i) direct_[i].solve_first(step, substep);
    if (first_beside_ < direct_.size() && !swept_.empty()) swept_.sweep(step, loops, Begin::nothing);
}

template <class Real>
DirectJoints<Real>* SoftJoints<Real>::small_group_of(std::int32_t row) {
    const std::int32_t number = exact_group_of(row);
    if (number < 0) return nullptr;
    DirectJoints<Real>& group = exact_group(number);
    return group.joints() <= kMostJointsOfSmall ? &group : nullptr;
}

template <class Real>
void SoftJoints<Real>::forget_blows(const JointStep<Real>& step, const StepView<Real>& contacts,
                                    PathSolver<Real>& paths) {
    if (!blows_.find(step, contacts, paths, contacts_, group_touches_)) return;
    blows_.take_back(contacts, paths);
    for (std::size_t i = 0; i < first_beside_; ++i)
        if (blows_.is_thrown(i)) direct_[i].solve_anew(step);
}

template <class Real>
double SoftJoints<Real>::solve_again(const JointStep<Real>& step, const StepLoops<Real>& loops) {
    using Begin = typename SweptJoints<Real>::Begin;
    if (!swept_.empty()) swept_.sweep(step, loops, Begin::nothing);
    std::size_t joints = 0;
    for (std::size_t i = 0; i < first_beside_; ++i) joints += direct_[i].joints();
    loops.executor->for_each_task(first_beside_, kNanosecondsToSolve / 4 * static_cast<double>(joints),
                                  [&](std::size_t i) {
                                      if (direct_[i].touches()) direct_[i].solve_again(step);
                                  });
    for (std::size_t i = first_beside_; i < direct_.size(); ++i) direct_[i].solve_again(step);
    if (!swept_.empty()) return std::numeric_limits<double>::infinity();
    double largest = 0;
    for (const DirectJoints<Real>& group : direct_)
        if (group.touches()) largest = std::fmax(largest, group.largest_change());
    return largest;
}

template <class Real>
bool SoftJoints<Real>::ask_turns(double settled, TurnRows& turns) const {
    if (!swept_.empty()) return false;
    for (std::size_t i = 0; i < first_beside_; ++i) {
        if (!direct_[i].touches() || direct_[i].largest_change() <= settled) continue;
        for (const std::int32_t row : direct_[i].rows())
            if (row >= 0 && group_of_[static_cast<std::size_t>(row)] == static_cast<std::int32_t>(i))
                turns.ask(row);
    }
    return true;
}

template <class Real>
bool SoftJoints<Real>::are_torn() const {
    return open_share_ > kTorn;
}

template <class Real>
void SoftJoints<Real>::end_substep(const JointStep<Real>& step, Books& books) {
    for (DirectJoints<Real>& group : direct_) {
        group.note_forces();
        if (books.is_open) group.book(step, books, false);
    }
    if (!swept_.empty()) swept_.note_forces();
    if (books.is_open && !swept_.empty()) swept_.book(step, books);
}

template <class Real>
bool SoftJoints<Real>::end_step(const JointStep<Real>& step, const StepView<Real>& contacts,
                                const PathSolver<Real>& paths, Books& books, const StepFlights& flights) {
    JointStore& joints = step.world.joints;
    const double dt = flights.length();
    if (touches_) {
        find_pressed(contacts, paths, is_pressed_);
        for (std::size_t i = 0; i < first_beside_; ++i)
            if (!is_pressed_[i]) direct_[i].leave();
    }
    for (DirectJoints<Real>& group : direct_) {
        if (!group.touches()) {
            group.end_step(step);
            group.note_forces();
            if (books.is_open) group.book(step, books, true);
        }
        group.store(joints, dt);
    }
    open_share_ = swept_.empty() ? 0 : swept_.close_gaps(step, contacts.loops);
    if (!swept_.empty()) swept_.store(joints, step.terms.substep_dt, dt, *contacts.loops.executor);
    if (flights.count() > 1) add_to_means(joints, flights);
    if (!flights.is_last()) return false;
    joints.end_limits(flights.length_of_step());
    const std::size_t before = joints.broken.size();
    for (const std::size_t slot : breakable_) {
        const StoredJoint& joint = joints[slot];
        // What is not a number breaks no joint: its bodies are lost.
        const bool breaks = length_squared(joint.force) > joint.break_force * joint.break_force ||
                            std::fabs(joint.torque) > joint.break_torque;
        if (breaks) joints.broken.push_back(break_of(step, slot, dt));
    }
    // A gear goes with its joints, also where both broke.
    for (std::size_t i = before; i < joints.broken.size(); ++i)
        if (joints.is_alive(joints.broken[i].joint)) joints.remove(joints.broken[i].joint.index);
    return joints.broken.size() > before;
}

/// Forces that the store has of the present flight become those of the step so far, each flight by its part
/// of the step.
template <class Real>
void SoftJoints<Real>::add_to_means(JointStore& joints, const StepFlights& flights) {
    if (flights.is_first()) means_.assign(joints.slots(), {});
    const double share = flights.length() / flights.length_of_step();
    joints.for_each([&](std::size_t slot, const StoredJoint& joint) {
        Mean& mean = means_[slot];
        mean.force += share * joint.force, mean.torque += share * joint.torque;
        joints[slot].force = mean.force, joints[slot].torque = mean.torque;
    });
}

template <class Real>
JointBreak SoftJoints<Real>::break_of(const JointStep<Real>& step, std::size_t slot, double dt) {
    const StoredJoint& joint = step.world.joints[slot];
    JointBreak broken{.joint = step.world.joints.id_of(slot),
                      .a = joint.a,
                      .b = joint.b,
                      .time = step.world.time + dt,
                      .point = {},
                      .force = joint.force,
                      .torque = joint.torque};
    const Bodies<Real>& bodies = step.world.bodies;
    const std::size_t row = step.world.handles.row_of_slot(joint.b.index);
    broken.point = {bodies.position_x[row], bodies.position_y[row]};
    double angle = bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0;
    if (row < bodies.count) {  // columns have the start of the step
        const Column<Real>& displacement = step.records.displacement;
        broken.point += Vec2{displacement[2 * row], displacement[2 * row + 1]};
        if (const Real* turn = bodies.has_rotation ? step.records.turn() : nullptr)
            angle += static_cast<double>(turn[row]) / rim_of(bodies, row);
    }
    broken.point += rotate(rotation_by(angle), joint.anchor_b);
    return broken;
}

template <class Real>
std::string SoftJoints<Real>::describe() const {
    std::size_t exact = 0, loops = 0, beside = 0;
    for (std::size_t i = 0; i < direct_.size(); ++i)
        if (i < first_beside_)
            exact += direct_[i].joints(), loops += direct_[i].loops();
        else
            ++beside;
    std::string text = join(exact, " in ", first_beside_, first_beside_ == 1 ? " group" : " groups",
                            " solved exactly, leaves first");
    if (loops > 0) text += join(" (", loops, " of them close loops)");
    if (swept_.joints() > 0)
        text += join("; ", swept_.joints(), " in ", swept_groups_ + crowd_groups_,
                     swept_groups_ + crowd_groups_ == 1 ? " group" : " groups", " swept by lanes in ",
                     swept_.colours(), " colours");
    if (swept_groups_ > 0) text += join(" (", swept_groups_, " with too many loops to be solved exactly)");
    if (crowd_groups_ > 0) text += join(" (", crowd_groups_, " of a crowd of small ones)");
    if (beside > 0) text += join("; ", beside, " one by one beside these");
    return text;
}

template <class Real>
std::size_t SoftJoints<Real>::bytes() const {
    std::size_t bytes = swept_.bytes() + springs_.bytes() + joined_.bytes() + blows_.bytes() +
                        contacts_.bytes() +
                        (group_of_.capacity() + first_of_group_.capacity()) * sizeof(std::int32_t) +
                        group_touches_.capacity() + means_.capacity() * sizeof(Mean);
    for (const DirectJoints<Real>& group : direct_) bytes += group.bytes() + sizeof(group);
    return bytes;
}

template class SoftJoints<float>;
template class SoftJoints<double>;

}  // namespace carom
