#pragma once

#include "constraints/contact_rows.hpp"
#include "effects/contact_law.hpp"

namespace carom {
namespace {

/// The surface of a support.
template <class Real>
DoubleSurface surface_at(const ContactRows<Real>& supports, std::size_t i) {
    const double rolling =
        supports.surface_rolling.empty() ? 0 : static_cast<double>(supports.surface_rolling[i]);
    return {static_cast<double>(supports.surface_normal[i]), static_cast<double>(supports.surface_tangent[i]),
            rolling};
}

/// A contact of discs in double precision: what its impulses do.
template <class Real>
struct StoredContact {
    double nx, ny, of_a;
    ContactImpulses<double> impulses;  // N s

    StoredContact(const ContactRows<Real>& rows, std::size_t i)
        : nx(rows.normal_x[i]),
          ny(rows.normal_y[i]),
          of_a(rows.rolling_share.empty() ? 0.5 : static_cast<double>(rows.rolling_share[i])) {
        const auto value = [i](const Column<Real>& column) {
            return column.empty() ? 0 : static_cast<double>(column[i]);
        };
        impulses = {value(rows.normal_impulse), value(rows.friction_impulse), value(rows.rolling_impulse)};
    }

    /// Work on both sides [J]. @param a, b  with mean velocities over the time in which the impulses act
    template <class B>
    double work(const DoubleBody& a, const B& b) const {
        return impulses.normal * normal_velocity(a, b, nx, ny) +
               impulses.tangent * tangent_velocity(a, b, nx, ny) +
               impulses.rolling * rolling_velocity(a, b, of_a);
    }
    /// Takes the impulses back from both sides.
    template <class B>
    void take_from(DoubleBody& a, B& b) const {
        const ContactImpulses<double> taken{-impulses.normal, -impulses.tangent, -impulses.rolling};
        apply_impulses<kEveryEffect>(a, b, nx, ny, of_a, taken);
    }
};

/// Multiplies the impulses of a contact.
template <class Real>
void scale_impulses(ContactRows<Real>& rows, std::size_t i, double share) {
    if (share == 1) return;
    for (Column<Real>* column : {&rows.normal_impulse, &rows.friction_impulse, &rows.rolling_impulse})
        if (!column->empty()) (*column)[i] = share > 0 ? static_cast<Real>(share) * (*column)[i] : Real(0);
}

}  // namespace
}  // namespace carom
