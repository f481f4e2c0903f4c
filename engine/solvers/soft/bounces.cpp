// Restitution of solver `soft`: what came to touch in this step leaves with its share of the speed it came
// with.
#include "solvers/soft/soft_solver.hpp"

#include <algorithm>
#include <cmath>

#include "effects/restitution.hpp"
#include "math/vec2_math.hpp"

namespace carom {
namespace {

/// What comes slower than gravity would make it in this many substeps is at rest and does not bounce.
constexpr double kRestingFalls = 2;
constexpr int kMostBounceSweeps = 64;
/// Bounces have converged when no sweep changes a velocity by more than this share of the fastest impact.
template <class Real>
constexpr double kBounceTolerance = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-14;

}  // namespace

template <class Real>
double SoftSolver<Real>::restitution_of(const ContactRows<Real>& live, std::size_t contact,
                                        const WorldState<Real>& world) const {
    const Bodies<Real>& bodies = world.bodies;
    const double of_a = bodies.restitution[static_cast<std::size_t>(live.a[contact])];
    if (!live.b.empty())
        return pair_restitution(of_a, bodies.restitution[static_cast<std::size_t>(live.b[contact])]);
    const Partner support = graph.supports.partner(static_cast<std::size_t>(live.candidate[contact]));
    if (support.is_wall()) return pair_restitution(of_a, world.walls->material.restitution);
    const std::size_t row =
        support.is_edge() ? world.handles.row_of_slot(world.edges.body_of(support.edge_number()).id.index)
                          : static_cast<std::size_t>(support.row());
    return pair_restitution(of_a, bodies.restitution[row]);
}

/// Speed of the approach when the surfaces met [m/s]: v² = v0² + 2 g·n s on the way s that was left at the
/// start of the step. Two bodies fall alike, so that theirs is the v0 of the start. Zero if they did not
/// meet.
template <class Real>
double SoftSolver<Real>::impact_speed(const ContactRows<Real>& live, std::size_t contact) const {
    if (!(live.largest_impulse[contact] > 0)) return 0;
    const double approach = live.approach[contact];
    if (!live.b.empty()) return std::fmax(-approach, 0);
    const Vec2 n{live.normal_x[contact], live.normal_y[contact]};
    const double way = std::fmax(static_cast<double>(live.separation[contact]), 0);
    const double squared = approach * approach + 2 * way * dot(n, gravity_change_) / substep_dt_;
    const bool comes = approach < 0 || (way > 0 && dot(n, gravity_change_) > 0);
    return comes ? std::sqrt(std::fmax(squared, 0)) : 0;
}

/// Writes the normal velocity each contact must have after the impacts. @return whether anything bounces.
template <class Real>
bool SoftSolver<Real>::find_bounces(ContactRows<Real>& live, const WorldState<Real>& world) {
    constexpr Real kNone = Real(-1e30);  // m/s, a floor below everything: a contact that did not touch
    const double at_rest = kRestingFalls * std::sqrt(length_squared(gravity_change_));
    bool any = false;
    live.for_each([&](std::size_t i) {
        live.largest_impulse[i] =
            std::max(live.largest_impulse[i], live.normal_impulse[i]);  // of the last substep
        live.floor[i] = live.largest_impulse[i] > 0 ? Real(0) : kNone;
        const double speed = impact_speed(live, i);
        if (!(speed > at_rest)) return;
        const double restitution = restitution_of(live, i, world);
        if (restitution == 0) return;
        live.floor[i] = static_cast<Real>(restitution * speed);
        fastest_bounce_ = std::fmax(fastest_bounce_, speed);
        any = true, ++counters.bounces;
    });
    return any;
}

/// The largest change of an impulse since the last sweep, as a velocity [m/s]; remembers them for the next.
template <class Real>
double SoftSolver<Real>::change_of_bounces(ContactRows<Real>& live) const {
    double largest = 0;
    live.for_each([&](std::size_t i) {
        const double mass = live.mass[i], change = std::fabs(live.bounce_impulse[i] - live.spare[i]);
        if (mass > 0) largest = std::fmax(largest, change / mass);
        live.spare[i] = live.bounce_impulse[i];
    });
    return largest;
}

/// Sweeps over all contacts that touched in this step, until every impact leaves with its speed and nothing
/// that touches approaches. These impulses are beside the ones that contacts keep: a bounce is no load.
template <class Real>
void SoftSolver<Real>::sweep_bounces() {
    const auto arguments_for = [&](ContactRows<Real>& live) {
        for (Column<Real>* column :
             {&live.bounce_impulse, &live.bounce_friction, &live.bounce_rolling, &live.spare})
            std::fill(column->begin(), column->end(), Real(0));
        SolveContacts<Real> k = arguments(live);
        k.contacts.normal_impulse = live.bounce_impulse.data();
        k.contacts.friction_impulse = live.bounce_friction.data();
        k.contacts.rolling_impulse = live.bounce_rolling.data();
        k.contacts.largest_impulse = nullptr;
        return k;
    };
    const SolveContacts<Real> on_pairs = arguments_for(graph.pairs), on_supports = arguments_for(supports_);
    const Sweep once{contact_kernels().next_pairs, contact_kernels().next_supports};
    for (int sweeps = 0; sweeps < kMostBounceSweeps; ++sweeps) {
        sweep({&once, 1}, on_pairs, on_supports);
        const double change = std::fmax(change_of_bounces(graph.pairs), change_of_bounces(supports_));
        if (change <= kBounceTolerance<Real> * fastest_bounce_) break;
    }
}

template <class Real>
void SoftSolver<Real>::bounce(const WorldState<Real>& world, Books& books) {
    fastest_bounce_ = 0;
    const bool any_pair = find_bounces(graph.pairs, world), any_support = find_bounces(supports_, world);
    if (!any_pair && !any_support) return;
    if (books.is_open) before_bounce_ = velocity_;
    sweep_bounces();
    book_bounces(books);
}

template double SoftSolver<float>::restitution_of(const ContactRows<float>&, std::size_t,
                                                  const WorldState<float>&) const;
template double SoftSolver<float>::impact_speed(const ContactRows<float>&, std::size_t) const;
template bool SoftSolver<float>::find_bounces(ContactRows<float>&, const WorldState<float>&);
template double SoftSolver<float>::change_of_bounces(ContactRows<float>&) const;
template void SoftSolver<float>::sweep_bounces();
template void SoftSolver<float>::bounce(const WorldState<float>&, Books&);
template double SoftSolver<double>::restitution_of(const ContactRows<double>&, std::size_t,
                                                   const WorldState<double>&) const;
template double SoftSolver<double>::impact_speed(const ContactRows<double>&, std::size_t) const;
template bool SoftSolver<double>::find_bounces(ContactRows<double>&, const WorldState<double>&);
template double SoftSolver<double>::change_of_bounces(ContactRows<double>&) const;
template void SoftSolver<double>::sweep_bounces();
template void SoftSolver<double>::bounce(const WorldState<double>&, Books&);

}  // namespace carom
