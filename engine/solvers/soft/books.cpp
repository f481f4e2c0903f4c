// The ledger of solver `soft`: work and momentum by cause, from impulses and velocities, in double precision.
//
// In a substep a body's velocity goes from v0 to v1 by the sum of all impulses on it, so its kinetic energy
// grows by exactly (sum of impulses) · (v0 + v1) / 2, and each impulse's share is its own product with that
// mean. The mean velocity of the surfaces of a contact splits its share into what the contact takes, by its
// normal and by its tangential impulse, and what a moving support drives.
#include "solvers/soft/soft_solver.hpp"

#include "effects/flight.hpp"
#include "math/vec2_math.hpp"

namespace carom {
namespace {

/// Twice the mean of a body's velocity and rim speed over a change.
struct MeanTwice {
    Vec2 v;
    double rim;
};

/// Velocity and rim speed of a row.
struct Moves {
    Vec2 v;
    double rim;
};

template <class Real>
Moves of_record(const Column<Real>& records, std::size_t row) {
    const auto value = [&](std::size_t k) { return static_cast<double>(records[4 * row + k]); };
    return {{value(0), value(1)}, value(2)};
}

template <class From, class Real>
MeanTwice mean_twice(const From& from, const Column<Real>& to, std::int32_t row) {
    const auto i = static_cast<std::size_t>(row);
    const Moves before = from(i), after = of_record(to, i);
    return {before.v + after.v, before.rim + after.rim};
}

/// As book_pairs and its like want it: at the start of the substep.
template <class Real>
auto from_columns(const Column<Real>& x, const Column<Real>& y, const Column<Real>& rim) {
    return [&](std::size_t row) {
        const auto real = [](Real value) { return static_cast<double>(value); };
        return Moves{{real(x[row]), real(y[row])}, rim.empty() ? 0 : real(rim[row])};
    };
}

}  // namespace

/// Of the contacts of one kind.
template <class Real>
struct SoftSolver<Real>::Impulses {
    const Column<Real>&normal, &friction, &rolling;
};

template <class Real>
template <class From>
void SoftSolver<Real>::book_pairs(const Impulses& impulses, const From& from, Books& books) const {
    const Column<Real>&normal = impulses.normal, &friction = impulses.friction, &rolling = impulses.rolling;
    graph.pairs.for_each([&](std::size_t i) {
        const Vec2 n{graph.pairs.normal_x[i], graph.pairs.normal_y[i]};
        const MeanTwice a = mean_twice(from, velocity_, graph.pairs.a[i]),
                        b = mean_twice(from, velocity_, graph.pairs.b[i]);
        const Vec2 v = b.v - a.v;
        books.restitution += 0.5 * static_cast<double>(normal[i]) * dot(v, n);
        if (!friction.empty())
            books.friction += 0.5 * static_cast<double>(friction[i]) * (cross(n, v) - a.rim - b.rim);
        if (rolling.empty()) return;
        const double share =
            graph.pairs.rolling_share.empty() ? 0.5 : static_cast<double>(graph.pairs.rolling_share[i]);
        books.friction += 0.5 * static_cast<double>(rolling[i]) * ((1 - share) * b.rim - share * a.rim);
    });
}

template <class Real>
template <class From>
void SoftSolver<Real>::book_supports(const Impulses& impulses, const From& from, Books& books) const {
    const Column<Real>&normal = impulses.normal, &friction = impulses.friction, &rolling = impulses.rolling;
    const auto is_wall = [&](std::size_t i) {
        return is_wall_support(graph.supports.b[static_cast<std::size_t>(supports_.candidate[i])]);
    };
    double wall_impulse = books.wall_impulse;
    supports_.for_each(
        [&](std::size_t i) { wall_impulse += is_wall(i) ? static_cast<double>(normal[i]) : 0; });
    books.wall_impulse = wall_impulse;
    if (!books.is_open) return;
    supports_.for_each([&](std::size_t i) {
        const Vec2 n{supports_.normal_x[i], supports_.normal_y[i]}, t{-n.y, n.x};
        const double jn = normal[i], jt = friction.empty() ? 0 : static_cast<double>(friction[i]);
        const Vec2 impulse = -1 * (jn * n + jt * t);  // on the body
        (is_wall(i) ? books.wall_momentum : books.immovable_momentum) += impulse;
        const MeanTwice body = mean_twice(from, velocity_, supports_.a[i]);
        const double surface_n = supports_.surface_normal[i], surface_t = supports_.surface_tangent[i];
        books.restitution += jn * (surface_n - 0.5 * dot(body.v, n));
        books.friction += jt * (surface_t - 0.5 * (dot(body.v, t) + body.rim));
        books.drive -= jn * surface_n + jt * surface_t;
        if (rolling.empty()) return;
        const double jr = rolling[i], surface_r = supports_.surface_rolling[i];
        books.friction += jr * (surface_r - 0.5 * static_cast<double>(supports_.rolling_share[i]) * body.rim);
        books.drive -= jr * surface_r;
    });
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
        const MeanTwice mean = mean_twice(from, velocity_, static_cast<std::int32_t>(row));
        const auto [v0, rim0] = from(row);
        const Vec2 by_drag = mass * ((decay_ - 1) * v0 + gravity_change_ - substep_dt_ * world.gravity);
        gravity_work_ += 0.5 * mass * substep_dt_ * dot(world.gravity, mean.v);
        books.drag += 0.5 * dot(by_drag, mean.v) + 0.25 * mass * spin_loss * rim0 * mean.rim;
        books.drag_momentum += by_drag;
    }
    books.gravity_momentum += (world.dynamic_mass * substep_dt_) * world.gravity;
}

template <class Real>
void SoftSolver<Real>::book_substep(const WorldState<Real>& world, Books& books) {
    const auto from = from_columns(start_x_, start_y_, start_rim_);
    book_supports({supports_.normal_impulse, supports_.friction_impulse, supports_.rolling_impulse}, from,
                  books);
    if (!books.is_open) return;
    book_pairs({graph.pairs.normal_impulse, graph.pairs.friction_impulse, graph.pairs.rolling_impulse}, from,
               books);
    book_free_flight(world, books);
}

template <class Real>
void SoftSolver<Real>::book_bounces(Books& books) const {
    const auto from = [&](std::size_t row) { return of_record(before_bounce_, row); };
    book_supports({supports_.bounce_impulse, supports_.bounce_friction, supports_.bounce_rolling}, from,
                  books);
    if (books.is_open)
        book_pairs({graph.pairs.bounce_impulse, graph.pairs.bounce_friction, graph.pairs.bounce_rolling},
                   from, books);
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
