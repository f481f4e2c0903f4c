#include "solvers/impulse/impacts/rough_impacts.hpp"

#include "solvers/impulse/impacts/impact_sides.hpp"

namespace carom {

template <class Real>
void carry_out_rough(Flights<Real>& flights, Meeting m, const Encounter& e, const ImpactCoefficients& pair,
                     double s) {
    const auto record = [&](std::int32_t row) { return flights.record(row, s); };
    with_sides(m, record, [&](auto& a, auto& b) {
        const auto [nx, ny] = e.normal;
        const double mass = 1 / inverse_mass(a, b), slip = tangent_velocity(a, b, nx, ny);
        ContactTerms<double> terms{};
        terms.nx = nx, terms.ny = ny;
        terms.mass = mass, terms.tangent_mass = tangent_mass<kImpacts>(a, b, mass);
        terms.floor = -pair.restitution * e.normal_velocity, terms.friction = pair.friction;
        ContactImpulses<double> j{0, 0, 0};
        solve_contact<kImpacts>(a, b, terms, j, [](double change) { return change; });
        apply_impulses(flights, m, e, {j.normal, j.tangent}, s);
        if (!flights.books->is_open) return;
        flights.books->restitution += impact_work(j.normal, e.normal_velocity, terms.floor);
        flights.books->friction += impact_work(j.tangent, slip, tangent_velocity(a, b, nx, ny));
    });
}

template <class Real>
void apply_impulses(Flights<Real>& flights, Meeting m, const Encounter& e, const ImpactImpulses& j,
                    double s) {
    const auto deflect = [&](std::int32_t row, double sign) {
        ImpactBody change = body_of(flights.record_at_rest(row));
        change.apply_impulse(j.normal, j.tangent, e.normal.x, e.normal.y, sign);
        flights.deflect(row, record_of(change), s);
    };
    deflect(m.a, -1);
    if (!m.with_wall()) deflect(m.b, 1);
    flights.book_outside(m, e, j, s);
}

template void carry_out_rough(Flights<float>&, Meeting, const Encounter&, const ImpactCoefficients&, double);
template void carry_out_rough(Flights<double>&, Meeting, const Encounter&, const ImpactCoefficients&, double);
template void apply_impulses(Flights<float>&, Meeting, const Encounter&, const ImpactImpulses&, double);
template void apply_impulses(Flights<double>&, Meeting, const Encounter&, const ImpactImpulses&, double);

}  // namespace carom
