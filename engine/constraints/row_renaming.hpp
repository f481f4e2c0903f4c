#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "constraints/partner.hpp"

namespace carom {

/// Where rows have gone since `start`: they are sorted now and then, and the last row takes the place of a
/// removed one.
class RowRenaming {
  public:
    static constexpr std::int32_t kGone = Partner::gone().stored();  // a row that no longer exists

    /// Follows the rows [0, rows) from here on.
    void start(std::size_t rows);
    /// Rows were sorted: new row i is the old row order[i]. Rows that were appended may be among them.
    void follow_sorted(const std::int32_t* order, std::size_t count);
    /// A body was removed; the last row took its place. Cost: O(rows) the first time since `start`, then
    /// O(1).
    void follow_removed(std::size_t row, std::size_t last);

    /// A body was appended in the place of another one, which is the last now. Cost: as follow_removed.
    void follow_made_room(std::size_t row, std::size_t last);

    /// The row at the start that a present row comes from, or kGone.
    std::int32_t old_row(std::size_t row) const {
        if (!has_moved_) return row < rows_ ? static_cast<std::int32_t>(row) : kGone;
        return row < old_row_.size() ? old_row_[row] : kGone;
    }
    /// Rows at the start.
    std::size_t rows() const { return rows_; }
    /// Whether any row may have gone elsewhere.
    bool has_moved() const { return has_moved_; }
    /// Today's row of each row at the start, or kGone, [rows at the start]. Cost: O(rows).
    const std::vector<std::int32_t>& new_rows();

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.rows_, self.has_moved_, self.old_row_);
    }

    std::size_t bytes() const { return (old_row_.capacity() + new_row_.capacity()) * sizeof(std::int32_t); }

  private:
    void keep();

    std::size_t rows_ = 0;  // at the start
    bool has_moved_ = false;
    std::vector<std::int32_t> old_row_;  // of each present row, or kGone; if something has moved
    std::vector<std::int32_t> new_row_;
};

}  // namespace carom
