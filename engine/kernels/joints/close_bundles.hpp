#pragma once

#include "kernels/joints/joint_arguments.hpp"
#include "kernels/joints/sweep_bundles.hpp"
#include "simd/bundle_lanes.hpp"
#include "simd/lanes.hpp"

// Hinges of crowds that are open at the end of a step, closed by displacement, all of a mechanism at once and
// a mechanism a lane. Sweeps take a share of each gap, one joint after the other, and what others press on
// the limbs opens it again; here a mechanism moves as one.
//
// The displacement is the least, weighed by mass, of all that close the hinges, so the centre of mass stays
// where it is. A limb with all that hangs on it answers at its hinge as one body would whose inertia is a
// matrix (Featherstone, The calculation of robot dynamics using articulated-body inertias, 1983): found from
// the leaves to the root, moved from the root to the leaves. docs/decisions/0092-gaps-in-heaps.md.

namespace carom {
namespace {

/// What a body with all that hangs on it is to a displacement (x, y) of a point of it and a turn: the matrix
/// [xx xy x; xy yy y; x y turn], and what is to be added to its product with them.
template <class F>
struct LimbInertia {
    F xx, xy, yy, x, y, turn;       // kg, kg m, kg m²
    F impulse_x, impulse_y, turns;  // kg m, kg m²: of displacements, not of velocities
    template <class Fn>
    void for_each(const Fn& fn) {
        for (F* one : {&xx, &xy, &yy, &x, &y, &turn, &impulse_x, &impulse_y, &turns}) fn(*one);
    }
};

/// A hinge of a tree, as its parent sees it.
template <class F>
struct BranchGap {
    F arm_parent_x, arm_parent_y, arm_child_x, arm_child_y;  // m
    F gap_x, gap_y;                                          // m, to be closed
    F is_held;                                               // 1: its angle stays as it is, else 0
    F x, y, per_turn, turns;                                 // of the child at the hinge, as of a limb
    template <class Fn>
    void for_each(const Fn& fn) {
        for (F* one : {&arm_parent_x, &arm_parent_y, &arm_child_x, &arm_child_y, &gap_x, &gap_y, &is_held, &x,
                       &y, &per_turn, &turns})
            fn(*one);
    }
};

/// A batch of mechanisms that are closed.
template <class Lanes>
struct BundleTree {
    using Number = typename Lanes::Number;
    using F = typename Lanes::Batch;
    static constexpr std::size_t kOfLimb = 9, kOfBranch = 11, kOfMove = 4;  // numbers of each
    static constexpr std::size_t kBatches = kMostBodiesOfBundle * Lanes::size;
    alignas(64) Number limbs[kOfLimb * kBatches];       // by body
    alignas(64) Number branches[kOfBranch * kBatches];  // by number
    alignas(64) Number moves[kOfMove * kBatches];       // by body: x, y [m], turn [rad]; rim [m]

    template <class Numbers>
    [[gnu::always_inline]] static Numbers load(const Number* from) {
        Numbers numbers;
        numbers.for_each([&](F& one) { one = Lanes::load(from), from += Lanes::size; });
        return numbers;
    }
    template <class Numbers>
    [[gnu::always_inline]] static void store(Number* to, Numbers numbers) {
        numbers.for_each([&](F& one) { Lanes::store(to, one), to += Lanes::size; });
    }
    Number* limb(std::int32_t body) { return limbs + kOfLimb * Lanes::size * static_cast<std::size_t>(body); }
    Number* branch(std::size_t number) { return branches + kOfBranch * Lanes::size * number; }
    Number* move(std::int32_t body) { return moves + kOfMove * Lanes::size * static_cast<std::size_t>(body); }
};

/// Where hinges are open. @return lanes in which one is open by more than it may be
template <class OfBundle, class Real>
typename OfBundle::Mask measure_gaps(const CloseBundles<Real>& k, const JointBundle& bundle, std::size_t lane,
                                     const SweepJoints<Real>& hinges, BundleTree<OfBundle>& tree) {
    using F = typename OfBundle::Batch;
    const F one(1), zero(0);
    auto is_open = one < zero;
    for (std::size_t i = 0; i < bundle.branches; ++i) {
        const JointBranch& of = k.branches[bundle.first_branch + i];
        const std::size_t c = bundle.first_hinge + kJointBlock * of.hinge + lane;
        JointSide<OfBundle, true> a, b;
        load_rims<OfBundle>(hinges, c, a, b);
        turn_arms<OfBundle>(hinges, c, a, b);
        const auto moved_a = OfBundle::load_rows2(hinges.displacement, hinges.joints.a + c),
                   moved_b = OfBundle::load_rows2(hinges.displacement, hinges.joints.b + c);
        const Pair2<F> d = between<OfBundle, true>(hinges, c, moved_a, moved_b, a, b);
        const auto length_of = [](Pair2<F> v) { return simd::sqrt(v.x * v.x + v.y * v.y); };
        const F limb = length_of(a.arm) + length_of(b.arm), gap = length_of(d);
        // Lanes without a mechanism have no arms, nor have hinges of two centres a limb.
        is_open = is_open | ((gap > F(k.open) * limb) & (limb > zero));
        // What is left open is along the gap; one that is less open stays as it is.
        const F share = simd::select(gap > F(k.left) * limb, one - F(k.left) * limb / gap, zero);
        const F sign(of.parent_is_a ? Real(1) : Real(-1));
        BranchGap<F> branch{};
        const JointSide<OfBundle, true>&parent = of.parent_is_a ? a : b, &child = of.parent_is_a ? b : a;
        branch.arm_parent_x = parent.arm.x, branch.arm_parent_y = parent.arm.y;
        branch.arm_child_x = child.arm.x, branch.arm_child_y = child.arm.y;
        branch.gap_x = sign * share * d.x, branch.gap_y = sign * share * d.y;
        branch.is_held = zero;
        if (of.angle >= 0) {
            const std::size_t at =
                bundle.first_angle + kJointBlock * static_cast<std::size_t>(of.angle) + lane;
            const auto is_one = OfBundle::load(k.angles.lower + at) == OfBundle::load(k.angles.upper + at);
            branch.is_held = simd::select(is_one, one, zero);
        }
        tree.store(tree.branch(i), branch);
    }
    return is_open;
}

/// Bodies as they are alone.
template <class OfBundle, class Real>
void begin_limbs(const CloseBundles<Real>& k, const JointBundle& bundle, std::size_t lane,
                 const SweepJoints<Real>& hinges, BundleTree<OfBundle>& tree) {
    using F = typename OfBundle::Batch;
    const F zero(0), one(1);
    const auto begin = [&](std::int32_t body, const Real* per_rim) {
        const F per = OfBundle::load(per_rim), inverse = OfBundle::load_rows4(hinges.velocity, &body)[3];
        const F inverse_mass = simd::abs(inverse), half_squared = F(Real(0.5)) / (per * per);
        const F mass = simd::select(inverse_mass > zero, one / inverse_mass, one);
        // What does not turn is too heavy to.
        const F inertia = simd::select(inverse > zero, half_squared / inverse, F(Real(kNoTurn)));
        tree.store(tree.limb(body), LimbInertia<F>{mass, zero, mass, zero, zero, inertia, zero, zero, zero});
        OfBundle::store(tree.move(body) + 3 * OfBundle::size, simd::select(inverse > zero, one / per, zero));
    };
    for (std::size_t i = 0; i < bundle.branches; ++i) {
        const JointBranch& of = k.branches[bundle.first_branch + i];
        const std::size_t c = bundle.first_hinge + kJointBlock * of.hinge + lane;
        const Real *per_rim_a = hinges.joints.per_rim_a + c, *per_rim_b = hinges.joints.per_rim_b + c;
        if (i == 0) begin(of.parent, of.parent_is_a ? per_rim_a : per_rim_b);
        begin(of.child, of.parent_is_a ? per_rim_b : per_rim_a);
    }
}

/// From the leaves to the root: adds what each limb is at its hinge to its parent.
template <class OfBundle, class Real>
void gather_limbs(const CloseBundles<Real>& k, const JointBundle& bundle, BundleTree<OfBundle>& tree) {
    using F = typename OfBundle::Batch;
    const F one(1);
    for (std::size_t i = bundle.branches; i-- > 0;) {
        const JointBranch& of = k.branches[bundle.first_branch + i];
        auto branch = tree.template load<BranchGap<F>>(tree.branch(i));
        const auto child = tree.template load<LimbInertia<F>>(tree.limb(of.child));
        // The child at the hinge.
        const F rx = -branch.arm_child_y, ry = branch.arm_child_x;
        const F x = child.x - (child.xx * rx + child.xy * ry), y = child.y - (child.xy * rx + child.yy * ry);
        const F turn = child.turn - (rx * (child.x + x) + ry * (child.y + y));
        const F turns = child.turns - (rx * child.impulse_x + ry * child.impulse_y);
        const F held = branch.is_held, per_turn = (one - held) / turn;
        branch.x = x, branch.y = y, branch.per_turn = per_turn, branch.turns = turns;
        tree.store(tree.branch(i), branch);
        // Without its turn, where that is free; moved by what closes the gap.
        const F xx = child.xx - per_turn * x * x, xy = child.xy - per_turn * x * y,
                yy = child.yy - per_turn * y * y;
        const F impulse_x = child.impulse_x - per_turn * x * turns - (xx * branch.gap_x + xy * branch.gap_y),
                impulse_y = child.impulse_y - per_turn * y * turns - (xy * branch.gap_x + yy * branch.gap_y);
        const F held_x = held * x, held_y = held * y;
        const F ax = -branch.arm_parent_y, ay = branch.arm_parent_x;
        const F along_x = xx * ax + xy * ay, along_y = xy * ax + yy * ay;
        auto parent = tree.template load<LimbInertia<F>>(tree.limb(of.parent));
        parent.xx += xx, parent.xy += xy, parent.yy += yy;
        parent.x += held_x + along_x, parent.y += held_y + along_y;
        parent.turn += held * turn + (ax * (held_x + held_x + along_x) + ay * (held_y + held_y + along_y));
        parent.impulse_x += impulse_x, parent.impulse_y += impulse_y;
        parent.turns += (held * turns - (held_x * branch.gap_x + held_y * branch.gap_y)) +
                        (ax * impulse_x + ay * impulse_y);
        tree.store(tree.limb(of.parent), parent);
    }
}

/// From the root, which nothing holds unless it is the world, to the leaves: how bodies move.
template <class OfBundle, class Real>
void move_limbs(const CloseBundles<Real>& k, const JointBundle& bundle, BundleTree<OfBundle>& tree) {
    using F = typename OfBundle::Batch;
    const F zero(0), one(1);
    const auto store = [&](std::int32_t body, F x, F y, F turn) {
        auto* const to = tree.move(body);
        OfBundle::store(to, x), OfBundle::store(to + OfBundle::size, y);
        OfBundle::store(to + 2 * OfBundle::size, turn);
    };
    const std::int32_t root = k.branches[bundle.first_branch].parent;
    const auto all = tree.template load<LimbInertia<F>>(tree.limb(root));
    const F per = one / (all.xx * all.yy - all.xy * all.xy);
    const auto solve = [&](F x, F y) {
        return Pair2<F>{per * (all.yy * x - all.xy * y), per * (all.xx * y - all.xy * x)};
    };
    const Pair2<F> by_turn = solve(all.x, all.y), by_force = solve(all.impulse_x, all.impulse_y);
    const F turn = ((all.x * by_force.x + all.y * by_force.y) - all.turns) /
                   (all.turn - (all.x * by_turn.x + all.y * by_turn.y));
    if (bundle.hangs)
        store(root, zero, zero, zero);
    else
        store(root, zero - (by_force.x + turn * by_turn.x), zero - (by_force.y + turn * by_turn.y), turn);
    for (std::size_t i = 0; i < bundle.branches; ++i) {
        const JointBranch& of = k.branches[bundle.first_branch + i];
        const auto branch = tree.template load<BranchGap<F>>(tree.branch(i));
        const auto* const parent = tree.move(of.parent);
        const F turn_of_parent = OfBundle::load(parent + 2 * OfBundle::size);
        const F x = OfBundle::load(parent) - turn_of_parent * branch.arm_parent_y - branch.gap_x,
                y = OfBundle::load(parent + OfBundle::size) + turn_of_parent * branch.arm_parent_x -
                    branch.gap_y;
        const F turn_of_child =
            branch.is_held * turn_of_parent - branch.per_turn * (branch.x * x + branch.y * y + branch.turns);
        store(of.child, x + turn_of_child * branch.arm_child_y, y - turn_of_child * branch.arm_child_x,
              turn_of_child);
    }
}

/// Closes what is open of the bundles first ... last - 1. @return how many mechanisms that were
template <class Real, class Isa>
std::size_t close_bundles(const CloseBundles<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using OfBundle = simd::LanesOfBundle<Lanes>;
    using F = typename Lanes::Batch;
    const CloseBundles<Real> k = arguments;  // a copy: no store can change it
    BundleRecords<Lanes> records;
    BundleTree<OfBundle> tree;
    const SweepJoints<Real> hinges = records.over(k.hinges);
    const F zero(0);
    std::size_t closed = 0;
    for (const JointBundle* bundle = k.bundles + first; bundle != k.bundles + last; ++bundle) {
        if (bundle->branches == 0) continue;
        for (std::size_t lane = 0; lane < bundle->mechanisms; lane += Lanes::size) {
            const std::int32_t* const rows = k.rows + kJointBlock * bundle->first_body + lane;
            records.template load<true>(k.hinges, rows, bundle->bodies);
            bool has_moved = false;
            for (int round = 0; round < k.rounds; ++round) {
                const auto is_open = measure_gaps<OfBundle>(k, *bundle, lane, hinges, tree);
                if (!simd::any(is_open)) break;
                if (round == 0)
                    for (unsigned bits = simd::bitmask(is_open); bits != 0; bits &= bits - 1) ++closed;
                begin_limbs<OfBundle>(k, *bundle, lane, hinges, tree);
                gather_limbs<OfBundle>(k, *bundle, tree);
                move_limbs<OfBundle>(k, *bundle, tree);
                for (std::size_t body = 0; body < bundle->bodies; ++body) {
                    const Real* const by = tree.move(static_cast<std::int32_t>(body));
                    const auto add = [&](Real* to, F more) {
                        Lanes::store(to, Lanes::load(to) + simd::select(is_open, more, zero));
                    };
                    add(records.displacement + 2 * body * Lanes::size, Lanes::load(by));
                    add(records.displacement + (2 * body + 1) * Lanes::size, Lanes::load(by + Lanes::size));
                    add(records.turn + body * Lanes::size,
                        Lanes::load(by + 2 * Lanes::size) * Lanes::load(by + 3 * Lanes::size));
                }
                has_moved = true;
            }
            if (has_moved) records.template store<true>(k.hinges, rows, bundle->bodies);
        }
    }
    return closed;
}

}  // namespace
}  // namespace carom
