#include "solvers/soft/soft_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "effects/flight.hpp"
#include "solvers/paths/contact_work.hpp"
#include "solvers/soft/contacts/stored_contact.hpp"

namespace carom {
namespace {

/// Next sweeps of the first substep if there are no impulses to start from, unless none are asked for.
constexpr int kFirstSweeps = 32;
/// Likewise along paths of contacts, which take loads farther.
constexpr int kFirstPasses = 8;
/// Turns of joints and contacts a substep where they bear on each other: of groups that are solved exactly
/// and of crowds that are torn, of other crowds.
constexpr int kTurns = 4;
constexpr int kTurnsOfCrowd = 1;
/// The former end when joints, and what weighs on them, change no velocity by more than this share of what
/// gravity adds in a substep: contacts hold as well then, and those of all other bodies are not solved once
/// more for nothing.
constexpr double kJointsSettled = 0.001;
/// In such a turn bodies are restless, and contacts near them are swept alone, that joints or the turn before
/// have changed by more than this share of the same. docs/decisions/0098-turns-around-what-is-restless.md.
constexpr double kJointsRestless = 0.01;
/// Times at most that energy is bounded in a substep, with a turn between each two.
constexpr int kRoundsOfEnergy = 6;
/// Sweeps where contacts of discs have done work.
constexpr int kSweepsOfGain = 2;
/// Bodies; in fewer contacts may do work: to look at it would take 2 to 3 % of a world of three.
constexpr std::size_t kFewestOfCrowd = 8;
constexpr std::size_t kRowsPerTask = 1024;  // where there is but one group

/// Whether something bounces, and the effect is not on with zeros alone.
template <class Real>
bool has_restitution(const WorldState<Real>& world) {
    if (!world.effects.restitution) return false;
    if (world.walls && world.walls->material.restitution > 0) return true;
    for (std::size_t row = 0; row < world.bodies.count; ++row)
        if (world.bodies.restitution[row] > 0) return true;
    return false;
}

static_assert(kContactBlock == kRowPadding);

/// The work of contacts' impulses at the velocities that bodies have now [J]: nothing or less along normals
/// and against friction where their laws hold.
template <class Real>
double work_at_end(const StepView<Real>& step, const PathSolver<Real>& paths, const Bodies<Real>& bodies) {
    const Column<Real>& velocity = step.records.velocity;
    double work = 0;
    const ContactRows<Real>&pairs = step.graph.pairs, &supports = step.supports;
    pairs.for_each([&](std::size_t i) {
        if (pairs.is_live[i / kContactBlock])
            work += StoredContact<Real>(pairs, i).work(body_at(velocity, pairs.a[i]),
                                                       body_at(velocity, pairs.b[i]));
    });
    supports.for_each([&](std::size_t i) {
        work +=
            StoredContact<Real>(supports, i).work(body_at(velocity, supports.a[i]), surface_at(supports, i));
    });
    if (!bodies.has_shapes) return work;
    const auto motion = [&](std::int32_t row) {
        const DoubleBody body = body_at(velocity, row);
        return MeanVelocity{{body.record[0], body.record[1]}, body.record[2]};
    };
    paths.for_each([&](const PathContact<Real>& contact) {
        work += ContactWork<Real>(contact).work(motion(contact.near), motion(contact.far));
    });
    return work;
}

}  // namespace

template <class Real>
std::size_t SoftSolver<Real>::rows_per_task() const {
    return graph.groups.chunks > 1 ? graph.groups.rows_per_chunk : kRowsPerTask;
}

template <class Real>
void SoftSolver<Real>::begin_substeps(const WorldState<Real>& world, const Column<Real>& motion,
                                      const StepFlights& flights, double h, const Vec2 gravity,
                                      const KernelTable<Real>& kernels, const Executor& executor) {
    read_effects(world, settings_);
    settings_.iterations = iterations(world);
    const bool has_friction = settings_.effects.friction && !settings_.is_smooth_heap,
               may_turn = has_friction || world.bodies.has_shapes || !world.joints.empty();
    const bool are_new = masses_.derive(world.bodies, has_friction, may_turn);
    if (are_new && !masses_.have_followed_rows()) finder_.pairs.forget(), corrections_.uneven.clear();
    takes_gains_ = false, gains_.begin_step();
    loops_ = {&kernels, &settings_.kernels_of(kernels, masses_.some_are_fixed()), &executor, rows_per_task()};
    const FlightClock clock = flight_clock_at(h, world.drag.linear);
    terms_.dt = flights.length(), terms_.substep_dt = h, terms_.elapsed = 0, terms_.behind = flights.left();
    terms_.gravity_change = clock.s * gravity, terms_.decay = clock.u;
    terms_.spin_decay = flight_clock_at(h, world.drag.angular).u;
    if (world.effects.joints) joints.find_groups(world);
    // A record for the padding of each group, so that no two tasks write to the same.
    records_.begin(world, motion, masses_, are_new ? world.bodies.count : world.bodies.moving(),
                   std::max(ContactGraph<Real>::padding_rows(graph.groups), joints.rows_beyond()), terms_,
                   loops_);
}

template <class Real>
void SoftSolver<Real>::find_contacts(WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                                     Column<Real>& motion, bool flies_together, double longest_substep) {
    motion.resize(4 * padded(records_.count() + ContactGraph<Real>::padding_rows(graph.groups)));
    settings_.set_lengths(terms_, longest_substep);
    settings_.masses_are_uneven = masses_.are_uneven();
    bounces_ = has_restitution(world);
    settings_.sweeps_hits = !bounces_ && !settings_.masses_are_uneven && !world.bodies.has_flags;
    warm_start_.begin_step(graph, terms_.substep_dt, terms_.dt, longest_substep);
    const bool is_new =
        finder_.pairs.find(view(), world.bodies, masses_, motion,
                           flies_together && !world.bodies.has_shapes && world.joints.empty());
    if (is_new) corrections_.uneven.find(graph.pairs, masses_, records_.count());
    finder_.supports.find(view(), world, edges, world.joints.empty() ? nullptr : joints.joined(),
                          world.books);
    settings_.has_uneven_sweeps = corrections_.uneven.are_swept();
    corrections_.uneven.begin_step(view(), world, masses_.are_mixed());
    corrections_.chains.begin_step(view());
    if (settings_.sweeps_hits)
        corrections_.deep.begin_step(view(), motion, finder_.pairs.struck_chunks());
    else
        corrections_.deep.clear();
    corrections_.wedged.begin_step(view(), world.bodies);
    counters.contacts = static_cast<std::int64_t>(
        std::accumulate(graph.pairs.live_count.begin(), graph.pairs.live_count.end(), supports_.contacts()));
    counters.colours = static_cast<std::int64_t>(graph.pairs.count.size());
    counters.overflow = static_cast<std::int64_t>(graph.pairs.overflow());
    sweeps_.begin_step(counters.contacts);
    takes_gains_ = is_crowd_in_touch(world) &&
                   (bounces_ || corrections_.deep.expects_hits() || finder_.pairs.has_deep_pairs());
}

/// Discs of which several may move and some may touch.
template <class Real>
bool SoftSolver<Real>::is_crowd_in_touch(const WorldState<Real>& world) const {
    return records_.moving() >= kFewestOfCrowd &&
           counters.contacts > static_cast<std::int64_t>(supports_.contacts()) && !world.bodies.has_shapes &&
           world.joints.empty();
}

template <class Real>
void SoftSolver<Real>::find_manifolds(const WorldState<Real>& world, const EdgeCandidates<Real>& edges) {
    paths.rescale(warm_start_.kept());
    paths.pushes_twice = false, paths.is_of_crowd = !world.joints.empty() && joints.has_crowd();
    paths.find(world, edges, terms_, {kNearFraction, settings_.fall}, records_, loops_);
    impacts.shapes.begin_step();
    corrections_.shape_turns.begin_step(world, paths, masses_);
    counters.contacts += paths.counters.contacts;
}

template <class Real>
void SoftSolver<Real>::solve_paths(int number, bool is_last) {
    const bool starts_anew = number == 0 && warm_start_.starts_anew();
    // What is at rest is solved in every second substep; not where a scene asks for contacts solved better.
    using Bundles = typename PathSolver<Real>::Bundles;
    const bool may_rest = number % 2 == 1 && settings_.iterations == kDefaultIterations;
    paths.solve(terms_, records_, loops_, starts_anew ? kFirstPasses : 1, is_last || starts_anew,
                may_rest ? Bundles::restless : Bundles::all);
}

template <class Real>
void SoftSolver<Real>::warm_start() {
    const typename Sweeps::Sweep give{loops_.contacts->warm_start_pairs,
                                      loops_.contacts->warm_start_supports};
    sweeps_.run(view(), {&give, 1});
}

template <class Real>
void SoftSolver<Real>::solve_contacts(int number, bool is_last) {
    using Blocks = typename Sweeps::Blocks;
    const ContactKernels<Real>& kernels = *loops_.contacts;
    const SolveContacts<Real> on_pairs = Sweeps::arguments(view(), graph.pairs),
                              on_supports = Sweeps::with_rows(on_pairs, supports_);
    const bool starts_anew = number == 0 && warm_start_.starts_anew();
    const bool only_restless =
        !starts_anew && !is_last && !warm_start_.is_rebalanced() && settings_.may_leave_out_calm();
    const int next = settings_.next_sweeps;
    const auto others = Sweeps::next(view(), only_restless ? Blocks::restless : Blocks::all,
                                     starts_anew ? std::max(kFirstSweeps, next) : next);
    const std::array<typename Sweeps::Sweep, 3> sweeps{
        {{kernels.first_pairs, kernels.first_supports, Blocks::all_and_mark}, others[0], others[1]}};
    const bool is_first_alone = corrections_.loads.begin_substep(view(), number, is_last) || next == 0;
    sweeps_.run(view(), {sweeps.data(), is_first_alone ? std::size_t{1} : sweeps.size()}, on_pairs,
                on_supports);
}

/// Joints, then contacts. @return whether contacts are left as they are, since neither joints nor what
/// weighs on them have changed a velocity by more than `settled` [m/s]; below zero: never.
/// Contacts of shapes are solved near bodies alone that joints have changed by more than that; in a crowd
/// only those are swept that have anything left to do, where they are few.
/// @param is_again  whether a turn of this substep came before
/// @param sweeps  whether contacts of shapes are swept in place of solved
template <class Real>
bool SoftSolver<Real>::solve_turn(WorldState<Real>& world, double settled, bool is_again, bool sweeps) {
    const auto next = Sweeps::next(view(), Sweeps::Blocks::all, 1);
    if (!is_again) paths.begin_restless(records_);
    if (!world.joints.empty()) {
        double change = joints.solve_again(joint_step(world), loops_);
        if (!heavy_.empty())
            change = std::max(change, heavy_.solve(held_contacts(), joint_step(world), joints));
        if (change <= settled) return true;
    }
    if (world.bodies.has_shapes) {
        using Bundles = typename PathSolver<Real>::Bundles;
        paths.turns.begin();
        const bool has_asked = joints.ask_turns(settled, paths.turns);
        const Bundles which = has_asked && settled >= 0 ? paths.near_turns() : Bundles::all;
        const auto restless = static_cast<Real>(kJointsRestless * terms_.fall_speed());
        const bool is_done =
            settled >= 0 && has_asked && !sweeps && paths.sweep_restless(terms_, records_, loops_, restless);
        if (sweeps)
            paths.sweep(terms_, records_, loops_, which);
        else if (is_again && !is_done)
            paths.solve_again(terms_, records_, loops_, true, which);
        else if (!is_done)
            paths.solve(terms_, records_, loops_, 1, true, which);
    }
    sweeps_.run(view(), {next.data(), next.size()});
    return false;
}

/// Turns are for what presses near bodies that joints have changed; other contacts hold as they would
/// without.
template <class Real>
void SoftSolver<Real>::solve_joints_and_contacts(WorldState<Real>& world) {
    const double settled = kJointsSettled * terms_.fall_speed();
    const int turns = joints.touches_exactly() || joints.are_torn() ? kTurns : kTurnsOfCrowd;
    for (int turn = 0; turn < turns && !solve_turn(world, settled, turn > 0, sweeps_turns()); ++turn)
        continue;
}

template <class Real>
void SoftSolver<Real>::bound_energy(WorldState<Real>& world) {
    const JointStep<Real> step = joint_step(world);
    const StepView<Real> contacts = view();
    const SolvedSubstep<Real> solved{step, contacts, paths, joints};
    double before = std::numeric_limits<double>::infinity();  // J, gained at the round before
    const auto bound_passive = [&] {
        for (int round = 1; round < kRoundsOfEnergy; ++round) {
            const double gained = passive_.bound(solved, false);
            if (!(gained > 0)) return;
            // Where exact solves of joints give energy, further turns would only give more.
            if (!passive_.has_scaled() && !(gained < before)) break;
            before = gained;
            solve_turn(world, -1, false, false);
        }
        passive_.bound(solved, true);
    };
    const bool are_uneven = masses_.are_uneven();
    if (!is_crowd_of_discs(world) || (takes_gains_ && are_uneven)) bound_passive();
    // A heap of uneven discs that is lifted out of itself would sink: what bears it would be taken.
    const bool bears_loads = !(terms_.gravity_change == Vec2{});
    if (!takes_gains_ || (are_uneven && bears_loads) || !ContactGains<Real>::does_work(solved)) return;
    if (!are_uneven) {  // there sweeps would undo what corrections have done
        // What more sweeps mend is not taken from what bears a heap.
        const auto more = Sweeps::next(contacts, Sweeps::Blocks::all, kSweepsOfGain);
        sweeps_.run(contacts, {more.data(), more.size()});
    }
    gains_.take(solved);
}

/// Joints and contacts act at once, and a mean velocity says nothing of which came first: where a joint draws
/// back bodies that part, and a contact stops them, the contact seems to give what the joint takes too much.
/// Contacts give no more than their work at the velocities of the end, for then they have stopped what they
/// stop: what they seem to give beyond that joints took less, as far as they took any. What springs, motors
/// and targets did is theirs where contacts do give something.
/// @param before  J, what they had given before this substep
template <class Real>
void SoftSolver<Real>::share_with_joints(WorldState<Real>& world, Books& books, double before) {
    const double given = books.restitution + books.friction - before;
    if (!(given > 0 && books_.work_of_joints < 0)) return;
    double of_rigid = books_.work_of_joints;  // J
    joints.for_each_drive(joint_step(world), [&](std::int32_t, std::int32_t, double work, double bend) {
        of_rigid -= work + bend;
    });
    const double of_order =
        std::fmin(given - std::fmax(0, work_at_end(view(), paths, world.bodies)), -books_.work_of_joints);
    const double share = std::fmax(of_order, std::fmin(given, std::fmax(0, -of_rigid)));
    books.restitution -= share, books.joints += share;
}

template <class Real>
void SoftSolver<Real>::solve_wedged_bodies() {
    corrections_.wedged.solve(view(), Sweeps::arguments(view(), supports_));
}

template <class Real>
void SoftSolver<Real>::solve_uneven_contacts(bool is_last) {
    if (masses_.are_uneven()) counters.uneven_sweeps += corrections_.uneven.solve(view(), sweeps_, is_last);
    if (corrections_.shape_turns.may_be_due()) corrections_.shape_turns.settle(view(), sweeps_, paths);
}

template <class Real>
void SoftSolver<Real>::mark_impacts(const WorldState<Real>& world, const Candidates<Real>& neighbours) {
    impacts.mark(world, view(), neighbours);
}

template <class Real>
void SoftSolver<Real>::carry_out_impacts(const WorldState<Real>& world, const Column<Real>& motion,
                                         Books& books, Interruption& interruption) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    const SubstepBodies<Real> bodies{records_.count(),
                                     motion.data(),
                                     records_.velocity.data(),
                                     records_.start_columns(),
                                     records_.displacement.data(),
                                     records_.turn(),
                                     terms_.substep_dt,
                                     terms_.elapsed,
                                     real(terms_.gravity_change.x),
                                     real(terms_.gravity_change.y),
                                     real(terms_.decay),
                                     real(terms_.spin_decay)};
    const bool has_taken = gains_.has_taken();
    if (has_taken) gains_.give_back(view());
    impacts.carry_out_all(bodies, books, books_.gravity_work, interruption);
    if (!has_taken || !bounces_) return;
    gains_.for_each_cut(view(), world.bodies,
                        [&](std::int32_t row) { impacts.left_closing.add(graph.groups, row); });
}

template <class Real>
bool SoftSolver<Real>::settles_crowds(const WorldState<Real>& world) const {
    return !masses_.are_uneven() && !masses_.some_are_fixed() && !world.bodies.has_shapes &&
           world.joints.empty();
}

template <class Real>
void SoftSolver<Real>::settle_struck_contacts(const WorldState<Real>& world, const Column<Real>& motion,
                                              Books& books) {
    corrections_.struck.settle(view(), world, sweeps_, motion, impacts.left_closing.chunks(), books);
}

template <class Real>
void SoftSolver<Real>::end_contacts() {
    corrections_.loads.retain(view(), sweeps_, paths);
    paths.end(*loops_.executor);
    supports_.for_each([&](std::size_t i) {
        const auto candidate = static_cast<std::size_t>(supports_.candidate[i]);
        graph.supports.normal_impulse[candidate] = supports_.normal_impulse[i];
        if (settings_.effects.friction)
            graph.supports.friction_impulse[candidate] = supports_.friction_impulse[i];
        if (settings_.effects.rolling)
            graph.supports.rolling_impulse[candidate] = supports_.rolling_impulse[i];
    });
    finder_.supports.remember_led(graph.supports, supports_);
    warm_start_.end_step(graph);
}

template <class Real>
std::size_t SoftSolver<Real>::bytes() const {
    return graph.bytes() + paths.bytes() + impacts.bytes() + joints.bytes() + masses_.bytes() +
           records_.bytes() + supports_.bytes() + finder_.bytes() + warm_start_.bytes() + sweeps_.bytes() +
           corrections_.bytes() + projection_.bytes() + passive_.bytes() + gains_.bytes() + books_.bytes();
}

template class SoftSolver<float>;
template class SoftSolver<double>;

}  // namespace carom
