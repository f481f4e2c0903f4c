#pragma once

#include "kernels/broadphase/candidate_offsets.hpp"
#include "kernels/broadphase/scan_range.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Bit 16 j + i is set if the bodies at place + i and place + i + offset + j are near each other. Both sides
/// are plain loads, and every lane is in use.
template <class L, class Real>
std::uint64_t near_word(const SortedBodies<Real>& bodies, std::size_t place, std::int32_t offset) {
    std::uint64_t word = 0;
    for (std::int32_t j = 0; j < kOffsetsPerWord; ++j)
        for (std::size_t i = 0; i < kBlockPlaces; i += L::size) {
            const std::size_t a = place + i, b = a + static_cast<std::size_t>(offset + j);
            const auto dx = L::load_unaligned(bodies.x + b) - L::load(bodies.x + a);
            const auto dy = L::load_unaligned(bodies.y + b) - L::load(bodies.y + a);
            const auto reach = L::load_unaligned(bodies.reach + b) + L::load(bodies.reach + a);
            const std::uint64_t near = simd::bitmask(dx * dx + dy * dy < reach * reach);
            word |= near << (static_cast<std::size_t>(j) * kBlockPlaces + i);
        }
    return word;
}

template <class Isa, class Real, int kRows>
std::size_t append_block(const GridLevel<Real>& level, std::size_t place, const Offsets (&rows)[kRows],
                         const FindCandidates<Real>& k, std::size_t count) {
    const std::int32_t* row_of = level.bodies.row + place;
    for (const Offsets& row : rows)
        for (std::int32_t offset = row.first; offset < row.last; offset += kOffsetsPerWord) {
            const std::uint64_t near = near_word<simd::Lanes<Real, Isa>>(level.bodies, place, offset);
            count += simd::Lanes<float, Isa>::store_marked_pairs(k.a + count, k.b + count, row_of,
                                                                 row_of + offset, near);
        }
    return count;
}

/// Each body of a block against its own neighbours: for blocks that have bodies of places far apart or of
/// very different density, where the block as a whole would visit many offsets for the sake of a few bodies.
template <class Isa, bool kWraps, class Real>
std::size_t append_bodies(const GridLevel<Real>& level, std::size_t first, std::size_t last,
                          const FindCandidates<Real>& k, std::size_t count) {
    using L = simd::Lanes<Real, Isa>;
    const SortedBodies<Real>& bodies = level.bodies;
    for (std::size_t place = first; place < last; ++place) {
        const Probe<L> probe{L::broadcast(bodies.x[place]), L::broadcast(bodies.y[place]),
                             L::broadcast(bodies.reach[place])};
        const auto row_of_a = L::broadcast_row(bodies.row[place]);
        for (const Offsets& row : body_offsets<kWraps>(level, place).rows) {
            if (row.count() == 0) continue;
            scan_range<L>(bodies, place + static_cast<std::size_t>(row.first),
                          place + static_cast<std::size_t>(row.last), probe,
                          [&](std::size_t at, unsigned lanes) {
                              L::store_rows(k.a + count, row_of_a);
                              count += L::compress_store(k.b + count, L::load_rows(bodies.row + at), lanes);
                          });
        }
    }
    return count;
}

constexpr std::int32_t kLongBlock = 96;  // offsets; the gas has 8 ... 30

/// Whether the block's offsets are more work than its bodies one by one: a batch of a body's neighbours costs
/// about two offsets of a block (docs/decisions/0001-broadphase.md). The same on every instruction set.
template <bool kWraps, class Real>
bool is_better_one_by_one(const GridLevel<Real>& level, std::size_t first, std::size_t last,
                          const BlockOffsets<kWraps>& block) {
    if (block.count() <= kLongBlock) return false;
    std::int64_t batches = 0;
    for (std::size_t place = first; place < last; ++place)
        batches += BlockOffsets<kWraps>::kRows + body_offsets<kWraps>(level, place).count() / 16;
    return block.count() > 2 * batches;
}

template <class Real, class Isa, bool kWraps>
std::size_t find_candidates_numbered(FindCandidates<Real>& k) {
    // Offsets are found for many blocks ahead: loops whose length is known early are left without a stall.
    constexpr std::size_t kPlacesAhead = 64 * kBlockPlaces;
    BlockOffsets<kWraps> offsets[64];
    const GridLevel<Real>& level = *k.level;
    const auto earlier = [](std::size_t p, std::size_t q) { return p < q ? p : q; };
    for (std::size_t first = k.first; first < k.last; first += kPlacesAhead) {
        const std::size_t last = earlier(first + kPlacesAhead, k.last);
        for (std::size_t place = first; place < last; place += kBlockPlaces)
            offsets[(place - first) / kBlockPlaces] = block_offsets<Isa, kWraps>(level, place);
        for (std::size_t place = first; place < last; place += kBlockPlaces) {
            const BlockOffsets<kWraps>& block = offsets[(place - first) / kBlockPlaces];
            const auto most = kBlockPlaces * static_cast<std::size_t>(block.count() + kOffsetsPerWord);
            if (k.count + most > k.capacity) return place;
            const std::size_t end = earlier(place + kBlockPlaces, level.places);
            k.count = is_better_one_by_one(level, place, end, block)
                          ? append_bodies<Isa, kWraps>(level, place, end, k, k.count)
                          : append_block<Isa>(level, place, block.rows, k, k.count);
        }
    }
    return k.last;
}

/// Returns the place it has come to: k.last, or less if a and b have no room for the next block's pairs.
/// k.first is a multiple of kBlockPlaces.
template <class Real, class Isa>
std::size_t find_candidates(FindCandidates<Real>& k) {
    if (k.level->numbering.wraps) return find_candidates_numbered<Real, Isa, true>(k);
    return find_candidates_numbered<Real, Isa, false>(k);
}

}  // namespace
}  // namespace carom
