#include "solvers/soft/bounces.hpp"

#include <algorithm>
#include <cmath>

#include "effects/restitution.hpp"
#include "math/vec2_math.hpp"
#include "solvers/soft/books.hpp"

namespace carom {
namespace {

/// What comes slower than gravity would make it in this many substeps is at rest and does not bounce.
constexpr double kRestingFalls = 2;
constexpr int kMostBounceSweeps = 64;
/// Bounces have converged when no sweep changes a velocity by more than this share of the fastest impact.
template <class Real>
constexpr double kBounceTolerance = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-14;

template <class Real>
double restitution_of(const ContactRows<Real>& live, std::size_t contact, const ContactGraph<Real>& graph,
                      const WorldState<Real>& world) {
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
double impact_speed(const ContactRows<Real>& live, std::size_t contact, const SubstepTerms& terms) {
    if (!(live.largest_impulse[contact] > 0)) return 0;
    const double approach = live.approach[contact];
    if (!live.b.empty()) return std::fmax(-approach, 0);
    const Vec2 n{live.normal_x[contact], live.normal_y[contact]};
    const double way = std::fmax(static_cast<double>(live.separation[contact]), 0);
    const double squared = approach * approach + 2 * way * dot(n, terms.gravity_change) / terms.substep_dt;
    const bool comes = approach < 0 || (way > 0 && dot(n, terms.gravity_change) > 0);
    return comes ? std::sqrt(std::fmax(squared, 0)) : 0;
}

/// The largest change of an impulse since the last sweep, as a velocity [m/s]; remembers them for the next.
template <class Real>
double change_of_bounces(ContactRows<Real>& live) {
    double largest = 0;
    live.for_each([&](std::size_t i) {
        const double mass = live.mass[i], change = std::fabs(live.bounce_impulse[i] - live.spare[i]);
        if (mass > 0) largest = std::fmax(largest, change / mass);
        live.spare[i] = live.bounce_impulse[i];
    });
    return largest;
}

}  // namespace

/// Writes the normal velocity each contact must have after the impacts. @return how many bounce
template <class Real>
std::int64_t Bounces<Real>::find(ContactRows<Real>& live, const StepView<Real>& step,
                                 const WorldState<Real>& world) {
    constexpr Real kNone = Real(-1e30);  // m/s, a floor below everything: a contact that did not touch
    const double at_rest = kRestingFalls * step.terms.fall_speed();
    std::int64_t count = 0;
    live.for_each([&](std::size_t i) {
        live.largest_impulse[i] =
            std::max(live.largest_impulse[i], live.normal_impulse[i]);  // of the last substep
        live.floor[i] = live.largest_impulse[i] > 0 ? Real(0) : kNone;
        const double speed = impact_speed(live, i, step.terms);
        if (!(speed > at_rest)) return;
        const double restitution = restitution_of(live, i, step.graph, world);
        if (restitution == 0) return;
        live.floor[i] = static_cast<Real>(restitution * speed);
        fastest_ = std::fmax(fastest_, speed);
        ++count;
    });
    return count;
}

/// Sweeps over all contacts that touched in this step, until every impact leaves with its speed and nothing
/// that touches approaches. These impulses are beside the ones that contacts keep: a bounce is no load.
template <class Real>
void Bounces<Real>::sweep(const StepView<Real>& step, ContactSweeps<Real>& sweeps) const {
    const auto arguments_for = [&](ContactRows<Real>& live) {
        for (Column<Real>* column :
             {&live.bounce_impulse, &live.bounce_friction, &live.bounce_rolling, &live.spare})
            std::fill(column->begin(), column->end(), Real(0));
        SolveContacts<Real> k = ContactSweeps<Real>::arguments(step, live);
        k.contacts.normal_impulse = live.bounce_impulse.data();
        k.contacts.friction_impulse = live.bounce_friction.data();
        k.contacts.rolling_impulse = live.bounce_rolling.data();
        k.contacts.largest_impulse = nullptr;
        return k;
    };
    const SolveContacts<Real> on_pairs = arguments_for(step.graph.pairs),
                              on_supports = arguments_for(step.supports);
    const typename ContactSweeps<Real>::Sweep once{step.loops.contacts->next_pairs,
                                                   step.loops.contacts->next_supports};
    for (int number = 0; number < kMostBounceSweeps; ++number) {
        sweeps.run(step, {&once, 1}, on_pairs, on_supports);
        const double change =
            std::fmax(change_of_bounces(step.graph.pairs), change_of_bounces(step.supports));
        if (change <= kBounceTolerance<Real> * fastest_) break;
    }
}

template <class Real>
void Bounces<Real>::begin_step(const StepView<Real>& step) {
    for (ContactRows<Real>* live : {&step.graph.pairs, &step.supports})
        for (Column<Real>* column : {&live->largest_impulse, &live->bounce_impulse})
            std::fill(column->begin(), column->end(), Real(0));
}

template <class Real>
std::int64_t Bounces<Real>::bounce(const StepView<Real>& step, ContactSweeps<Real>& sweeps,
                                   const WorldState<Real>& world, Books& books) {
    fastest_ = 0;
    const std::int64_t of_pairs = find(step.graph.pairs, step, world),
                       of_supports = find(step.supports, step, world);
    if (of_pairs == 0 && of_supports == 0) return 0;
    if (books.is_open) before_ = step.records.velocity;
    sweep(step, sweeps);
    book_bounces(step, before_, books);
    return of_pairs + of_supports;
}

template class Bounces<float>;
template class Bounces<double>;

}  // namespace carom
