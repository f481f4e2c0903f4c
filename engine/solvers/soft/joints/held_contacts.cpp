#include "solvers/soft/joints/held_contacts.hpp"

namespace carom {
namespace {

template <class Real>
double value_at(const Column<Real>& column, std::size_t i, double without) {
    return column.empty() ? without : static_cast<double>(column[i]);
}

}  // namespace

template <class Real>
HeldContact HeldContacts<Real>::of_path(const PathContact<Real>& contact, std::size_t number,
                                        const Bodies<Real>& bodies) {
    const PathLink<Real>& link = contact.link;
    const std::size_t lane = contact.lane;
    const Vec2 normal{link.normal_x[lane], link.normal_y[lane]};
    const auto row = [&](std::int32_t record) {
        const auto r = static_cast<std::size_t>(record);
        return r < bodies.count && !bodies.is_immovable(r) ? record : HeldContact::kNothing;
    };
    const auto levers = [&](double sign, const Real* one, const Real* two, const Real* tangent) {
        return HeldContact::Values{sign * static_cast<double>(one[lane]),
                                   sign * static_cast<double>(two[lane]),
                                   sign * static_cast<double>(tangent[lane])};
    };
    const auto none = static_cast<Real>(kNoPoint);
    return {.store = HeldContact::Store::path,
            .number = number,
            .row = {row(contact.near), row(contact.far)},
            .record = {contact.near, contact.far},
            .along = {normal, normal, {-normal.y, normal.x}},
            .at_rim = {levers(-1, link.near1, link.near2, link.near_t),
                       levers(1, link.far1, link.far2, link.far_t)},
            .acts = {link.separation1[lane] < none, link.separation2[lane] < none, true},
            .friction = static_cast<double>(link.friction[lane])};
}

template <class Real>
HeldContact HeldContacts<Real>::of_discs(const ContactRows<Real>& rows, std::size_t i,
                                         HeldContact::Store store) const {
    const Vec2 normal{rows.normal_x[i], rows.normal_y[i]};
    const std::int32_t b = store == HeldContact::Store::pair ? rows.b[i] : HeldContact::kNothing;
    const bool is_rough = !rows.friction_impulse.empty();
    return {.store = store,
            .number = i,
            .row = {rows.a[i], b},
            .record = {rows.a[i], b},
            .along = {normal, normal, {-normal.y, normal.x}},
            .at_rim = {HeldContact::Values{0, 0, -1}, HeldContact::Values{0, 0, -1}},
            .acts = {true, false, is_rough},
            .friction = is_rough ? value_at(rows.friction, i, step_.settings.friction) : 0};
}

template <class Real>
double HeldContacts<Real>::separation(const HeldContact& contact, std::size_t point) const {
    const BodyRecords<Real>& records = step_.records;
    const Real* turn = records.turn();
    double separation = 0;
    if (contact.store == HeldContact::Store::path) {
        paths_.for_each_of(contact.number, contact.number + 1, [&](const PathContact<Real>& at) {
            const Real* of_point = point == 0 ? at.link.separation1 : at.link.separation2;
            separation = static_cast<double>(of_point[at.lane]);
        });
    } else {
        const ContactRows<Real>& rows = rows_of(contact);
        separation = static_cast<double>(rows.separation[contact.number]) +
                     step_.terms.elapsed * value_at(rows.surface_normal, contact.number, 0);
    }
    for (std::size_t side = 0; side < 2; ++side) {
        if (contact.record[side] == HeldContact::kNothing) continue;
        const auto row = static_cast<std::size_t>(contact.record[side]);
        separation +=
            contact.part_of(side, point, {records.displacement[2 * row], records.displacement[2 * row + 1]},
                            turn ? static_cast<double>(turn[row]) : 0);
    }
    return separation;
}

template <class Real>
HeldContact::Values HeldContacts<Real>::lack(const HeldContact& contact) const {
    HeldContact::Values lack{};
    if (contact.store == HeldContact::Store::path) {
        paths_.for_each_of(contact.number, contact.number + 1, [&](const PathContact<Real>& at) {
            lack[0] = static_cast<double>(at.link.floor1[at.lane]);
            lack[1] = static_cast<double>(at.link.floor2[at.lane]);
        });
    } else {
        const ContactRows<Real>& rows = rows_of(contact);
        lack[0] = static_cast<double>(rows.floor[contact.number]) -
                  value_at(rows.surface_normal, contact.number, 0);
        lack[HeldContact::kTangent] = -value_at(rows.surface_tangent, contact.number, 0);
    }
    const HeldContact::Values parting_now = parting(contact);
    for (std::size_t d = 0; d < HeldContact::kDirections; ++d) lack[d] -= parting_now[d];
    return lack;
}

template <class Real>
HeldContact::Values HeldContacts<Real>::parting(const HeldContact& contact) const {
    HeldContact::Values parting{};
    for (std::size_t side = 0; side < 2; ++side) {
        if (contact.record[side] == HeldContact::kNothing) continue;
        const Real* record = &step_.records.velocity[4 * static_cast<std::size_t>(contact.record[side])];
        for (std::size_t d = 0; d < HeldContact::kDirections; ++d)
            parting[d] += contact.part_of(side, d, {record[0], record[1]}, record[2]);
    }
    return parting;
}

template <class Real>
HeldContact::Values HeldContacts<Real>::impulses(const HeldContact& contact) const {
    HeldContact::Values impulses{};
    if (contact.store == HeldContact::Store::path) {
        paths_.for_each_of(contact.number, contact.number + 1, [&](const PathContact<Real>& at) {
            impulses = {static_cast<double>(at.link.normal1[at.lane]),
                        static_cast<double>(at.link.normal2[at.lane]),
                        static_cast<double>(at.link.tangent[at.lane])};
        });
    } else {
        const ContactRows<Real>& rows = rows_of(contact);
        impulses[0] = static_cast<double>(rows.normal_impulse[contact.number]);
        impulses[HeldContact::kTangent] = value_at(rows.friction_impulse, contact.number, 0);
    }
    return impulses;
}

template <class Real>
void HeldContacts<Real>::add(const HeldContact& contact, const HeldContact::Values& more) const {
    if (contact.store == HeldContact::Store::path) return paths_.add_impulses(contact.number, more);
    ContactRows<Real>& rows = rows_of(contact);
    rows.normal_impulse[contact.number] += static_cast<Real>(more[0]);
    if (!rows.friction_impulse.empty())
        rows.friction_impulse[contact.number] += static_cast<Real>(more[HeldContact::kTangent]);
}

template class HeldContacts<float>;
template class HeldContacts<double>;

}  // namespace carom
