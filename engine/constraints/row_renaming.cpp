#include "constraints/row_renaming.hpp"

#include <numeric>

namespace carom {

void RowRenaming::start(std::size_t rows) {
    rows_ = rows;
    has_moved_ = false;
}

/// Starts the list of old rows, if nothing has moved so far.
void RowRenaming::keep() {
    if (has_moved_) return;
    has_moved_ = true;
    old_row_.resize(rows_);
    std::iota(old_row_.begin(), old_row_.end(), 0);
}

void RowRenaming::follow_sorted(const std::int32_t* order, std::size_t count) {
    keep();
    new_row_.resize(count);
    for (std::size_t row = 0; row < count; ++row) {
        const auto old = static_cast<std::size_t>(order[row]);
        new_row_[row] = old < old_row_.size() ? old_row_[old] : kGone;  // or it was appended
    }
    old_row_.swap(new_row_);
}

void RowRenaming::follow_removed(std::size_t row, std::size_t last) {
    keep();
    if (old_row_.size() <= last) old_row_.resize(last + 1, kGone);
    old_row_[row] = old_row_[last];
    old_row_.resize(last);
}

void RowRenaming::follow_made_room(std::size_t row, std::size_t last) {
    keep();
    if (old_row_.size() <= last) old_row_.resize(last + 1, kGone);
    old_row_[last] = old_row_[row];
    old_row_[row] = kGone;
}

const std::vector<std::int32_t>& RowRenaming::new_rows() {
    keep();
    new_row_.assign(rows_, kGone);
    for (std::size_t row = 0; row < old_row_.size(); ++row)
        if (old_row_[row] != kGone)
            new_row_[static_cast<std::size_t>(old_row_[row])] = static_cast<std::int32_t>(row);
    return new_row_;
}

}  // namespace carom
