#include "constraints/contact_faults.hpp"

#include <utility>
#include <vector>

namespace carom {

namespace {

template <class Real>
const char* fault_of_columns(const ContactRows<Real>& contacts) {
    const std::size_t length = contacts.a.size();
    const char* fault = nullptr;
    ContactRows<Real>::for_each_column(contacts, [&](const auto& column, const ColumnUse& use) {
        const bool lasts = use.holds == ColumnUse::Holds::from_step_to_step;
        if (lasts && !column.empty() && column.size() != length)
            fault = "columns of contacts that last differ in length";
    });
    if (contacts.normal_impulse.size() != length) fault = "contacts have no normal impulses";
    return fault;
}

template <class Real>
const char* fault_of_places(const ContactRows<Real>& contacts, const TaskGroups& groups, bool both_move) {
    const std::size_t expected = both_move ? groups.count() : groups.support_count();
    if (contacts.groups() == 0) return contacts.colours() == 0 ? nullptr : "colours are in no group";
    if (contacts.groups() != expected) return "there are other groups than those of the rows";
    if (contacts.first_colour.front() != 0 || contacts.first_colour.back() != contacts.colours())
        return "groups do not have all colours";
    for (std::size_t g = 0; g < contacts.groups(); ++g)
        if (contacts.first_colour[g] > contacts.first_colour[g + 1]) return "groups are out of order";
    std::size_t end = 0;
    for (std::size_t c = 0; c < contacts.colours(); ++c) {
        if (contacts.begin[c] % kRowPadding != 0) return "a colour begins within a batch";
        if (contacts.begin[c] < end) return "colours overlap";
        end = contacts.begin[c] + padded(contacts.length(c));
    }
    return end > contacts.a.size() ? "colours reach beyond their columns" : nullptr;
}

template <class Real>
const char* fault_of_contact(const ContactRows<Real>& contacts, std::size_t i, const Bodies<Real>& bodies,
                             bool both_move) {
    const std::int32_t a = contacts.a[i];
    if (a < 0 || static_cast<std::size_t>(a) >= bodies.count) return "a contact names no body";
    if (contacts.b.empty()) return both_move ? "contacts of pairs have no second body" : nullptr;
    const Partner partner = contacts.partner(i);
    if (partner.is_gone()) return "a contact's other side is gone";
    // A support may be a sleeper, whose row is beyond those of bodies that are awake.
    const std::size_t rows = both_move ? bodies.count : bodies.rows();
    if (partner.is_body() && static_cast<std::size_t>(partner.row()) >= rows)
        return "a contact's other side is no body";
    if (both_move && (!partner.is_body() || partner.row() <= a)) return "a pair is not a < b";
    return nullptr;
}

template <class Real>
const char* fault_of_group(const ContactRows<Real>& contacts, const TaskGroups& groups, std::size_t group,
                           std::size_t i, bool both_move) {
    // What comes between renewals, and what found no colour, is in the last group.
    if (group + 1 == contacts.groups()) return nullptr;
    const std::size_t right =
        both_move ? groups.group_of(contacts.a[i], contacts.b[i]) : groups.chunk_of(contacts.a[i]);
    return group == right ? nullptr : "a contact is in the group of other rows";
}

template <class Real>
const char* fault_of_padding(const ContactRows<Real>& contacts, std::size_t from, std::size_t to,
                             std::size_t bodies) {
    for (std::size_t i = from; i < to; ++i) {
        if (contacts.a[i] < 0 || static_cast<std::size_t>(contacts.a[i]) < bodies)
            return "padding names a body";
        const bool pushes = contacts.normal_impulse[i] != 0 ||
                            (!contacts.friction_impulse.empty() && contacts.friction_impulse[i] != 0) ||
                            (!contacts.rolling_impulse.empty() && contacts.rolling_impulse[i] != 0);
        if (pushes) return "padding has impulses";
    }
    return nullptr;
}

}  // namespace

template <class Real>
const char* fault_of(const ContactRows<Real>& contacts, const TaskGroups& groups, const Bodies<Real>& bodies,
                     bool both_move) {
    if (const char* fault = fault_of_columns(contacts)) return fault;
    if (const char* fault = fault_of_places(contacts, groups, both_move)) return fault;
    thread_local std::vector<std::size_t> last_colour;  // by row, the last that named it; kept, as steps do
    last_colour.assign(bodies.count, SIZE_MAX);         // not allocate
    for (std::size_t g = 0; g < contacts.groups(); ++g)
        for (std::size_t c = contacts.first_colour[g]; c < contacts.first_colour[g + 1]; ++c) {
            const std::size_t stride = contacts.stride(c);
            const bool may_share = contacts.has_overflow && c + 1 == contacts.colours();
            for (std::size_t n = 0, i = contacts.begin[c]; n < contacts.count[c]; ++n, i += stride) {
                if (const char* fault = fault_of_contact(contacts, i, bodies, both_move)) return fault;
                if (const char* fault = fault_of_group(contacts, groups, g, i, both_move)) return fault;
                const auto is_named = [&](std::int32_t row) {
                    return std::exchange(last_colour[static_cast<std::size_t>(row)], c) == c;
                };
                const bool is_shared = is_named(contacts.a[i]) || (both_move && is_named(contacts.b[i]));
                if (is_shared && !may_share) return "a colour names a body twice";
                if (stride == 1) continue;
                if (const char* fault = fault_of_padding(contacts, i + 1, i + stride, bodies.count))
                    return fault;
            }
            if (stride > 1) continue;
            const std::size_t end = contacts.begin[c] + contacts.count[c];
            const std::size_t padded_end = contacts.begin[c] + padded(contacts.count[c]);
            if (const char* fault = fault_of_padding(contacts, end, padded_end, bodies.count)) return fault;
        }
    return nullptr;
}

template const char* fault_of(const ContactRows<float>&, const TaskGroups&, const Bodies<float>&, bool);
template const char* fault_of(const ContactRows<double>&, const TaskGroups&, const Bodies<double>&, bool);

}  // namespace carom
