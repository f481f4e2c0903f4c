#pragma once

#include "kernels/joints/sweep_drives.hpp"
#include "kernels/joints/sweep_joints.hpp"
#include "simd/bundle_lanes.hpp"

// Crowds of mechanisms that are joined alike, a lane each. A sweep over joints mostly fetches and stores the
// records of their bodies; a mechanism's are fetched once for all sweeps over it, and stored once. What is
// done to each mechanism is what sweep_joints.hpp and sweep_drives.hpp do to it.
// docs/decisions/0090-crowds-of-mechanisms.md.

namespace carom {
namespace {

/// The bodies of a batch of mechanisms: [bodies][numbers of a record][lanes].
template <class Lanes>
struct BundleRecords {
    using Number = typename Lanes::Number;
    static constexpr std::size_t kBatches = kMostBodiesOfBundle * Lanes::size;
    alignas(64) Number velocity[4 * kBatches];
    alignas(64) Number displacement[2 * kBatches];
    alignas(64) Number turn[kBatches];

    /// @param rows  [bodies][kJointBlock], of the first lane  @param sweep  has the columns that they are of
    template <bool kPlaces>
    void load(const SweepJoints<Number>& sweep, const std::int32_t* rows, std::size_t bodies) {
        for (std::size_t body = 0; body < bodies; ++body, rows += kJointBlock) {
            const auto record = Lanes::load_rows4(sweep.velocity, rows);
            for (std::size_t i = 0; i < 4; ++i)
                Lanes::store(velocity + (4 * body + i) * Lanes::size, record[i]);
            if constexpr (kPlaces) {
                const auto moved = Lanes::load_rows2(sweep.displacement, rows);
                for (std::size_t i = 0; i < 2; ++i)
                    Lanes::store(displacement + (2 * body + i) * Lanes::size, moved[i]);
                Lanes::store(turn + body * Lanes::size, Lanes::gather_at(sweep.turn, rows));
            }
        }
    }
    template <bool kPlaces>
    void store(const SweepJoints<Number>& sweep, const std::int32_t* rows, std::size_t bodies) const {
        for (std::size_t body = 0; body < bodies; ++body, rows += kJointBlock) {
            const Number* const record = velocity + 4 * body * Lanes::size;
            Lanes::store_rows4(
                sweep.velocity, rows,
                {{Lanes::load(record), Lanes::load(record + Lanes::size),
                  Lanes::load(record + 2 * Lanes::size), Lanes::load(record + 3 * Lanes::size)}});
            if constexpr (kPlaces) {
                const Number* const moved = displacement + 2 * body * Lanes::size;
                Lanes::store_rows2(sweep.displacement, rows,
                                   {{Lanes::load(moved), Lanes::load(moved + Lanes::size)}});
                Lanes::scatter_at(sweep.turn, rows, Lanes::load(turn + body * Lanes::size));
            }
        }
    }
    /// The same sweep over these records.
    SweepJoints<Number> over(SweepJoints<Number> sweep) {
        sweep.velocity = velocity, sweep.displacement = displacement, sweep.turn = turn;
        return sweep;
    }
};

/// Two sweeps over the bundles first ... last - 1.
/// @tparam kBegins  whether the first of them is that of a substep
template <bool kBegins, class Real, class Isa>
void sweep_bundles_twice(const SweepBundles<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using OfBundle = simd::LanesOfBundle<Lanes>;
    BundleRecords<Lanes> records;
    const SweepJoints<Real> hinges = records.over(k.hinges), angles = records.over(k.angles);
    for (const JointBundle* bundle = k.bundles + first; bundle != k.bundles + last; ++bundle) {
        for (std::size_t lane = 0; lane < bundle->mechanisms; lane += Lanes::size) {
            const std::int32_t* const rows = k.rows + kJointBlock * bundle->first_body + lane;
            records.template load<kBegins>(k.hinges, rows, bundle->bodies);
            const auto for_each_joint = [&](const auto& of_hinges, const auto& of_angles)
                __attribute__((always_inline)) {
                for (std::size_t j = 0; j < bundle->hinges; ++j)
                    of_hinges(bundle->first_hinge + kJointBlock * j + lane);
                for (std::size_t j = 0; j < bundle->angles; ++j)
                    of_angles(bundle->first_angle + kJointBlock * j + lane);
            };
            if constexpr (kBegins) {
                if (k.gives)
                    for_each_joint([&](std::size_t c) { give_batch_of_hinges<OfBundle>(hinges, c); },
                                   [&](std::size_t c) { give_batch_of_angles<OfBundle>(angles, c); });
                for_each_joint([&](std::size_t c) { sweep_batch_of_hinges<OfBundle, true>(hinges, c); },
                               [&](std::size_t c) { sweep_batch_of_angles<OfBundle, true>(angles, c); });
            }
            for (int sweep = kBegins ? 1 : 0; sweep < 2; ++sweep)
                for_each_joint([&](std::size_t c) { sweep_batch_of_hinges<OfBundle, false>(hinges, c); },
                               [&](std::size_t c) { sweep_batch_of_angles<OfBundle, false>(angles, c); });
            records.template store<kBegins>(k.hinges, rows, bundle->bodies);
        }
    }
}

template <class Real, class Isa>
void sweep_bundles(const SweepBundles<Real>& arguments, std::size_t first, std::size_t last) {
    const SweepBundles<Real> k = arguments;  // a copy: no store can change it
    if (k.begins)
        sweep_bundles_twice<true, Real, Isa>(k, first, last);
    else
        sweep_bundles_twice<false, Real, Isa>(k, first, last);
}

}  // namespace
}  // namespace carom
