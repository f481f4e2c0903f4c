#pragma once

#include "kernels/joints/joint_arguments.hpp"
#include "kernels/manifolds/turn_angles.hpp"
#include "simd/bundle_lanes.hpp"
#include "simd/lanes.hpp"

// Where the joints of crowds are at the start of a step, a mechanism a lane, in double precision: with the
// bits of what solvers/joints/swept_joints_of_step.cpp does joint by joint. What both joints of a body ask
// for, its place and how it is turned, is found once.

namespace carom {
namespace {

/// The bodies of a batch of mechanisms: [bodies][lanes].
template <class Lanes>
struct BundleStart {
    static constexpr std::size_t kBatches = kMostBodiesOfBundle * Lanes::size;
    using Numbers = double[kBatches];
    alignas(64) Numbers x, y, angle;   // m, rad
    alignas(64) Numbers cosine, sine;  // of the angle
    alignas(64) Numbers moment;        // N s m, by which joints turn it back
    alignas(64) Numbers seen;          // no unit, as JointColumns::seen_a

    /// Places, and how bodies are turned; no moments. Lanes without a mechanism have those of the first.
    template <class Real>
    void load(const BeginBundles<Real>& k, std::size_t number, std::size_t lane) {
        const JointBundle& bundle = k.bundles[number];
        const std::int32_t* rows = k.rows + kJointBlock * bundle.first_body;
        for (std::size_t body = 0; body < bundle.bodies; ++body, rows += kJointBlock) {
            const std::size_t first = body * Lanes::size;
            for (std::size_t l = 0; l < Lanes::size; ++l) {
                const std::size_t mechanism = lane + l < bundle.mechanisms ? lane + l : 0;
                if (bundle.hangs && body == 0) {
                    const std::size_t place = kJointBlock * number + mechanism;
                    x[l] = k.hung_x[place], y[l] = k.hung_y[place], angle[l] = 0;
                    continue;
                }
                const auto row = static_cast<std::size_t>(rows[mechanism]);
                x[first + l] = static_cast<double>(k.position_x[row]);
                y[first + l] = static_cast<double>(k.position_y[row]);
                angle[first + l] = k.angle ? static_cast<double>(k.angle[row]) : 0;
            }
            typename Lanes::Batch c, s;
            turn_batch<Lanes>(Lanes::load(angle + first), c, s);
            Lanes::store(cosine + first, c), Lanes::store(sine + first, s);
            Lanes::store(moment + first, typename Lanes::Batch(0));
        }
    }
};

/// Rounds to the precision of the world.
template <class Lanes, class Real>
[[gnu::always_inline]] inline void store_rounded(Real* to, typename Lanes::Batch values) {
    alignas(64) double numbers[Lanes::size];
    Lanes::store(numbers, values);
    for (std::size_t l = 0; l < Lanes::size; ++l) to[l] = static_cast<Real>(numbers[l]);
}

/// Hinges: from centre to centre, arms, and the moments of what they gave in the step before.
/// @return the longest component of an arm, lane by lane [m]
template <class Lanes, class Real>
typename Lanes::Batch begin_hinges_of_bundle(const BeginBundles<Real>& k, const JointBundle& bundle,
                                             std::size_t lane, BundleStart<Lanes>& start) {
    using F = typename Lanes::Batch;
    using OfBundle = simd::LanesOfBundle<Lanes>;
    const JointColumns<Real>& joints = k.hinges;
    F longest(0);
    for (std::size_t j = 0; j < bundle.hinges; ++j) {
        const std::size_t c = bundle.first_hinge + kJointBlock * j + lane;
        const F pull_x = Lanes::load_converted(joints.impulse_x + c),
                pull_y = Lanes::load_converted(joints.impulse_y + c);
        // By the rotation of the body; and what the joint turns it back by.
        const auto begin_arm = [&](const std::int32_t* number, const double* anchor_x, const double* anchor_y,
                                   Real* arm_x, Real* arm_y, F sign) __attribute__((always_inline)) {
            const F cosine = OfBundle::gather_at(start.cosine, number),
                    sine = OfBundle::gather_at(start.sine, number);
            const F ax = Lanes::load(anchor_x + c), ay = Lanes::load(anchor_y + c);
            const F x = cosine * ax - sine * ay, y = sine * ax + cosine * ay;
            store_rounded<Lanes>(arm_x + c, x), store_rounded<Lanes>(arm_y + c, y);
            OfBundle::add_at(start.moment, number, sign * (x * pull_x + y * pull_y));
            longest = simd::max(longest, simd::max(simd::abs(x), simd::abs(y)));
        };
        const std::int32_t *a = joints.a + c, *b = joints.b + c;
        begin_arm(a, k.anchor_a_x, k.anchor_a_y, joints.start_arm_a_x, joints.start_arm_a_y, F(-1));
        begin_arm(b, k.anchor_b_x, k.anchor_b_y, joints.start_arm_b_x, joints.start_arm_b_y, F(1));
        store_rounded<Lanes>(joints.start_x + c,
                             OfBundle::gather_at(start.x, b) - OfBundle::gather_at(start.x, a));
        store_rounded<Lanes>(joints.start_y + c,
                             OfBundle::gather_at(start.y, b) - OfBundle::gather_at(start.y, a));
    }
    return longest;
}

/// The bundles first ... last - 1 at the start of a step.
template <class Real, class Isa>
void begin_bundles(const BeginBundles<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<double, Isa>;
    using F = typename Lanes::Batch;
    using OfBundle = simd::LanesOfBundle<Lanes>;
    const BeginBundles<Real> k = arguments;  // a copy: no store can change it
    BundleStart<Lanes> start;
    for (std::size_t number = first; number < last; ++number) {
        const JointBundle& bundle = k.bundles[number];
        double longest = 0;
        for (std::size_t lane = 0; lane < bundle.mechanisms; lane += Lanes::size) {
            start.load(k, number, lane);
            alignas(64) double longest_of[Lanes::size];
            Lanes::store(longest_of, begin_hinges_of_bundle<Lanes>(k, bundle, lane, start));
            for (const double one : longest_of) longest = one > longest ? one : longest;
            const F one(1), zero(0);
            for (std::size_t body = 0; body < bundle.bodies; ++body) {
                const F moment = Lanes::load(start.moment + body * Lanes::size),
                        inertia = Lanes::load(k.inertia + (bundle.first_body + body) * kJointBlock + lane),
                        least = F(k.least_inertia) * moment;
                const auto is_less = (moment > zero) & (least > inertia);
                Lanes::store(start.seen + body * Lanes::size, simd::select(is_less, inertia / least, one));
            }
            const auto store_seen = [&](const JointColumns<Real>& joints, std::size_t c) {
                store_rounded<Lanes>(joints.seen_a + c, OfBundle::gather_at(start.seen, joints.a + c));
                store_rounded<Lanes>(joints.seen_b + c, OfBundle::gather_at(start.seen, joints.b + c));
            };
            for (std::size_t j = 0; j < bundle.hinges; ++j)
                store_seen(k.hinges, bundle.first_hinge + kJointBlock * j + lane);
            for (std::size_t j = 0; j < bundle.angles; ++j) {
                const std::size_t c = bundle.first_angle + kJointBlock * j + lane;
                store_seen(k.angles, c);
                store_rounded<Lanes>(k.angles.start_x + c,
                                     OfBundle::gather_at(start.angle, k.angles.b + c) -
                                         OfBundle::gather_at(start.angle, k.angles.a + c) -
                                         Lanes::load(k.angle_at_zero + c));
            }
        }
        k.longest[number] = longest;
    }
}

}  // namespace
}  // namespace carom
