#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace carom {

/// Which rows hold another body than before, and where those were: columns by row go with their bodies.
class ChangedRows {
  public:
    static constexpr std::int32_t kNone = -1;

    /// Compares rows with the former ones. Cost: O(bodies), about 1 ns each.
    /// @param count  bodies
    /// @param now  present row of each former one, or negative
    /// @param is_elsewhere  a present row, whether its body was put elsewhere
    void find(std::size_t count, std::span<const std::int32_t> now,
              std::span<const std::uint8_t> is_elsewhere) {
        old_rows_.assign(count, kNone);
        for (std::size_t old = 0; old < now.size(); ++old)
            if (now[old] >= 0 && is_elsewhere[static_cast<std::size_t>(now[old])] == 0)
                old_rows_[static_cast<std::size_t>(now[old])] = static_cast<std::int32_t>(old);
        rows_.clear();  // few
        for (std::size_t row = 0; row < count; ++row)
            if (old_rows_[row] != static_cast<std::int32_t>(row))
                rows_.push_back(static_cast<std::int32_t>(row));
    }
    /// Rows that hold another body than before, in order.
    std::span<const std::int32_t> rows() const { return rows_; }
    /// Whether the body of a row came, or was put elsewhere.
    bool is_fresh(std::int32_t row) const { return old_rows_[static_cast<std::size_t>(row)] == kNone; }

    /// A column's values go with their bodies, `width` of them to a row; it then has as many rows as there
    /// are bodies.
    /// @param of_fresh  value of a fresh row, of its number
    template <class ColumnOfRows, class OfFresh>
    void move(ColumnOfRows& column, const OfFresh& of_fresh, std::size_t width = 1) const {
        using Value = std::remove_cvref_t<decltype(column[0])>;
        std::vector<Value> moved(width * rows_.size());
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            const auto row = static_cast<std::size_t>(rows_[k]);
            const std::int32_t old = old_rows_[row];
            for (std::size_t i = 0; i < width; ++i)
                moved[width * k + i] =
                    old == kNone ? of_fresh(row) : column[width * static_cast<std::size_t>(old) + i];
        }
        column.resize(width * old_rows_.size());
        for (std::size_t k = 0; k < rows_.size(); ++k)
            for (std::size_t i = 0; i < width; ++i)
                column[width * static_cast<std::size_t>(rows_[k]) + i] = moved[width * k + i];
    }

    std::size_t bytes() const { return (old_rows_.capacity() + rows_.capacity()) * sizeof(std::int32_t); }

  private:
    std::vector<std::int32_t> old_rows_;  // by row; kNone: it is fresh
    std::vector<std::int32_t> rows_;
};

}  // namespace carom
