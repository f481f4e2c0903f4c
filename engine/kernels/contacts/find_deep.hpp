#pragma once

#include "effects/contact_law.hpp"
#include "kernels/contacts/contact_arguments.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Pairs may be pushed apart so many times faster than they may close:
/// docs/decisions/0089-discs-that-are-hit.md.
inline constexpr int kParting = 3;

/// Whether a pair of [first, last) closes by more than `closes` in this substep and then overlaps by more
/// than `deep`, with the velocities of now, or is pushed apart by its impulse, kParting times as fast:
/// what sweeps have left of a hit, or of its impulses, which were foreseen once more.
template <class Real, class Isa>
bool find_deep(const SolveContacts<Real>& k, const DeepPairs<Real>& what, std::size_t first,
               std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    for (std::size_t c = first; c < last; c += Lanes::size) {
        const MovingSide<0, Lanes> a{Lanes::load_rows4(k.velocity, k.contacts.a + c)},
            b{Lanes::load_rows4(k.velocity, k.contacts.b + c)};
        const F nx = Lanes::load(k.contacts.normal_x + c), ny = Lanes::load(k.contacts.normal_y + c);
        const F velocity = normal_velocity(a, b, nx, ny);
        const F unit = k.contacts.smaller ? Lanes::load(k.contacts.smaller + c) : F(1);
        const F closing = (Lanes::load(k.contacts.floor + c) - velocity) * F(k.h),
                least = F(what.closes) * unit;
        // What a solve of the contact alone would take from its impulse, times h.
        const F mass = Lanes::load(k.contacts.mass + c),
                pushed = simd::min(Lanes::load(k.contacts.normal_impulse + c) * F(k.h), -closing * mass);
        if (simd::any(pushed > F(kParting) * least * mass)) return true;
        // Padding has no mass, and floors that nothing wrote.
        const auto closes = (closing > least) & (mass > F(0));
        if (!simd::any(closes)) continue;
        const auto moved_a = Lanes::load_rows2(k.displacement, k.contacts.a + c),
                   moved_b = Lanes::load_rows2(k.displacement, k.contacts.b + c);
        const F at_end = Lanes::load(k.contacts.separation + c) + (moved_b[0] - moved_a[0]) * nx +
                         (moved_b[1] - moved_a[1]) * ny + velocity * F(k.h);
        if (simd::any(closes & (at_end < -(F(what.deep) * unit)))) return true;
    }
    return false;
}

}  // namespace
}  // namespace carom
