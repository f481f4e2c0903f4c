// The ledger of solver `soft`: work and momentum by cause, from impulses and velocities, in double precision.
//
// In a substep a body's velocity goes from v0 to v1 by the sum of all impulses on it, so its kinetic energy
// grows by exactly (sum of impulses) · (v0 + v1) / 2, and each impulse's share is its own product with that
// mean. The mean velocity of the surfaces of a contact splits its share into what the contact takes, by its
// normal and by its tangential impulse, and what a moving support drives.
#include "constraints/contact_law.hpp"
#include "solvers/soft/soft_solver.hpp"

#include "effects/flight.hpp"
#include "math/vec2_math.hpp"

namespace carom {
namespace {

template <class Real>
DoubleBody mean_of(const DoubleBody& before, const Column<Real>& to, std::int32_t row) {
    DoubleBody mean = body_at(to, row);
    for (std::size_t k = 0; k < 3; ++k) mean.record[k] = 0.5 * (before.record[k] + mean.record[k]);
    return mean;
}

Vec2 velocity_of(const DoubleBody& body) {
    return {body.record[0], body.record[1]};
}

template <class Real>
DoubleSurface surface_at(const ContactRows<Real>& supports, std::size_t i) {
    const double rolling =
        supports.surface_rolling.empty() ? 0 : static_cast<double>(supports.surface_rolling[i]);
    return {static_cast<double>(supports.surface_normal[i]), static_cast<double>(supports.surface_tangent[i]),
            rolling};
}

/// Velocities at the start of the substep, by row.
template <class Real>
auto from_columns(const Column<Real>& x, const Column<Real>& y, const Column<Real>& rim) {
    return [&](std::int32_t row) {
        const auto value = [i = static_cast<std::size_t>(row)](const Column<Real>& column) {
            return column.empty() ? 0 : static_cast<double>(column[i]);
        };
        return DoubleBody{{{value(x), value(y), value(rim), 0}}};
    };
}

}  // namespace

/// The impulses of the contacts of one kind, pairs or supports, by contact [N s].
template <class Real>
struct SoftSolver<Real>::Impulses {
    const Column<Real>&normal, &friction, &rolling;

    ContactImpulses<double> operator[](std::size_t i) const {
        const auto value = [i](const Column<Real>& column) {
            return column.empty() ? 0 : static_cast<double>(column[i]);
        };
        return {value(normal), value(friction), value(rolling)};
    }
};

/// What a contact takes: the work of its impulses on both sides, by mean velocities.
template <class Real>
template <class From>
void SoftSolver<Real>::book_contacts(const ContactRows<Real>& contacts, const Impulses& impulses,
                                     const From& from, Books& books) const {
    const auto mean_at = [&](std::int32_t row) { return mean_of(from(row), velocity_, row); };
    const auto book = [&](std::size_t i, const auto& other) {
        const DoubleBody body = mean_at(contacts.a[i]);
        const double nx = contacts.normal_x[i], ny = contacts.normal_y[i];
        const double of_a =
            contacts.rolling_share.empty() ? 0.5 : static_cast<double>(contacts.rolling_share[i]);
        const ContactImpulses<double> j = impulses[i];
        books.restitution += j.normal * normal_velocity(body, other, nx, ny);
        if (!impulses.friction.empty()) books.friction += j.tangent * tangent_velocity(body, other, nx, ny);
        if (!impulses.rolling.empty()) books.friction += j.rolling * rolling_velocity(body, other, of_a);
    };
    contacts.for_each([&](std::size_t i) {
        if (contacts.b.empty())
            book(i, surface_at(contacts, i));
        else
            book(i, mean_at(contacts.b[i]));
    });
}

/// What supports give to bodies, and what they drive them with by their own motion.
template <class Real>
void SoftSolver<Real>::book_supports(const Impulses& impulses, Books& books) const {
    const auto is_wall = [&](std::size_t i) {
        return graph.supports.partner(static_cast<std::size_t>(supports_.candidate[i])).is_wall();
    };
    double wall_impulse = books.wall_impulse;
    supports_.for_each([&](std::size_t i) { wall_impulse += is_wall(i) ? impulses[i].normal : 0; });
    books.wall_impulse = wall_impulse;
    if (!books.is_open) return;
    supports_.for_each([&](std::size_t i) {
        const Vec2 n{supports_.normal_x[i], supports_.normal_y[i]}, t{-n.y, n.x};
        const ContactImpulses<double> j = impulses[i];
        (is_wall(i) ? books.wall_momentum : books.immovable_momentum) -= j.normal * n + j.tangent * t;
        const DoubleSurface surface = surface_at(supports_, i);
        books.drive -= j.normal * surface.normal + j.tangent * surface.tangent + j.rolling * surface.rolling;
    });
}

/// Books the work of both kinds of contacts; the impulses of walls alone if the ledger is closed.
template <class Real>
template <class From>
void SoftSolver<Real>::book_kinds(const Impulses& of_supports, const Impulses& of_pairs, const From& from,
                                  Books& books) const {
    book_supports(of_supports, books);
    if (!books.is_open) return;
    book_contacts(supports_, of_supports, from, books);
    book_contacts(graph.pairs, of_pairs, from, books);
}

/// Gravity's share is booked as the work it did on velocities, to be set off against the fall of the
/// positions at the end of the step: what is left is displacement that no velocity accounts for.
template <class Real>
void SoftSolver<Real>::book_free_flight(const WorldState<Real>& world, Books& books) {
    const double spin_loss = spin_decay_ - 1;
    const auto from = from_columns(start_x_, start_y_, start_rim_);
    for (std::size_t row = 0; row < count_; ++row) {
        if (world.bodies.is_immovable(row)) continue;
        const double mass = world.bodies.mass[row];
        const DoubleBody start = from(static_cast<std::int32_t>(row));
        const DoubleBody mean = mean_of(start, velocity_, static_cast<std::int32_t>(row));
        const Vec2 by_drag =
            mass * ((decay_ - 1) * velocity_of(start) + gravity_change_ - substep_dt_ * world.gravity);
        gravity_work_ += mass * substep_dt_ * dot(world.gravity, velocity_of(mean));
        books.drag +=
            dot(by_drag, velocity_of(mean)) + 0.5 * mass * spin_loss * start.record[2] * mean.record[2];
        books.drag_momentum += by_drag;
    }
    books.gravity_momentum += (world.dynamic_mass * substep_dt_) * world.gravity;
}

template <class Real>
void SoftSolver<Real>::book_substep(const WorldState<Real>& world, Books& books) {
    const auto from = from_columns(start_x_, start_y_, start_rim_);
    book_kinds({supports_.normal_impulse, supports_.friction_impulse, supports_.rolling_impulse},
               {graph.pairs.normal_impulse, graph.pairs.friction_impulse, graph.pairs.rolling_impulse}, from,
               books);
    if (!books.is_open) return;
    book_free_flight(world, books);
}

template <class Real>
void SoftSolver<Real>::book_bounces(Books& books) const {
    const auto from = [&](std::int32_t row) { return body_at(before_bounce_, row); };
    book_kinds({supports_.bounce_impulse, supports_.bounce_friction, supports_.bounce_rolling},
               {graph.pairs.bounce_impulse, graph.pairs.bounce_friction, graph.pairs.bounce_rolling}, from,
               books);
}

template <class Real>
void SoftSolver<Real>::book_displacements(const WorldState<Real>& world, const Column<Real>& motion,
                                          Books& books) {
    double fall = 0;
    const Bodies<Real>& bodies = world.bodies;
    for (std::size_t row = 0; row < count_; ++row) {
        if (bodies.is_immovable(row)) continue;
        const Vec2 from{motion[4 * row], motion[4 * row + 1]},
            to{bodies.position_x[row], bodies.position_y[row]};
        fall += static_cast<double>(bodies.mass[row]) * dot(world.gravity, to - from);
    }
    books.correction += gravity_work_ - fall;
    gravity_work_ = 0;
}

template void SoftSolver<float>::book_supports(const Impulses&, Books&) const;
template void SoftSolver<double>::book_supports(const Impulses&, Books&) const;
template <class Real>
Sums SoftSolver<Real>::sums_of_lost(const WorldState<Real>& world, std::size_t row) const {
    const Bodies<Real>& bodies = world.bodies;
    const Real* record = &velocity_[4 * row];
    return world.sums_of(row, {bodies.position_x[row], bodies.position_y[row]}, {record[0], record[1]},
                         static_cast<double>(record[2]) / static_cast<double>(bodies.radius[row]));
}

template Sums SoftSolver<float>::sums_of_lost(const WorldState<float>&, std::size_t) const;
template Sums SoftSolver<double>::sums_of_lost(const WorldState<double>&, std::size_t) const;
template void SoftSolver<float>::book_free_flight(const WorldState<float>&, Books&);
template void SoftSolver<double>::book_free_flight(const WorldState<double>&, Books&);
template void SoftSolver<float>::book_substep(const WorldState<float>&, Books&);
template void SoftSolver<double>::book_substep(const WorldState<double>&, Books&);
template void SoftSolver<float>::book_bounces(Books&) const;
template void SoftSolver<double>::book_bounces(Books&) const;
template void SoftSolver<float>::book_displacements(const WorldState<float>&, const Column<float>&, Books&);
template void SoftSolver<double>::book_displacements(const WorldState<double>&, const Column<double>&,
                                                     Books&);

}  // namespace carom
