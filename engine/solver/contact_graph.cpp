#include "solver/contact_graph.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

namespace carom {

namespace {

constexpr std::int32_t kGone = -100;  // a row that no longer exists; no WallSide

}  // namespace

/// Starts the list of old rows, if nothing has moved so far.
template <class Real>
std::size_t ContactGraph<Real>::kept_rows() {
    if (old_row_.empty()) {
        old_row_.resize(rows_);
        std::iota(old_row_.begin(), old_row_.end(), 0);
    }
    return old_row_.size();
}

template <class Real>
void ContactGraph<Real>::follow_sorted_rows(const std::int32_t* order, std::size_t count) {
    kept_rows();
    old_row_.resize(count, kGone);  // rows that were appended
    spare_rows_.resize(count);
    for (std::size_t row = 0; row < count; ++row)
        spare_rows_[row] = old_row_[static_cast<std::size_t>(order[row])];
    old_row_.swap(spare_rows_);
}

template <class Real>
void ContactGraph<Real>::follow_removed_row(std::size_t row, std::size_t last) {
    if (kept_rows() <= last) old_row_.resize(last + 1, kGone);
    old_row_[row] = old_row_[last];
    old_row_.resize(last);
    if (old_row_.empty()) rows_ = 0;
}

/// The contacts of the last renewal in terms of today's rows.
template <class Real>
void ContactGraph<Real>::rename_rows() {
    if (old_row_.empty()) return;
    spare_rows_.assign(rows_, kGone);
    for (std::size_t row = 0; row < old_row_.size(); ++row)
        if (old_row_[row] != kGone)
            spare_rows_[static_cast<std::size_t>(old_row_[row])] = static_cast<std::int32_t>(row);
    for (ContactCandidates<Real>* contacts : {&pairs, &supports})
        for (std::size_t c = 0; c < contacts->colours(); ++c)
            for (std::size_t i = contacts->begin[c]; i < contacts->begin[c] + contacts->count[c]; ++i) {
                std::int32_t &a = contacts->a[i], &b = contacts->b[i];
                a = spare_rows_[static_cast<std::size_t>(a)];
                if (b >= 0) b = spare_rows_[static_cast<std::size_t>(b)];
                if (a == kGone || b == kGone) contacts->normal_impulse[i] = 0;
                // The impulses of a pair do not depend on the order of its bodies, but for the rolling one:
                // spin_b - spin_a changes its sign.
                if (contacts == &pairs && a > b) {
                    std::swap(a, b);
                    if (keeps_rolling) contacts->rolling_impulse[i] = -contacts->rolling_impulse[i];
                }
            }
    old_row_.clear();
}

/// Files the contacts that carry an impulse by their row a.
template <class Real>
void ContactGraph<Real>::remember(std::size_t rows) {
    first_of_.assign(rows + 2, 0);
    const auto count = [&](const ContactCandidates<Real>& contacts) {
        for (std::size_t c = 0; c < contacts.colours(); ++c)
            for (std::size_t i = contacts.begin[c]; i < contacts.begin[c] + contacts.count[c]; ++i)
                if (contacts.normal_impulse[i] > 0) ++first_of_[static_cast<std::size_t>(contacts.a[i]) + 2];
    };
    count(pairs), count(supports);
    for (std::size_t row = 2; row < rows + 2; ++row) first_of_[row] += first_of_[row - 1];
    remembered_.resize(first_of_[rows + 1]);
    remembered_rolling_.resize(keeps_rolling ? remembered_.size() : 0);
    remember(pairs), remember(supports);
}

template <class Real>
void ContactGraph<Real>::remember(const ContactCandidates<Real>& contacts) {
    for (std::size_t c = 0; c < contacts.colours(); ++c)
        for (std::size_t i = contacts.begin[c]; i < contacts.begin[c] + contacts.count[c]; ++i) {
            if (!(contacts.normal_impulse[i] > 0)) continue;
            const std::uint32_t place = first_of_[static_cast<std::size_t>(contacts.a[i]) + 1]++;
            const Real friction = contacts.friction_impulse.empty() ? Real(0) : contacts.friction_impulse[i];
            remembered_[place] = {contacts.b[i], contacts.normal_impulse[i], friction};
            if (keeps_rolling) remembered_rolling_[place] = contacts.rolling_impulse[i];
        }
}

template <class Real>
void ContactGraph<Real>::recall(Found& found, std::vector<Real>& rolling) const {
    found.normal_impulse = found.friction_impulse = 0;
    if (keeps_rolling) rolling.push_back(0);
    const auto row = static_cast<std::size_t>(found.a);
    for (std::uint32_t i = first_of_[row]; i < first_of_[row + 1]; ++i)
        if (remembered_[i].b == found.b) {
            found.normal_impulse = remembered_[i].normal_impulse;
            found.friction_impulse = remembered_[i].friction_impulse;
            if (keeps_rolling) rolling.back() = remembered_rolling_[i];
            return;
        }
}

template <class Real>
void ContactGraph<Real>::list_walls(const Candidates<Real>& candidates, const Bodies<Real>& bodies,
                                    const Walls& walls) {
    const auto min_x = static_cast<Real>(walls.min.x), min_y = static_cast<Real>(walls.min.y);
    const auto max_x = static_cast<Real>(walls.max.x), max_y = static_cast<Real>(walls.max.y);
    for (std::size_t row = 0; row < bodies.count; ++row) {
        const Real x = bodies.position_x[row], y = bodies.position_y[row], reach = candidates.reach()[row];
        const bool near[] = {walls.left && x - min_x < reach, walls.right && max_x - x < reach,
                             walls.bottom && y - min_y < reach, walls.top && max_y - y < reach};
        for (std::int32_t side = 0; side < 4; ++side)
            if (near[side] && !bodies.is_immovable(row))
                found_supports_.push_back({static_cast<std::int32_t>(row), -1 - side, 0, 0, 0});
    }
}

/// Stable, so that bodies near each other stay near each other within a colour.
template <class Real>
void ContactGraph<Real>::sort_by_colour(std::vector<Found>& found, const std::vector<Real>& rolling,
                                        ContactCandidates<Real>& sorted, std::int32_t dummy) {
    std::size_t colours = 0;
    std::size_t counts[kColours + 1] = {};
    for (const Found& f : found) {
        ++counts[f.colour];
        colours = std::max<std::size_t>(colours, f.colour + 1);
    }
    sorted.begin.resize(colours), sorted.count.resize(colours);
    std::size_t next[kColours + 1] = {}, place = 0;
    for (std::size_t c = 0; c < colours; ++c) {
        sorted.begin[c] = next[c] = place;
        sorted.count[c] = counts[c];
        place += padded(counts[c]);
    }
    sorted.has_overflow = colours == kColours + 1;
    for (Column<std::int32_t>* rows : {&sorted.a, &sorted.b}) {
        rows->resize_for_overwrite(place);
        for (std::size_t c = 0; c < colours; ++c)
            std::fill(rows->data() + next[c] + counts[c], rows->data() + next[c] + padded(counts[c]), dummy);
    }
    sorted.normal_impulse.resize(0), sorted.normal_impulse.resize(place);
    sorted.friction_impulse.resize(0), sorted.friction_impulse.resize(place);
    sorted.rolling_impulse.resize(0), sorted.rolling_impulse.resize(keeps_rolling ? place : 0);
    for (std::size_t n = 0; n < rolling.size(); ++n) {
        std::size_t& i = next[found[n].colour];
        sorted.rolling_impulse[i++] = rolling[n];
    }
    if (keeps_rolling)
        for (std::size_t c = 0; c < colours; ++c) next[c] = sorted.begin[c];
    for (const Found& f : found) {
        const std::size_t i = next[f.colour]++;
        sorted.a[i] = f.a, sorted.b[i] = f.b;
        sorted.normal_impulse[i] = f.normal_impulse, sorted.friction_impulse[i] = f.friction_impulse;
    }
}

template <class Real>
void ContactGraph<Real>::renew(const Candidates<Real>& candidates, const Bodies<Real>& bodies,
                               const Walls* walls) {
    const std::size_t rows = bodies.count;
    rename_rows();
    remember(rows);
    found_pairs_.clear(), found_supports_.clear();
    rolling_of_pairs_.clear(), rolling_of_supports_.clear();
    const std::int32_t *pair_a = candidates.pair_a(), *pair_b = candidates.pair_b();
    for (std::size_t p = 0; p < candidates.pair_count(); ++p) {
        const std::int32_t a = std::min(pair_a[p], pair_b[p]), b = std::max(pair_a[p], pair_b[p]);
        if (bodies.has_flags && bodies.is_immovable(static_cast<std::size_t>(a)))
            found_supports_.push_back({b, a, 0, 0, 0});
        else if (bodies.has_flags && bodies.is_immovable(static_cast<std::size_t>(b)))
            found_supports_.push_back({a, b, 0, 0, 0});
        else
            found_pairs_.push_back({a, b, 0, 0, 0});
    }
    if (walls) list_walls(candidates, bodies, *walls);

    colours_of_.assign(rows, 0);
    const auto lowest_free = [](std::uint64_t taken) {
        return static_cast<std::uint32_t>(std::countr_one(taken));  // kColours if all are
    };
    for (Found& f : found_pairs_) {
        recall(f, rolling_of_pairs_);
        std::uint64_t &of_a = colours_of_[static_cast<std::size_t>(f.a)],
                      &of_b = colours_of_[static_cast<std::size_t>(f.b)];
        f.colour = lowest_free(of_a | of_b);
        if (f.colour == kColours) continue;
        of_a |= std::uint64_t{1} << f.colour;
        of_b |= std::uint64_t{1} << f.colour;
    }
    colours_of_.assign(rows, 0);
    for (Found& f : found_supports_) {
        recall(f, rolling_of_supports_);
        std::uint64_t& of_a = colours_of_[static_cast<std::size_t>(f.a)];
        f.colour = lowest_free(of_a);
        if (f.colour < kColours) of_a |= std::uint64_t{1} << f.colour;
    }
    const auto dummy = static_cast<std::int32_t>(rows);
    sort_by_colour(found_pairs_, rolling_of_pairs_, pairs, dummy);
    sort_by_colour(found_supports_, rolling_of_supports_, supports, dummy);
    rows_ = rows;
}

template <class Real>
std::size_t ContactGraph<Real>::bytes() const {
    return pairs.bytes() + supports.bytes() +
           (found_pairs_.capacity() + found_supports_.capacity()) * sizeof(Found) +
           colours_of_.capacity() * sizeof(std::uint64_t) + first_of_.capacity() * sizeof(std::uint32_t) +
           remembered_.capacity() * sizeof(Remembered) +
           (rolling_of_pairs_.capacity() + rolling_of_supports_.capacity() + remembered_rolling_.capacity()) *
               sizeof(Real) +
           (old_row_.capacity() + spare_rows_.capacity()) * sizeof(std::int32_t);
}

template class ContactGraph<float>;
template class ContactGraph<double>;

}  // namespace carom
