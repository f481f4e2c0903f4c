#include "solvers/soft/corrections/shape_turns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "constraints/partner.hpp"
#include "math/vec2_math.hpp"
#include "solvers/contact_sets/local_solve.hpp"
#include "state/columns/index.hpp"

namespace carom {
namespace {

/// Turns over contacts of shapes in a substep, at most: a share of the largest ratio of masses of two that
/// touch, and whatever that is. docs/decisions/0064-uneven-masses-in-sweeps.md has what fewer leave.
constexpr double kTurnsOfRatio = 0.05;
constexpr int kMostTurnsOfShapes = 31;
/// And in a step: where it has many substeps each begins with what the one before came to, and falls less.
/// docs/decisions/0086-steps-that-stall.md.
constexpr double kMostTurnsOfStep = 4 * kMostTurnsOfShapes;
/// They end when a sweep changes no velocity by more than this share of what gravity adds in a substep, and
/// after a few where the change has not become less.
constexpr double kSettled = 0.2;
constexpr int kFewTurns = 7;
/// In crowds they end from the third on where a turn leaves more than this share of the change of the one
/// before: a light body or two between heavy ones, while all others hold. What is left goes on in the next
/// substep. docs/decisions/0098-turns-around-what-is-restless.md.
constexpr double kStalled = 0.9;
constexpr int kTurnsOfStalled = 3;
/// They end after fewer where it changes one by more than so many times that: a few heavy bodies that strike
/// light ones, and do not lie on them. In heaps of heavy and light ones, where one body in so many is a heavy
/// one that touches light ones, they do not: their light bodies would be swallowed. Without gravity nothing
/// lies on anything. docs/decisions/0079-struck-bodies.md has what more would do.
constexpr double kStruck = 2;
constexpr int kTurnsOfStruck = 3;
constexpr int kTurnsWithoutGravity = 1;
constexpr std::size_t kMixed = 64;
/// Light bodies that change the velocity of each heavy one by less than this share of what gravity adds in a
/// substep are no load to it: it is to them as what nothing moves.
constexpr double kLoaded = 0.1;
/// Where a body has gone that was heavier than so many others in the mean, the first step without it takes
/// turns, too, and until less is left: docs/decisions/0067-weights-taken-off-heaps.md.
constexpr double kHeavyLost = 10;
constexpr double kSettledOfLost = 0.05;

}  // namespace

template <class Real>
void ShapeTurns<Real>::begin_step(const WorldState<Real>& world, const PathSolver<Real>& paths,
                                  const BodyMasses<Real>& masses) {
    const double lost = std::exchange(heaviest_lost_, 0);
    most_ = 0, settled_ = kSettled, most_of_struck_ = kTurnsOfStruck;
    uneven_.clear();
    // A single path is solved exactly: sweeps would only add their round-off, in units of the heaviest body.
    if (paths.is_single_path()) return;
    if (lost * static_cast<double>(world.bodies.moving()) > kHeavyLost * world.dynamic_mass) {
        most_ = most_of_struck_ = kMostTurnsOfShapes, settled_ = kSettledOfLost;
        return;
    }
    if (!masses.are_uneven()) return;
    const Manifolds<Real>& manifolds = paths.manifolds;
    const Column<Real>& inverse = masses.inverse_column();
    Real most = 1;  // ratio of masses of two that touch
    const std::span<const std::int32_t> live = manifolds.live();
    for (std::size_t n = 0; n < live.size() && live[n] >= 0; ++n) {  // what nothing moves comes last
        const ManifoldList<Real>& list = manifolds.list_of(live[n]);
        const std::size_t i = Manifolds<Real>::place_of(live[n]);
        const Partner partner(list.b[i]);
        // Sleepers have rows beyond those that masses are known of; nothing moves them in this step.
        if (!partner.is_body() || index(partner.row()) >= world.bodies.count) continue;
        const Real of_a = std::fabs(inverse[index(list.a[i])]),
                   of_b = std::fabs(inverse[index(partner.row())]);
        if (!(of_a > 0 && of_b > 0)) continue;
        const Real ratio = std::max(of_a, of_b) / std::min(of_a, of_b);
        if (!(ratio > static_cast<Real>(LocalSolve<Real>::kUneven))) continue;
        most = std::max(most, ratio);
        uneven_.push_back({n, of_a < of_b ? list.a[i] : partner.row()});
    }
    if (uneven_.empty()) return;
    most_ = static_cast<int>(
        std::min(kTurnsOfRatio * static_cast<double>(most), static_cast<double>(kMostTurnsOfShapes)));
    const bool are_mixed = kMixed * count_heavy(world.bodies.count) >= world.bodies.moving();
    const bool can_lie = length_squared(world.gravity) > 0;
    most_of_struck_ = !can_lie ? kTurnsWithoutGravity : are_mixed ? most_ : kTurnsOfStruck;
}

/// @return how many heavy bodies touch light ones
template <class Real>
std::size_t ShapeTurns<Real>::count_heavy(std::size_t rows) {
    if (load_.size() < rows) load_.resize(rows);
    for (const Uneven& contact : uneven_) load_[index(contact.heavy)] = 1;
    std::size_t count = 0;
    for (const Uneven& contact : uneven_) count += std::exchange(load_[index(contact.heavy)], Real(0)) > 0;
    return count;
}

/// Whether light bodies give a heavy one what changes its velocity.
template <class Real>
bool ShapeTurns<Real>::is_any_loaded(const StepView<Real>& step, const PathSolver<Real>& paths) {
    const Column<Real>& velocity = step.records.velocity;
    const auto light = static_cast<Real>(kLoaded * step.terms.fall_speed());
    for (const Uneven& contact : uneven_) load_[index(contact.heavy)] = 0;
    bool is_loaded = false;
    for (const Uneven& contact : uneven_)
        paths.for_each_of(contact.number, contact.number + 1, [&](const PathContact<Real>& c) {
            Real& load = load_[index(contact.heavy)];
            load += c.link.normal1[c.lane] + c.link.normal2[c.lane];
            is_loaded = is_loaded || load * std::fabs(velocity[4 * index(contact.heavy) + 3]) > light;
        });
    return is_loaded;
}

template <class Real>
void ShapeTurns<Real>::settle(const StepView<Real>& step, ContactSweeps<Real>& sweeps,
                              PathSolver<Real>& paths) {
    if (!may_be_due() || (!uneven_.empty() && !is_any_loaded(step, paths))) return;
    const auto next = ContactSweeps<Real>::next(step, ContactSweeps<Real>::Blocks::all, 1);
    const bool has_discs = step.graph.pairs.contacts() > 0;
    const auto settled = static_cast<Real>(settled_ * step.terms.fall_speed());
    const auto struck = static_cast<Real>(kStruck * step.terms.fall_speed());
    const double share = std::ceil(kMostTurnsOfStep * step.terms.substep_dt / step.terms.dt);
    const int most = std::min(most_, static_cast<int>(share));
    Real first = 0, before = 0;  // changes [m/s]
    paths.turns.begin();
    for (const Uneven& contact : uneven_) paths.turns.ask(contact.heavy);
    using Bundles = typename PathSolver<Real>::Bundles;
    Bundles which = paths.near_turns();
    bool is_last = false;
    for (int turn = 1; !is_last; ++turn) {
        Column<Real>& velocity = step.records.velocity;
        before_.resize_for_overwrite(velocity.size());
        std::copy(velocity.begin(), velocity.end(), before_.begin());
        paths.sweep(step.terms, step.records, step.loops, which);
        if (has_discs) sweeps.run(step, next);
        std::array<Real, 4> changes{};  // vx, vy, rim speed, and the masses, which stay: a register's lanes
        for (std::size_t i = 0; i < velocity.size(); i += changes.size())
            for (std::size_t k = 0; k < changes.size(); ++k)
                changes[k] = std::max(changes[k], std::abs(velocity[i + k] - before_[i + k]));
        const Real change = *std::max_element(changes.begin(), changes.end());
        if (!(change > settled)) return;
        if (turn == 1) first = change;
        const bool is_stalled = paths.manifolds.is_crowd() && turn >= kTurnsOfStalled &&
                                change > static_cast<Real>(kStalled) * before;
        is_last = turn == most || (turn >= most_of_struck_ && change > struck) ||
                  (turn == kFewTurns && change > first) || is_stalled;
        before = change;
        which = change > struck ? paths.near_turns() : Bundles::all;
        paths.solve_again(step.terms, step.records, step.loops, false, which);
    }
}

template class ShapeTurns<float>;
template class ShapeTurns<double>;

}  // namespace carom
