#pragma once

#include "kernels/broadphase/broadphase_arguments.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// One body in every lane, to be held against batches of others.
template <class L>
struct Probe {
    typename L::Batch x, y, reach;
};

/// The lanes of the bodies at places [place, place + L::size) that are near the probe: squared distance below
/// the square of the reaches' sum. The formula decides which pairs exist: the same bits for every instruction
/// set.
template <class L, class Real>
unsigned near_lanes(const SortedBodies<Real>& bodies, std::size_t place, const Probe<L>& probe) {
    const auto dx = L::load_unaligned(bodies.x + place) - probe.x;
    const auto dy = L::load_unaligned(bodies.y + place) - probe.y;
    const auto reach = L::load_unaligned(bodies.reach + place) + probe.reach;
    return simd::bitmask(dx * dx + dy * dy < reach * reach);
}

/// Calls keep(place, lanes) for the batches that cover places [first, last); no branch depends on what is
/// near. The usual range fits one batch, so that the loop is not entered; an empty range costs the same.
template <class L, class Real, class Keep>
void scan_range(const SortedBodies<Real>& bodies, std::size_t first, std::size_t last, const Probe<L>& probe,
                const Keep& keep) {
    while (last - first > L::size) {
        keep(first, near_lanes<L>(bodies, first, probe));
        first += L::size;
    }
    const unsigned inside = (1u << (last - first)) - 1u;
    keep(first, near_lanes<L>(bodies, first, probe) & inside);
}

}  // namespace
}  // namespace carom
