#include "constraints/contact_rows.hpp"

#include <algorithm>
#include <numeric>

namespace carom {

template <class Real>
void ContactRows<Real>::resize_for_step(const ContactEffects& effects) {
    const std::size_t contacts = a.size();
    for_each_column(*this, [&](auto& column, const ColumnUse& use) {
        if (use.holds == ColumnUse::Holds::from_step_to_step || use.of == ColumnUse::Of::supports) return;
        const std::size_t rows = use.is_needed(effects) ? contacts : 0;
        if (use.holds == ColumnUse::Holds::until_pairs_change)
            column.resize(rows);
        else
            column.resize_for_overwrite(rows);
    });
    const std::size_t blocks = contacts / kContactBlock;
    is_struck.resize_for_overwrite(blocks), is_live.resize_for_overwrite(blocks),
        needs_second_sweep.resize_for_overwrite(blocks);
    run.resize_for_overwrite(blocks);
    run_count.assign(groups(), 0), live_count.assign(groups(), 0);
}

template <class Real>
void ContactRows<Real>::resize_for_some_of(const ContactRows& candidates, const ContactEffects& effects) {
    const std::size_t contacts = candidates.a.size() + kRowPadding * candidates.overflow();
    begin.assign(candidates.colours(), 0), count.assign(candidates.colours(), 0);
    first_colour = candidates.first_colour;
    has_overflow = candidates.has_overflow, overflow_stride = kRowPadding;
    for_each_column(*this, [&](auto& column, const ColumnUse& use) {
        const bool is_used = use.of != ColumnUse::Of::pairs && use.is_needed(effects);
        column.resize_for_overwrite(is_used ? contacts : 0);
    });
}

template <class Real>
ContactColumns<Real> ContactRows<Real>::columns() {
    const auto data = [](auto& column) { return column.empty() ? nullptr : column.data(); };
    return {.a = a.data(),
            .b = data(b),
            .normal_x = normal_x.data(),
            .normal_y = normal_y.data(),
            .separation = separation.data(),
            .mass = mass.data(),
            .normal_impulse = normal_impulse.data(),
            .friction_impulse = data(friction_impulse),
            .friction = data(friction),
            .floor = floor.data(),
            .surface_normal = data(surface_normal),
            .surface_tangent = data(surface_tangent),
            .rolling_impulse = data(rolling_impulse),
            .rolling = data(rolling),
            .rolling_share = data(rolling_share),
            .surface_rolling = data(surface_rolling),
            .smaller = data(smaller)};
}

template <class Real>
std::size_t ContactRows<Real>::bytes() const {
    std::size_t bytes = is_struck.bytes() + is_live.bytes() + needs_second_sweep.bytes() + run.bytes() +
                        (begin.capacity() + count.capacity() + first_colour.capacity() +
                         run_count.capacity() + live_count.capacity()) *
                            sizeof(std::size_t);
    for_each_column(*this, [&](const auto& column, const ColumnUse&) { bytes += column.bytes(); });
    return bytes;
}

template <class Real>
std::size_t ContactRows<Real>::contacts() const {
    return std::accumulate(count.begin(), count.end(), std::size_t{0});
}

/// Contacts at [first + count, end of the batch) that push nothing.
template <class Real>
void ContactRows<Real>::pad(std::size_t first, std::size_t contacts, std::int32_t dummy) {
    const std::size_t from = first + contacts, to = first + padded(contacts);
    for_each_column(*this, [&](auto& column, const ColumnUse&) {
        using Value = std::remove_cvref_t<decltype(column[0])>;
        if (column.empty()) return;
        Value value{};
        if constexpr (std::is_same_v<Value, std::int32_t>) value = &column == &candidate ? -1 : dummy;
        std::fill(column.data() + from, column.data() + to, value);
    });
}

template <class Real>
std::size_t ContactRows<Real>::close_colour(std::size_t colour, std::size_t first, std::size_t contacts,
                                            std::int32_t dummy) {
    begin[colour] = first, count[colour] = contacts;
    const std::size_t apart = stride(colour);
    if (apart == 1) {
        pad(first, contacts, dummy);
        return first + padded(contacts);
    }
    for_each_column(*this, [&](auto& column, const ColumnUse&) {
        if (column.empty()) return;
        for (std::size_t i = contacts; i-- > 0;) column[first + apart * i] = column[first + i];
    });
    for (std::size_t i = 0; i < contacts; ++i) pad(first + apart * i, 1, dummy);
    return first + apart * contacts;
}

/// What is no contact in a colour, up to the place `end`.
template <class Real>
void ContactRows<Real>::pad_colour(std::size_t colour, std::size_t end, std::int32_t padding_row) {
    const std::size_t apart = stride(colour), used = apart * count[colour];
    for (std::size_t k = apart > 1 ? 0 : used; begin[colour] + k < end; ++k) {
        if (k < used && k % apart == 0) continue;
        const std::size_t i = begin[colour] + k;
        a[i] = b[i] = padding_row, normal_impulse[i] = friction_impulse[i] = 0;
        if (i < rolling_impulse.size()) rolling_impulse[i] = 0;
    }
}

template <class Real>
void ContactRows<Real>::pad_colours(std::size_t first, std::size_t last, std::int32_t padding_row) {
    for (std::size_t c = first; c < last; ++c) pad_colour(c, begin[c] + padded(length(c)), padding_row);
}

template <class Real>
void ContactRows<Real>::pad_groups(std::size_t first_padding_row) {
    for (std::size_t group = 0; group < groups(); ++group)
        for (std::size_t c = first_colour[group]; c < first_colour[group + 1]; ++c)
            pad_colour(c, c + 1 < colours() ? begin[c + 1] : a.size(),
                       static_cast<std::int32_t>(first_padding_row + group));
}

template <class Real>
void ContactRows<Real>::follow_removed_edges(EdgeStore::Removed gone) {
    if (gone.count == 0) return;
    for_each([&](std::size_t i) {
        const Partner support = partner(i);
        if (!support.is_edge()) return;
        const std::int32_t edge = support.edge_number();
        if (edge >= gone.first + gone.count)
            b[i] = Partner::edge(edge - gone.moved_up).stored();
        else if (edge >= gone.first)
            b[i] = Partner::gone().stored();
    });
}

template struct ContactRows<float>;
template struct ContactRows<double>;

}  // namespace carom
