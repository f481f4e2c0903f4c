#pragma once

#include <zlib.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace carom::tool {

/// Compresses chunks of numbers to what HDF5's filters "shuffle, then deflate" read back: first the lowest
/// byte of every number, then the next, ... as one zlib stream. The low bytes of a simulation's numbers are
/// noise; such planes are stored, because deflate would spend most of the time on them to gain nothing.
class PlaneDeflater {
  public:
    PlaneDeflater();
    ~PlaneDeflater();
    PlaneDeflater(const PlaneDeflater&) = delete;
    PlaneDeflater& operator=(const PlaneDeflater&) = delete;

    /// @param data  a whole number of elements
    /// @param row   elements a frame: where a chunk holds several, equal frames compress well
    /// @return valid until the next call
    std::span<const std::byte> compress(std::span<const std::byte> data, std::size_t element_size,
                                        std::size_t row);

  private:
    void shuffle(std::span<const std::byte> data, std::size_t element_size);
    void deflate_plane(std::span<const std::byte> plane, std::size_t row);
    void finish();

    z_stream stream_{};
    std::vector<std::byte> planes_;
    std::vector<std::byte> output_;
};

/// What can be gained on a plane of bytes.
enum class PlaneKind {
    noise,    ///< nothing to speak of
    uneven,   ///< some values are more frequent than others, or come in runs
    repeats,  ///< many bytes equal those one frame before
};

PlaneKind kind_of_plane(std::span<const std::byte> plane, std::size_t row);

}  // namespace carom::tool
