#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom {

/// Connected sets of rows. What they are does not depend on the order in which rows are joined: an island is
/// known by its smallest row.
/// Source: union-find with path halving (Tarjan & van Leeuwen 1984).
class Islands {
  public:
    /// `rows` islands of one row each.
    void reset(std::size_t rows);
    void join(std::int32_t a, std::int32_t b) {
        a = island_of(a), b = island_of(b);
        // (No branch: which is the smaller cannot be foretold.)
        parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
    /// The smallest row of a row's island.
    std::int32_t island_of(std::int32_t row) {
        auto i = static_cast<std::size_t>(row);
        while (parent_[i] != static_cast<std::int32_t>(i)) {
            parent_[i] = parent_[static_cast<std::size_t>(parent_[i])];
            i = static_cast<std::size_t>(parent_[i]);
        }
        return static_cast<std::int32_t>(i);
    }

    std::size_t bytes() const { return parent_.capacity() * sizeof(std::int32_t); }

  private:
    std::vector<std::int32_t> parent_;  // never larger than the row itself
};

}  // namespace carom
