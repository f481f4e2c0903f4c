#pragma once

#include "kernels/contacts/ordered_sum.hpp"
#include "kernels/contacts/solve_contacts.hpp"

namespace carom {
namespace {

/// What contacts take: the work of their impulses on both sides. An impulse times the mean of the velocities
/// before and after a substep is its share of what the kinetic energy changes by, exactly: k.velocity has
/// these means.
/// @param last  also in the middle of a block: contacts beyond it are padding without impulses
template <unsigned kVariant, bool kOtherMoves, class Real, class Isa>
void sum_work(const SolveContacts<Real>& k, std::size_t first, std::size_t last, WorkSums& sums) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    using Sum = OrderedSum<Real, Isa>;
    Sum normal(sums.normal), tangent(sums.tangent);
    for (std::size_t block = first; block < last; block += kContactBlock)
        for (std::size_t batch = 0; batch < Sum::kBatches; ++batch) {
            const std::size_t c = block + batch * Lanes::size;
            const F nx = Lanes::load(k.contacts.normal_x + c), ny = Lanes::load(k.contacts.normal_y + c);
            const MovingSide<kVariant, Lanes> a{Lanes::load_rows4(k.velocity, k.contacts.a + c)};
            const auto b = load_other_side<kVariant, kOtherMoves, Lanes>(k, c);
            const auto impulses = load_impulses<kVariant, Lanes>(k, c);
            normal.add(batch, impulses.normal * normal_velocity(a, b, nx, ny));
            if constexpr ((kVariant & kRough) != 0) {
                F taken = impulses.tangent * tangent_velocity(a, b, nx, ny);
                if constexpr ((kVariant & kRolling) != 0)
                    taken += impulses.rolling * rolling_velocity(a, b, share_of<kVariant, Lanes>(k, c));
                tangent.add(batch, taken);
            }
        }
    normal.store(sums.normal), tangent.store(sums.tangent);
}

}  // namespace
}  // namespace carom
