#include "broadphase/row_names.hpp"

#include <algorithm>
#include <numeric>

namespace carom {

void RowNames::forget() {
    row_of_name_.clear(), name_of_.clear(), is_loose_.clear(), loose_rows_.clear(), fresh_rows_.clear();
}

std::size_t RowNames::follow(std::size_t count, std::span<const std::int32_t> now,
                             std::span<const std::uint8_t> is_elsewhere) {
    const auto is_gone = [&](std::int32_t row) {
        return row < 0 || is_elsewhere[static_cast<std::size_t>(row)] != 0;
    };
    if (empty()) {
        row_of_name_.resize(now.size()), name_of_.resize(now.size());
        std::iota(row_of_name_.begin(), row_of_name_.end(), 0);
        std::iota(name_of_.begin(), name_of_.end(), 0);
        is_loose_.assign(now.size(), 0);
    }
    std::size_t gone = 0;
    for (std::size_t old = 0; old < now.size(); ++old) {
        if (!is_gone(now[old])) continue;
        if (name_of_[old] >= 0) row_of_name_[static_cast<std::size_t>(name_of_[old])] = kNone;
        ++gone;
    }
    changed_.find(count, now, is_elsewhere);
    move(name_of_, [](std::size_t) { return kNone; });
    move(is_loose_, [](std::size_t) { return std::uint8_t{1}; });
    for (const std::int32_t row : changed_.rows()) {
        const std::int32_t name = name_of_[static_cast<std::size_t>(row)];
        if (name >= 0) row_of_name_[static_cast<std::size_t>(name)] = row;
        if (changed_.is_fresh(row)) fresh_rows_.push_back(row);
    }
    std::erase_if(loose_rows_, [&](std::int32_t& row) {
        row = now[static_cast<std::size_t>(row)];
        return is_gone(row);
    });
    loose_rows_.insert(loose_rows_.end(), fresh_rows_.begin(), fresh_rows_.end());
    return gone;
}

std::size_t RowNames::to_rows(Column<std::int32_t>& rows, std::size_t found) const {
    if (empty()) return found;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < found; ++k) {
        const std::int32_t row = row_of_name_[static_cast<std::size_t>(rows[k])];
        if (row >= 0 && !is_loose(static_cast<std::size_t>(row))) rows[kept++] = row;
    }
    if (rows.size() < kept + loose_rows_.size()) rows.resize(kept + loose_rows_.size());
    for (const std::int32_t row : loose_rows_) rows[kept++] = row;
    return kept;
}

void RowNames::take_fresh(std::vector<std::int32_t>& strays) {
    if (fresh_rows_.empty()) return;
    strays.insert(strays.end(), fresh_rows_.begin(), fresh_rows_.end());
    std::sort(strays.begin(), strays.end());
    strays.erase(std::unique(strays.begin(), strays.end()), strays.end());
    fresh_rows_.clear();
}

void RowNames::sort(std::span<const std::int32_t> names, std::size_t count) {
    if (empty()) return;
    sorted_rows_.clear();
    for (const std::int32_t name : names) {
        const std::int32_t row = row_of_name_[static_cast<std::size_t>(name)];
        if (row >= 0) sorted_rows_.push_back(row);
    }
    for (std::size_t row = 0; row < count; ++row)
        if (name_of_[row] < 0) sorted_rows_.push_back(static_cast<std::int32_t>(row));
}

std::size_t RowNames::bytes() const {
    const std::size_t numbers = row_of_name_.capacity() + name_of_.capacity() + loose_rows_.capacity() +
                                fresh_rows_.capacity() + sorted_rows_.capacity();
    return is_loose_.capacity() + changed_.bytes() + numbers * sizeof(std::int32_t);
}

}  // namespace carom
