#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "state/columns/changed_rows.hpp"
#include "state/columns/column.hpp"

namespace carom {

/// What became of the rows of bodies since the grid was built: it knows a body by the row that it had then,
/// its name. A body that came since, or was put elsewhere, is loose: it has no name, and the grid does not
/// find it.
///
/// As long as no row has changed, rows are names, and nothing is stored.
class RowNames {
  public:
    /// Whether no row has changed since the grid was built, or since `forget`.
    bool empty() const { return row_of_name_.empty(); }
    /// Rows are names again: the grid was built anew.
    void forget();

    /// Follows rows that changed. Cost: O(bodies), about 1 ns each.
    /// @param count  bodies
    /// @param now  present row of each former one, or negative
    /// @param is_elsewhere  a present row, whether its body was put elsewhere
    /// @return how many former rows hold no body that stayed.
    std::size_t follow(std::size_t count, std::span<const std::int32_t> now,
                       std::span<const std::uint8_t> is_elsewhere);
    /// A column's values go with their bodies, as the last `follow` found them to go.
    /// @param of_fresh  value of a row that is loose since then, of its number
    template <class ColumnOfRows, class OfFresh>
    void move(ColumnOfRows& column, const OfFresh& of_fresh) const {
        changed_.move(column, of_fresh);
    }

    /// The name of a row that is not loose.
    std::size_t name_of(std::size_t row) const {
        return empty() ? row : static_cast<std::size_t>(name_of_[row]);
    }
    bool is_loose(std::size_t row) const { return !loose_rows_.empty() && is_loose_[row]; }
    std::size_t loose_count() const { return loose_rows_.size(); }

    /// Turns names that the grid has found into rows, and adds all loose ones.
    /// @param found  names in `rows`
    /// @return how many rows are in `rows`.
    std::size_t to_rows(Column<std::int32_t>& rows, std::size_t found) const;

    /// Loose rows whose pairs are yet to be found.
    std::size_t fresh_count() const { return fresh_rows_.size(); }
    /// Moves them to the strays, which stay in order, each once.
    void take_fresh(std::vector<std::int32_t>& strays);

    /// Rows in an order of names, the loose ones last; where some row has changed.
    /// @param count  bodies
    void sort(std::span<const std::int32_t> names, std::size_t count);
    const std::vector<std::int32_t>& sorted_rows() const { return sorted_rows_; }  ///< as `sort` left them

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.row_of_name_, self.name_of_, self.is_loose_, self.loose_rows_, self.fresh_rows_);
    }
    std::size_t bytes() const;

  private:
    static constexpr std::int32_t kNone = ChangedRows::kNone;

    std::vector<std::int32_t> row_of_name_;  // kNone: the body is gone, or loose
    std::vector<std::int32_t> name_of_;      // of a row; kNone: loose
    std::vector<std::uint8_t> is_loose_;     // a row
    std::vector<std::int32_t> loose_rows_, fresh_rows_;
    std::vector<std::int32_t> sorted_rows_;
    ChangedRows changed_;  // by the last `follow`
};

}  // namespace carom
