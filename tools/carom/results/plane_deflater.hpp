#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "results/bit_writer.hpp"
#include "results/deflate_block.hpp"

namespace carom::tool {

/// Compresses chunks of numbers to what HDF5's filters "shuffle, then deflate" read back: first the lowest
/// byte of every number, then the next, ... as one zlib stream (RFC 1950).
///
/// With an encoder of its own, because a trajectory is written while the next steps are computed: zlib at its
/// fastest takes nine times as long on a gas and makes it larger (docs/decisions/0003-recording.md). What
/// there is to gain is known here: bytes equal to those one frame before, runs, and the frequencies of signs
/// and exponents. The low bytes of a simulation's numbers are noise and are stored.
class PlaneDeflater {
  public:
    /// @param data  a whole number of elements
    /// @param row   elements a frame: a chunk may hold several
    /// @return valid until the next call
    std::span<const std::byte> compress(std::span<const std::byte> data, std::size_t element_size,
                                        std::size_t row);

  private:
    BitWriter deflate_plane(BitWriter output, std::span<const std::byte> plane, std::size_t row);

    std::vector<std::byte> planes_;
    DeflateBlock block_;
    std::vector<std::byte> output_;
};

/// What can be gained on a plane of bytes.
enum class PlaneKind {
    noise,    ///< nothing to speak of
    uneven,   ///< some values are more frequent than others
    repeats,  ///< many bytes equal their neighbour, or the one a frame before
};

PlaneKind kind_of_plane(std::span<const std::byte> plane, std::size_t row);

}  // namespace carom::tool
