// Rows that come, go or are put elsewhere while the candidate pairs stay (MarginRule::own).
#include <algorithm>
#include <numeric>

#include "broadphase/candidates.hpp"

namespace carom {

/// What the grid finds, in terms of today's rows, and all bodies that it knows nothing of.
template <class Real>
std::size_t Candidates<Real>::find_rows_near(Vec2 place, double reach, Column<std::int32_t>& out) const {
    std::size_t found = find_near(place, reach, out);
    if (!is_renamed()) return found;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < found; ++k) {
        const std::int32_t row = row_of_name_[static_cast<std::size_t>(out[k])];
        if (row >= 0 && !is_loose(static_cast<std::size_t>(row))) out[kept++] = row;
    }
    if (out.size() < kept + loose_rows_.size()) out.resize(kept + loose_rows_.size());
    for (const std::int32_t row : loose_rows_) out[kept++] = row;
    return kept;
}

template <class Real>
void Candidates<Real>::forget_names() {
    row_of_name_.clear(), name_of_.clear(), is_loose_.clear(), loose_rows_.clear(), fresh_rows_.clear();
}

/// Fresh rows get their margins, and pairs, with those that leave theirs.
template <class Real>
void Candidates<Real>::add_fresh_strays() {
    if (fresh_rows_.empty()) return;
    strays_.insert(strays_.end(), fresh_rows_.begin(), fresh_rows_.end());
    std::sort(strays_.begin(), strays_.end());
    strays_.erase(std::unique(strays_.begin(), strays_.end()), strays_.end());
    fresh_rows_.clear();
}

template <class Real>
void Candidates<Real>::follow_rows(const Bodies<Real>& bodies, std::span<const std::int32_t> now,
                                   std::span<const std::uint8_t> is_elsewhere) {
    const std::size_t count = bodies.count;
    is_standing_known_ = false;
    const auto is_gone = [&](std::int32_t row) {
        return row < 0 || is_elsewhere[static_cast<std::size_t>(row)] != 0;
    };
    if (!is_renamed()) {
        row_of_name_.resize(now.size()), name_of_.resize(now.size());
        std::iota(row_of_name_.begin(), row_of_name_.end(), 0);
        std::iota(name_of_.begin(), name_of_.end(), 0);
        is_loose_.assign(now.size(), 0);
    }
    // Rows that hold another body than before, or none that was there: few.
    old_rows_.assign(count, kNoName);
    for (std::size_t old = 0; old < now.size(); ++old) {
        if (now[old] >= 0) old_rows_[static_cast<std::size_t>(now[old])] = static_cast<std::int32_t>(old);
        if (!is_gone(now[old])) continue;
        if (name_of_[old] >= 0) row_of_name_[static_cast<std::size_t>(name_of_[old])] = kNoName;
        ++renewed_count_;
    }
    std::vector<std::int32_t>& changed = sorted_rows_;
    changed.clear();
    for (std::size_t row = 0; row < count; ++row)
        if (old_rows_[row] != static_cast<std::int32_t>(row) || is_elsewhere[row])
            changed.push_back(static_cast<std::int32_t>(row));
    const auto move_rows = [&](auto& column, auto of_fresh) {
        using Value = std::remove_cvref_t<decltype(column[0])>;
        std::vector<Value> moved(changed.size());
        for (std::size_t k = 0; k < changed.size(); ++k) {
            const auto row = static_cast<std::size_t>(changed[k]);
            const bool is_fresh = old_rows_[row] < 0 || is_elsewhere[row];
            moved[k] = is_fresh ? of_fresh(row) : column[static_cast<std::size_t>(old_rows_[row])];
        }
        column.resize(count);
        for (std::size_t k = 0; k < changed.size(); ++k)
            column[static_cast<std::size_t>(changed[k])] = moved[k];
    };
    for (Column<Real>* column : {&first_reach_, &drift_x_, &drift_y_, &flow_x_, &flow_y_, &rate_})
        move_rows(*column, [](std::size_t) { return Real(0); });
    move_rows(own_x_, [&](std::size_t row) { return bodies.position_x[row]; });
    move_rows(own_y_, [&](std::size_t row) { return bodies.position_y[row]; });
    move_rows(reach_, [&](std::size_t row) { return bodies.radius[row]; });
    move_rows(name_of_, [](std::size_t) { return kNoName; });
    move_rows(is_loose_, [](std::size_t) { return std::uint8_t{1}; });
    for (const std::int32_t row : changed) {
        const std::int32_t name = name_of_[static_cast<std::size_t>(row)];
        if (name >= 0) row_of_name_[static_cast<std::size_t>(name)] = row;
        if (old_rows_[static_cast<std::size_t>(row)] < 0 || is_elsewhere[static_cast<std::size_t>(row)])
            fresh_rows_.push_back(row);
    }
    const auto follow = [&](std::vector<std::int32_t>& rows) {
        std::erase_if(rows, [&](std::int32_t& row) {
            row = now[static_cast<std::size_t>(row)];
            return is_gone(row);
        });
    };
    follow(loose_rows_);
    loose_rows_.insert(loose_rows_.end(), fresh_rows_.begin(), fresh_rows_.end());
    std::erase_if(added_pairs_, [&](Pair& pair) {
        const std::int32_t a = now[static_cast<std::size_t>(pair.a)],
                           b = now[static_cast<std::size_t>(pair.b)];
        pair = {std::min(a, b), std::max(a, b)};
        return is_gone(a) || is_gone(b);
    });
    std::sort(added_pairs_.begin(), added_pairs_.end());
}

template <class Real>
void Candidates<Real>::prepare_order(std::size_t count) {
    if (!is_renamed()) return;
    sorted_rows_.clear();
    for (const std::int32_t name : grid_.order()) {
        const std::int32_t row = row_of_name_[static_cast<std::size_t>(name)];
        if (row >= 0) sorted_rows_.push_back(row);
    }
    for (std::size_t row = 0; row < count; ++row)
        if (name_of_[row] < 0) sorted_rows_.push_back(static_cast<std::int32_t>(row));
}

template <class Real>
std::size_t Candidates<Real>::bytes_of_names() const {
    return is_loose_.capacity() + (row_of_name_.capacity() + name_of_.capacity() + loose_rows_.capacity() +
                                   fresh_rows_.capacity() + old_rows_.capacity() + sorted_rows_.capacity()) *
                                      sizeof(std::int32_t);
}

template std::size_t Candidates<float>::find_rows_near(Vec2, double, Column<std::int32_t>&) const;
template void Candidates<float>::add_fresh_strays();
template void Candidates<float>::forget_names();
template void Candidates<float>::follow_rows(const Bodies<float>&, std::span<const std::int32_t>,
                                             std::span<const std::uint8_t>);
template void Candidates<float>::prepare_order(std::size_t);
template std::size_t Candidates<float>::bytes_of_names() const;
template std::size_t Candidates<double>::find_rows_near(Vec2, double, Column<std::int32_t>&) const;
template void Candidates<double>::add_fresh_strays();
template void Candidates<double>::forget_names();
template void Candidates<double>::follow_rows(const Bodies<double>&, std::span<const std::int32_t>,
                                              std::span<const std::uint8_t>);
template void Candidates<double>::prepare_order(std::size_t);
template std::size_t Candidates<double>::bytes_of_names() const;

}  // namespace carom
