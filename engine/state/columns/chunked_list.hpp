#pragma once

#include <cstdint>
#include <vector>

#include "parallel/executor.hpp"
#include "state/columns/column.hpp"

namespace carom {

/// Lists that chunks of a kernel write side by side, each into its own part, and that are then joined in
/// order.
class ChunkedList {
  public:
    /// Room for `rows` in chunks of `rows_per_chunk`, and a batch more for each.
    /// @param rows_per_chunk  a multiple of kRowPadding: chunks side by side write whole batches
    void prepare(std::size_t rows, std::size_t rows_per_chunk) {
        const std::size_t chunks = (rows + rows_per_chunk - 1) / rows_per_chunk;
        stride_ = rows_per_chunk + kRowPadding;
        numbers_.resize_for_overwrite(padded(rows) + chunks * kRowPadding);
        counts_.assign(chunks, 0);
    }
    std::int32_t* part(std::size_t chunk) { return numbers_.data() + chunk * stride_; }
    void set_count(std::size_t chunk, std::size_t count) { counts_[chunk] = count; }

    /// Lists the numbers below `count` for which is_chosen(number) holds, on all threads.
    /// @param nanoseconds  about what one takes on one thread
    template <class Chosen>
    void choose(std::size_t count, double nanoseconds, const Executor& executor, const Chosen& is_chosen) {
        prepare(count, kRowsPerTask);
        executor.for_each_chunk(count, kRowsPerTask, nanoseconds,
                                [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                    std::int32_t* const out = part(chunk);
                                    std::size_t chosen = 0;
                                    for (std::size_t n = first; n < last; ++n) {
                                        out[chosen] = static_cast<std::int32_t>(n);
                                        chosen += is_chosen(n) ? 1 : 0;
                                    }
                                    set_count(chunk, chosen);
                                });
    }
    /// Calls fn(number) for everything listed, in order.
    template <class Fn>
    void for_each(const Fn& fn) const {
        for (std::size_t c = 0; c < counts_.size(); ++c)
            for (std::size_t n = 0; n < counts_[c]; ++n) fn(numbers_[c * stride_ + n]);
    }
    /// Calls fn(number) for everything listed, below `limit`: padding rows may be listed too.
    template <class Fn>
    void for_each_below(std::size_t limit, const Fn& fn) const {
        for (std::size_t c = 0; c < counts_.size(); ++c)
            for (std::size_t n = 0; n < counts_[c]; ++n)
                if (const auto number = numbers_[c * stride_ + n]; static_cast<std::size_t>(number) < limit)
                    fn(number);
    }

    std::size_t bytes() const { return numbers_.bytes() + counts_.capacity() * sizeof(std::size_t); }

  private:
    static constexpr std::size_t kRowsPerTask = 1024;

    Column<std::int32_t> numbers_;
    std::vector<std::size_t> counts_;
    std::size_t stride_ = 0;
};

}  // namespace carom
