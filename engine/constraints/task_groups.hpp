#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace carom {

/// How contacts are shared out among threads.
///
/// Rows lie in the order of cells, line by line, so that a chunk of consecutive rows is a strip of the plane
/// and most contacts are inside one chunk or across the border to the next. Then a sweep over all contacts
/// has two parts, within each of which no two tasks touch the same body:
///
///   part 1, task t:  inside chunk 2t, across 2t | 2t+1, inside 2t+1
///   part 2, task t:  across 2t-1 | 2t, supports of 2t-1 and of 2t
///
/// and a task shares bodies with tasks t-1, t and t+1 of the part before at most.
/// What is left, contacts of chunks that are no neighbours, is far: solved alone between the two. The groups
/// depend on rows and pairs, never on threads.
struct TaskGroups {
    TaskGroups() = default;  // one chunk
    TaskGroups(std::size_t rows, std::size_t count)
        : rows_per_chunk(rows), chunks(count), shift_(31 + static_cast<unsigned>(std::bit_width(rows - 1))) {
        reciprocal_ = ((std::uint64_t{1} << shift_) + rows - 1) / rows;
    }

    std::size_t rows_per_chunk = SIZE_MAX;
    std::size_t chunks = 1;

    /// row / rows_per_chunk: it is asked for every pair, and a division would be most of that.
    std::size_t chunk_of(std::int32_t row) const {
        return static_cast<std::size_t>(row) * reciprocal_ >> shift_;
    }

    // Groups of pairs. The last chunk has no next one: the number of its border is that of the far group.
    std::size_t count() const { return 2 * chunks; }
    static std::size_t inside(std::size_t chunk) { return 2 * chunk; }
    static std::size_t across(std::size_t chunk) { return 2 * chunk + 1; }
    bool has_border(std::size_t chunk) const { return chunk + 1 < chunks; }
    std::size_t far() const { return 2 * chunks - 1; }
    /// @param a, b  rows, a < b
    std::size_t group_of(std::int32_t a, std::int32_t b) const {
        const std::size_t chunk = chunk_of(a), steps = chunk_of(b) - chunk;
        return steps < 2 ? 2 * chunk + steps : far();
    }

    /// Whether a group of pairs may have bodies of chunks that are marked; far ones may be anywhere.
    /// @param is_marked  [chunks], not 0 for those
    template <class Marks>
    bool touches(std::size_t group, const Marks& is_marked) const {
        const std::size_t chunk = group / 2;
        if (group == far()) return true;
        return is_marked[chunk] != 0 || (group % 2 == 1 && is_marked[chunk + 1] != 0);
    }

    // Groups of supports: one a chunk, and one for those that found no colour.
    std::size_t support_count() const { return chunks + 1; }

    /// Tasks of each part; the first or the last of them can be empty in one.
    std::size_t tasks() const { return chunks / 2 + 1; }

  private:
    // With l bits for rows_per_chunk the reciprocal, rounded up, is too large by less than 2^l / 2^shift;
    // times any row below 2^31 that never reaches the next whole number (Granlund & Montgomery 1994).
    unsigned shift_ = 0;
    std::uint64_t reciprocal_ = 0;  // 2^shift / rows_per_chunk; zero: all rows are in chunk 0
};

}  // namespace carom
