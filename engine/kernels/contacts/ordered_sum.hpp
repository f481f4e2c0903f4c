#pragma once

#include <array>

#include "kernels/contacts/contact_arguments.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Sums in double precision of numbers that come by batches of Real. Each of kContactBlock partial sums takes
/// every kContactBlock-th number, whatever the width of the lanes, so that the sums have the same bits for
/// every instruction set.
template <class Real, class Isa>
class OrderedSum {
    using Lanes = simd::Lanes<Real, Isa>;
    using Wide = simd::Lanes<double, Isa>;

  public:
    static constexpr std::size_t kBatches = kContactBlock / Lanes::size;  ///< of a block

    explicit OrderedSum(const BlockOfSums& sums) {
        for (std::size_t n = 0; n < kSums; ++n) sums_[n] = Wide::load(sums.data() + n * Wide::size);
    }
    /// @param batch  number of the batch in its block
    [[gnu::always_inline]] void add(std::size_t batch, typename Lanes::Batch values) {
        alignas(64) std::array<Real, Lanes::size> lanes;
        Lanes::store(lanes.data(), values);
        for (std::size_t n = 0; n < kSumsOfBatch; ++n)
            sums_[batch * kSumsOfBatch + n] += Wide::load_converted(lanes.data() + n * Wide::size);
    }
    void store(BlockOfSums& sums) const {
        for (std::size_t n = 0; n < kSums; ++n) Wide::store(sums.data() + n * Wide::size, sums_[n]);
    }

  private:
    static constexpr std::size_t kSums = kContactBlock / Wide::size, kSumsOfBatch = Lanes::size / Wide::size;

    std::array<typename Wide::Batch, kSums> sums_;
};

}  // namespace
}  // namespace carom
