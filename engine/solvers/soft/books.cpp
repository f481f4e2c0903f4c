#include "solvers/soft/books.hpp"

#include "effects/flight.hpp"
#include "math/vec2_math.hpp"
#include "solvers/soft/contacts/stored_contact.hpp"

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

/// The impulses of the contacts of one kind, pairs or supports, by contact [N s].
template <class Real>
struct Impulses {
    const Column<Real>&normal, &friction, &rolling;

    ContactImpulses<double> operator[](std::size_t i) const {
        const auto value = [i](const Column<Real>& column) {
            return column.empty() ? 0 : static_cast<double>(column[i]);
        };
        return {value(normal), value(friction), value(rolling)};
    }
};

/// What a contact takes: the work of its impulses on both sides, by mean velocities.
/// @param from  velocities before the impulses acted, by row
/// @param to  velocity records after them
template <class Real, class From>
void book_contacts(const ContactRows<Real>& contacts, const Impulses<Real>& impulses, const From& from,
                   const Column<Real>& to, Books& books) {
    const auto mean_at = [&](std::int32_t row) { return mean_of(from(row), to, row); };
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
void book_supports(const StepView<Real>& step, const Impulses<Real>& impulses, Books& books) {
    const ContactRows<Real>& supports = step.supports;
    const auto is_wall = [&](std::size_t i) {
        return step.graph.supports.partner(static_cast<std::size_t>(supports.candidate[i])).is_wall();
    };
    double wall_impulse = books.wall_impulse;
    supports.for_each([&](std::size_t i) { wall_impulse += is_wall(i) ? impulses[i].normal : 0; });
    books.wall_impulse = wall_impulse;
    if (!books.is_open) return;
    supports.for_each([&](std::size_t i) {
        const Vec2 n{supports.normal_x[i], supports.normal_y[i]}, t{-n.y, n.x};
        const ContactImpulses<double> j = impulses[i];
        (is_wall(i) ? books.wall_momentum : books.immovable_momentum) -= j.normal * n + j.tangent * t;
        const DoubleSurface surface = surface_at(supports, i);
        books.drive -= j.normal * surface.normal + j.tangent * surface.tangent + j.rolling * surface.rolling;
    });
}

/// Books the work of both kinds of contacts; the impulses of walls alone if the ledger is closed.
template <class Real, class From>
void book_kinds(const StepView<Real>& step, const Impulses<Real>& of_supports, const Impulses<Real>& of_pairs,
                const From& from, Books& books) {
    book_supports(step, of_supports, books);
    if (!books.is_open) return;
    book_contacts(step.supports, of_supports, from, step.records.velocity, books);
    book_contacts(step.graph.pairs, of_pairs, from, step.records.velocity, books);
}

/// Velocities at the start of the substep, by row.
template <class Real>
auto starts_of_substep(const BodyRecords<Real>& records) {
    return [&records](std::int32_t row) {
        const auto [x, y, rim] = records.start_of_substep(row);
        return DoubleBody{{{x, y, rim, 0}}};  // its mass is not asked for
    };
}

}  // namespace

/// Gravity's share is booked as the work it did on velocities, to be set off against the fall of the
/// positions at the end of the step: what is left is displacement that no velocity accounts for.
template <class Real>
void SubstepBooks<Real>::book_free_flight(const StepView<Real>& step, const WorldState<Real>& world,
                                          Books& books) {
    const SubstepTerms& terms = step.terms;
    const double h = terms.substep_dt, spin_loss = terms.spin_decay - 1;
    const auto from = starts_of_substep(step.records);
    for (std::size_t row = 0; row < step.records.moving(); ++row) {
        if (world.bodies.is_immovable(row)) continue;
        const double mass = world.bodies.mass[row];
        const DoubleBody start = from(static_cast<std::int32_t>(row));
        const DoubleBody mean = mean_of(start, step.records.velocity, static_cast<std::int32_t>(row));
        const Vec2 by_drag =
            mass * ((terms.decay - 1) * velocity_of(start) + terms.gravity_change - h * world.gravity);
        gravity_work += mass * h * dot(world.gravity, velocity_of(mean));
        books.drag +=
            dot(by_drag, velocity_of(mean)) + 0.5 * mass * spin_loss * start.record[2] * mean.record[2];
        books.drag_momentum += by_drag;
    }
    books.gravity_momentum += (world.dynamic_mass * h) * world.gravity;
}

template <class Real>
void SubstepBooks<Real>::book_substep(const StepView<Real>& step, const WorldState<Real>& world,
                                      Books& books) {
    const ContactRows<Real>&pairs = step.graph.pairs, &supports = step.supports;
    book_kinds<Real>(step, {supports.normal_impulse, supports.friction_impulse, supports.rolling_impulse},
                     {pairs.normal_impulse, pairs.friction_impulse, pairs.rolling_impulse},
                     starts_of_substep(step.records), books);
    if (books.is_open) book_free_flight(step, world, books);
}

template <class Real>
void SubstepBooks<Real>::book_displacements(std::size_t rows, const WorldState<Real>& world,
                                            const Column<Real>& motion, Books& books) {
    double fall = 0;
    const Bodies<Real>& bodies = world.bodies;
    for (std::size_t row = 0; row < rows; ++row) {
        if (bodies.is_immovable(row)) continue;
        const Vec2 from{motion[4 * row], motion[4 * row + 1]},
            to{bodies.position_x[row], bodies.position_y[row]};
        fall += static_cast<double>(bodies.mass[row]) * dot(world.gravity, to - from);
    }
    books.correction += gravity_work - fall;
    gravity_work = 0;
}

template class SubstepBooks<float>;
template class SubstepBooks<double>;

}  // namespace carom
