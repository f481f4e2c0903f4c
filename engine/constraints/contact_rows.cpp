#include "constraints/contact_rows.hpp"

#include <algorithm>
#include <numeric>

namespace carom {

namespace {

template <class Column>
void fit(Column& column, std::size_t contacts, bool is_used) {
    column.resize_for_overwrite(is_used ? contacts : 0);
}

}  // namespace

template <class Real>
void ContactRows<Real>::fit_bounces(std::size_t contacts, bool bounces, bool is_rough) {
    for (Column<Real>* column : {&largest_impulse, &approach, &bounce_impulse, &spare})
        fit(*column, contacts, bounces);
    fit(bounce_friction, contacts, bounces && is_rough);
}

template <class Real>
void ContactRows<Real>::resize(const ContactCandidates<Real>& candidates, bool is_rough, bool bounces) {
    const std::size_t contacts = candidates.a.size() + kRowPadding * candidates.overflow();
    begin.assign(candidates.colours(), 0);
    count.assign(candidates.colours(), 0);
    has_overflow_ = candidates.has_overflow;
    fit(a, contacts, true), fit(candidate, contacts, true);
    for (Column<Real>* column : {&normal_x, &normal_y, &separation, &mass, &normal_impulse, &floor,
                                 &surface_normal, &surface_tangent})
        fit(*column, contacts, true);
    fit(friction_impulse, contacts, is_rough), fit(friction, contacts, is_rough);
    fit_bounces(contacts, bounces, is_rough);
}

template <class Real>
void ContactRows<Real>::resize_in_place(const ContactCandidates<Real>& candidates, bool friction_varies,
                                        bool bounces) {
    const std::size_t contacts = candidates.a.size();
    begin = candidates.begin, count = candidates.count;
    has_overflow_ = candidates.has_overflow;
    for (Column<Real>* column : {&normal_x, &normal_y, &separation, &floor}) fit(*column, contacts, true);
    mass.resize(contacts), reach.resize(contacts);
    friction.resize(friction_varies ? contacts : 0);
    fit_bounces(contacts, bounces, true);
    is_live.resize_for_overwrite(contacts / kContactBlock),
        needs_second_sweep.resize_for_overwrite(contacts / kContactBlock),
        run.resize_for_overwrite(contacts / kContactBlock);
    run_count.assign(candidates.groups(), 0), live_count.assign(candidates.groups(), 0);
    group_begin.clear();
    for (std::size_t group = 0; group < candidates.groups(); ++group)
        group_begin.push_back(candidates.first_place(group));
    group_begin.push_back(contacts);
}

template <class Real>
void ContactRows<Real>::swap_with(ContactCandidates<Real>& candidates) {
    a.swap(candidates.a), b.swap(candidates.b);
    normal_impulse.swap(candidates.normal_impulse), friction_impulse.swap(candidates.friction_impulse);
    rolling_impulse.swap(candidates.rolling_impulse);
}

template <class Real>
void ContactRows<Real>::resize_rolling(std::size_t contacts, bool is_support, bool is_rolling,
                                       bool coefficient_varies, bool radius_varies) {
    if (is_support) fit(rolling_impulse, contacts, is_rolling);  // pairs share theirs with their candidates
    rolling.resize(is_rolling && coefficient_varies ? contacts : 0);
    rolling_share.resize(is_rolling && radius_varies ? contacts : 0);
    fit(surface_rolling, contacts, is_rolling && is_support);
    fit(bounce_rolling, contacts, is_rolling && !bounce_impulse.empty());
}

template <class Real>
ContactColumns<Real> ContactRows<Real>::columns() {
    const auto data = [](auto& column) { return column.empty() ? nullptr : column.data(); };
    return {a.data(),
            data(b),
            normal_x.data(),
            normal_y.data(),
            separation.data(),
            mass.data(),
            normal_impulse.data(),
            data(friction_impulse),
            data(friction),
            floor.data(),
            data(largest_impulse),
            data(surface_normal),
            data(surface_tangent),
            data(rolling_impulse),
            data(rolling),
            data(rolling_share),
            data(surface_rolling)};
}

template <class Real>
std::size_t ContactRows<Real>::bytes() const {
    std::size_t bytes = a.bytes() + b.bytes() + candidate.bytes() + is_live.bytes() +
                        needs_second_sweep.bytes() + run.bytes();
    for (const Column<Real>* column :
         {&normal_x,        &normal_y,         &separation,      &mass,
          &normal_impulse,  &friction_impulse, &friction,        &floor,
          &largest_impulse, &surface_normal,   &surface_tangent, &reach,
          &approach,        &bounce_impulse,   &bounce_friction, &spare,
          &rolling_impulse, &rolling,          &rolling_share,   &surface_rolling,
          &bounce_rolling})
        bytes += column->bytes();
    return bytes;
}

/// Contacts at [first + count, end of the batch) that push nothing.
template <class Real>
void ContactRows<Real>::pad(std::size_t first, std::size_t contacts, std::int32_t dummy) {
    const std::size_t from = first + contacts, to = first + padded(contacts);
    const auto fill = [&](auto& column, auto value) {
        if (!column.empty()) std::fill(column.data() + from, column.data() + to, value);
    };
    fill(a, dummy), fill(b, dummy), fill(candidate, -1);
    for (Column<Real>* column :
         {&normal_x, &normal_y, &separation, &mass, &normal_impulse, &friction_impulse, &friction, &floor,
          &largest_impulse, &surface_normal, &surface_tangent, &approach, &bounce_impulse, &bounce_friction,
          &rolling_impulse, &rolling, &rolling_share, &surface_rolling, &bounce_rolling})
        fill(*column, Real(0));
}

template <class Real>
std::size_t ContactRows<Real>::contacts() const {
    return std::accumulate(count.begin(), count.end(), std::size_t{0});
}

template <class Real>
std::size_t ContactRows<Real>::close_colour(std::size_t colour, std::size_t first, std::size_t contacts,
                                            std::int32_t dummy) {
    begin[colour] = first, count[colour] = contacts;
    if (!is_serial(colour)) {
        pad(first, contacts, dummy);
        return first + padded(contacts);
    }
    for (std::size_t i = contacts; i-- > 0;) {
        const std::size_t from = first + i, to = first + kRowPadding * i;
        const auto move = [&](auto& column) {
            if (!column.empty()) column[to] = column[from];
        };
        move(a), move(b), move(candidate);
        for (Column<Real>* column :
             {&normal_x, &normal_y, &separation, &mass, &normal_impulse, &friction_impulse, &friction,
              &approach, &surface_normal, &surface_tangent, &rolling_impulse, &rolling, &rolling_share,
              &surface_rolling})
            move(*column);
    }
    for (std::size_t i = 0; i < contacts; ++i) pad(first + kRowPadding * i, 1, dummy);
    return first + kRowPadding * contacts;
}

template struct ContactRows<float>;
template struct ContactRows<double>;

}  // namespace carom
