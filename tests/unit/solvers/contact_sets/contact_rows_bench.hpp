#pragma once

#include "constraints/contact_rows.hpp"
#include "state/bodies.hpp"
#include "support/disc_contact.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace carom::test {

/// A few discs and their contacts, as the solver has them and, beside that, as a textbook has them.
template <class Real>
struct ContactRowsBench {
    /// b < 0: a plane that stands still.
    struct Touch {
        std::int32_t a, b;
        Vector normal;  // from a to b
        double friction = 0, floor = 0, along = 0, tangent = 0;
    };

    std::vector<RigidDisc> discs;
    RigidDisc plane;
    std::vector<DiscContact> contacts;  // pairs, then supports
    std::size_t pair_count = 0;
    Bodies<Real> bodies;
    ContactRows<Real> pairs, supports;
    Column<Real> velocity, inverse_mass;

    ContactRowsBench(std::vector<RigidDisc> of, std::vector<Touch> touches) : discs(std::move(of)) {
        std::stable_partition(touches.begin(), touches.end(), [](const Touch& t) { return t.b >= 0; });
        for (const Touch& t : touches) {
            RigidDisc& b = t.b < 0 ? plane : discs[static_cast<std::size_t>(t.b)];
            DiscContact c{&discs[static_cast<std::size_t>(t.a)], &b, t.normal};
            c.friction = t.friction, c.floor = t.floor, c.along = t.along, c.tangent = t.tangent;
            contacts.push_back(c);
            pair_count += t.b >= 0;
        }
        lay_out_bodies();
        lay_out(touches, 0, pair_count, false), lay_out(touches, pair_count, touches.size(), true);
    }
    ContactRowsBench(const ContactRowsBench&) = delete;  // contacts have pointers

    Real& along(std::size_t contact) { return rows_of(contact).normal_impulse[place(contact)]; }
    Real& tangent(std::size_t contact) { return rows_of(contact).friction_impulse[place(contact)]; }

    SolveContacts<Real> arguments(ContactRows<Real>& of) {
        SolveContacts<Real> k{};
        k.contacts = of.columns(), k.velocity = velocity.data();
        return k;
    }

    /// Takes what the solver came to into the discs and contacts of the reference.
    void read_back() {
        for (std::size_t row = 0; row < discs.size(); ++row) {
            const Real* v = velocity.data() + 4 * row;
            discs[row].velocity = {v[0], v[1]}, discs[row].spin = v[2] / discs[row].radius;
        }
        for (std::size_t i = 0; i < contacts.size(); ++i)
            contacts[i].along = along(i), contacts[i].tangent = tangent(i);
    }

    Vector momentum() const {
        Vector sum;
        for (const RigidDisc& d : discs) sum = sum + 1 / d.inverse_mass * d.velocity;
        return sum;
    }

  private:
    ContactRows<Real>& rows_of(std::size_t contact) { return contact < pair_count ? pairs : supports; }
    std::size_t place(std::size_t contact) const {
        return contact < pair_count ? contact : contact - pair_count;
    }

    void lay_out_bodies() {
        const std::size_t count = discs.size();
        bodies.resize(count), velocity.resize(4 * (count + 1)), inverse_mass.resize(count);
        for (std::size_t row = 0; row < count; ++row) {
            const RigidDisc& d = discs[row];
            bodies.mass.set(row, count, static_cast<Real>(1 / d.inverse_mass));
            bodies.radius.set(row, count, static_cast<Real>(d.radius));
            inverse_mass[row] = static_cast<Real>(d.inverse_mass);
            velocity[4 * row] = static_cast<Real>(d.velocity.x);
            velocity[4 * row + 1] = static_cast<Real>(d.velocity.y);
            velocity[4 * row + 2] = static_cast<Real>(d.spin * d.radius);
            velocity[4 * row + 3] = inverse_mass[row];
        }
    }

    /// All in one colour: what is tested with this goes through them one by one.
    void lay_out(const std::vector<Touch>& touches, std::size_t first, std::size_t last, bool is_support) {
        ContactRows<Real>& rows = is_support ? supports : pairs;
        const std::size_t count = last - first;
        const auto dummy = static_cast<std::int32_t>(discs.size());
        rows.begin = {0}, rows.count = {count}, rows.first_colour = {0, 1};
        const ContactEffects effects{.friction = true, .friction_varies = true};
        ContactRows<Real>::for_each_column(rows, [&](auto& column, const ColumnUse& use) {
            const auto other = is_support ? ColumnUse::Of::pairs : ColumnUse::Of::supports;
            column.resize(use.of != other && use.is_needed(effects) ? padded(count) : 0);
        });
        if (!is_support) {
            rows.is_live.resize(padded(count) / kContactBlock);
            std::fill(rows.is_live.begin(), rows.is_live.end(), std::uint8_t{1});
        }
        rows.close_colour(0, 0, count, dummy);
        for (std::size_t i = 0; i < count; ++i) {
            const Touch& t = touches[first + i];
            const DiscContact& c = contacts[first + i];
            rows.a[i] = t.a;
            if (t.b >= 0) rows.b[i] = t.b;
            rows.normal_x[i] = static_cast<Real>(t.normal.x),
            rows.normal_y[i] = static_cast<Real>(t.normal.y);
            rows.mass[i] = static_cast<Real>(1 / (c.a->inverse_mass + c.b->inverse_mass));
            rows.normal_impulse[i] = static_cast<Real>(t.along);
            rows.friction_impulse[i] = static_cast<Real>(t.tangent);
            rows.friction[i] = static_cast<Real>(t.friction), rows.floor[i] = static_cast<Real>(t.floor);
            if (t.b < 0) rows.surface_normal[i] = rows.surface_tangent[i] = 0;
        }
    }
};

}  // namespace carom::test
