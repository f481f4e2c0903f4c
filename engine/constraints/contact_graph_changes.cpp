// Bodies that come, go or are put elsewhere while the candidate pairs stay.
#include <algorithm>
#include <cmath>

#include "constraints/contact_graph.hpp"
#include "math/vec2_math.hpp"

namespace carom {

/// Notes what a body had from one that is gone.
template <class Real>
void ContactGraph<Real>::lose_contact(const ContactRows<Real>& contacts, std::size_t i, std::int32_t gone,
                                      std::int32_t row, const Bodies<Real>& bodies) {
    const double normal_impulse = contacts.normal_impulse[i];
    if (!(normal_impulse > 0)) return;
    LostContact contact{gone, row, false, {}};
    const auto former =
        std::lower_bound(former_places.begin(), former_places.end(), gone,
                         [](const FormerPlace& place, std::int32_t wanted) { return place.row < wanted; });
    const auto own = static_cast<std::size_t>(row);
    if (former != former_places.end() && former->row == gone) {
        const Vec2 way = Vec2{bodies.position_x[own], bodies.position_y[own]} - former->place;
        const double distance = std::sqrt(length_squared(way));
        const double friction =
            contacts.friction_impulse.empty() ? 0 : static_cast<double>(contacts.friction_impulse[i]);
        // Towards `row`. The normal turns with the order of the bodies, and so does its tangent: on either
        // body the friction impulse is that along the tangent of the normal towards it.
        const Vec2 n = distance > 0 ? (1 / distance) * way : Vec2{};
        contact.impulse = normal_impulse * n + friction * Vec2{-n.y, n.x};
        contact.is_impulse_known = distance > 0;
    }
    lost.push_back(contact);
}

/// Whatever is no contact names the padding row of its group.
template <class Real>
void ContactGraph<Real>::pad_all(ContactRows<Real>& sorted, std::size_t first_padding_row) {
    for (std::size_t group = 0; group < sorted.groups(); ++group) {
        const auto row = static_cast<std::int32_t>(first_padding_row + group);
        for (std::size_t c = sorted.first_colour[group]; c < sorted.first_colour[group + 1]; ++c) {
            const std::size_t stride = sorted.stride(c), used = stride * sorted.count[c],
                              end = c + 1 < sorted.colours() ? sorted.begin[c + 1] : sorted.a.size();
            for (std::size_t k = stride > 1 ? 0 : used; sorted.begin[c] + k < end; ++k) {
                if (k < used && k % stride == 0) continue;
                const std::size_t i = sorted.begin[c] + k;
                sorted.a[i] = sorted.b[i] = row, sorted.normal_impulse[i] = sorted.friction_impulse[i] = 0;
            }
        }
    }
}

template <class Real>
void ContactGraph<Real>::follow_rows(const Bodies<Real>& bodies, std::span<const std::uint8_t> is_elsewhere) {
    const std::vector<std::int32_t>& now = trail.new_rows();
    sort_former_places();
    lost.clear();
    const auto row_now = [&](std::int32_t row) {
        const std::int32_t present = now[static_cast<std::size_t>(row)];
        const bool is_gone = present < 0 || is_elsewhere[static_cast<std::size_t>(present)];
        return is_gone ? Partner::gone().stored() : present;
    };
    for (ContactRows<Real>* contacts : {&pairs, &supports}) {
        late_.clear();
        const auto drop = [&](std::size_t i, std::size_t last) {
            ContactRows<Real>::for_each_column(*contacts, [&](auto& column, const ColumnUse& use) {
                if (last >= column.size() || use.holds == ColumnUse::Holds::in_a_step) return;
                column[i] = column[last], column[last] = {};
            });
        };
        for (std::size_t c = 0; c < contacts->colours(); ++c) {
            const std::size_t stride = contacts->stride(c), begin = contacts->begin[c];
            for (std::size_t n = 0; n < contacts->count[c];) {
                const std::size_t i = begin + n * stride;
                const std::int32_t a = contacts->a[i], b = contacts->b[i];
                const bool is_body = Partner(b).is_body();
                const std::int32_t new_a = row_now(a), new_b = is_body ? row_now(b) : b;
                if (new_a == a && new_b == b) {
                    ++n;
                    continue;
                }
                const Partner side_a(new_a), side_b(new_b);
                if (side_a.is_gone() || side_b.is_gone()) {
                    if (side_a.is_body()) lose_contact(*contacts, i, b, new_a, bodies);
                    if (side_b.is_body()) lose_contact(*contacts, i, a, new_b, bodies);
                } else {
                    const bool turns = contacts == &pairs && new_a > new_b;
                    late_.push_back({turns ? new_b : new_a, turns ? new_a : new_b,
                                     contacts->normal_impulse[i], contacts->friction_impulse[i], 0});
                }
                drop(i, begin + --contacts->count[c] * stride);
            }
        }
        pad_all(*contacts, bodies.count);
        if (!late_.empty())
            add_late(*contacts,
                     static_cast<std::int32_t>(bodies.count + (contacts == &pairs ? groups.far() : 0)),
                     contacts == &pairs);
    }
    trail.start(bodies.count), former_places.clear();
    ++version;
}

template <class Real>
void ContactGraph<Real>::follow_removed_edges(EdgeStore::Removed gone) {
    if (gone.count == 0) return;
    supports.for_each([&](std::size_t i) {
        const Partner support = supports.partner(i);
        if (!support.is_edge()) return;
        const std::int32_t edge = support.edge_number();
        if (edge >= gone.first + gone.count)
            supports.b[i] = Partner::edge(edge - gone.count).stored();
        else if (edge >= gone.first)
            supports.b[i] = Partner::gone().stored();
    });
}

template void ContactGraph<float>::follow_removed_edges(EdgeStore::Removed);
template void ContactGraph<double>::follow_removed_edges(EdgeStore::Removed);
template void ContactGraph<float>::follow_rows(const Bodies<float>&, std::span<const std::uint8_t>);
template void ContactGraph<double>::follow_rows(const Bodies<double>&, std::span<const std::uint8_t>);
template void ContactGraph<float>::lose_contact(const ContactRows<float>&, std::size_t, std::int32_t,
                                                std::int32_t, const Bodies<float>&);
template void ContactGraph<double>::lose_contact(const ContactRows<double>&, std::size_t, std::int32_t,
                                                 std::int32_t, const Bodies<double>&);
template void ContactGraph<float>::pad_all(ContactRows<float>&, std::size_t);
template void ContactGraph<double>::pad_all(ContactRows<double>&, std::size_t);

}  // namespace carom
