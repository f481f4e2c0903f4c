#pragma once

#include <cstdint>
#include <vector>

#include "constraints/task_groups.hpp"

namespace carom {

/// The chunks of rows (constraints/task_groups.hpp) in which the impacts of a substep have left contacts
/// closing that hold.
class ClosingChunks {
  public:
    void clear() { any_ = false; }
    void add(const TaskGroups& groups, std::int32_t row) {
        if (!any_) chunks_.assign(groups.chunks, 0);
        any_ = true, chunks_[groups.chunk_of(row)] = 1;
    }
    bool any() const { return any_; }
    /// [chunks], not 0 for these; where there are any.
    const std::vector<std::uint8_t>& chunks() const { return chunks_; }
    std::size_t bytes() const { return chunks_.capacity(); }

  private:
    bool any_ = false;
    std::vector<std::uint8_t> chunks_;
};

}  // namespace carom
