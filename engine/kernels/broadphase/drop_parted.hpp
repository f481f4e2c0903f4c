#pragma once

#include "kernels/broadphase/broadphase_arguments.hpp"
#include "narrowphase/rectangle_gap.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

template <class L, class Real>
[[gnu::always_inline]] inline Rectangle<typename L::Batch> load_rectangle(const DropParted<Real>& k,
                                                                          const std::int32_t* rows,
                                                                          typename L::Batch& grows) {
    const auto pose = L::load_rows4(k.pose, rows), size = L::load_rows4(k.size, rows);
    grows = size[2];
    return {pose[0], pose[1], pose[2], pose[3], size[0], size[1]};
}

/// Keeps the pairs whose rectangles may come to overlap, in their order.
/// @return how many they are
template <class Real, class Isa>
std::size_t drop_parted(const DropParted<Real>& k) {
    using L = simd::Lanes<Real, Isa>;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < k.count; i += L::size) {
        typename L::Batch grows_a, grows_b;
        const auto a = load_rectangle<L>(k, k.a + i, grows_a), b = load_rectangle<L>(k, k.b + i, grows_b);
        const auto is_near = rectangle_gap(a, b) <= grows_a + grows_b;
        unsigned bits = static_cast<unsigned>(simd::bitmask(is_near));
        if (k.count - i < L::size) bits &= (1u << (k.count - i)) - 1;
        const auto rows_a = L::load_rows(k.a + i), rows_b = L::load_rows(k.b + i);
        L::compress_store(k.a + kept, rows_a, bits);
        kept += L::compress_store(k.b + kept, rows_b, bits);
    }
    return kept;
}

}  // namespace
}  // namespace carom
