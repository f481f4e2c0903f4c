#include "solvers/event/event_impacts.hpp"

#include <algorithm>
#include <cmath>

#include "effects/contact_law.hpp"
#include "effects/friction.hpp"
#include "effects/restitution.hpp"
#include "narrowphase/coincident.hpp"

namespace carom {
namespace {

// Sweeps end when no impulse changes a velocity by more than this part of the fastest approach.
constexpr int kMostSweeps = 1000;
constexpr double kConverged = 1e-15;

Vec2 turned(Vec2 v) {  // by 90° counter-clockwise
    return {-v.y, v.x};
}

Vec2 impulse_of(const EventContact& c) {
    return c.impulse * c.normal + c.friction_impulse * turned(c.normal);
}

}  // namespace

EventContact EventImpacts::measure(const EventStore& store, std::int32_t a, std::int32_t b,
                                   double time) const {
    EventContact c;
    c.a = a, c.b = b;
    const auto ia = static_cast<std::size_t>(a);
    const Vec2 xa = store.position_at(ia, time), va = store.velocity_at(ia, time);
    const EventSurface& sa = store.surfaces[ia];
    const double ra = store.movers[ia].radius;
    Vec2 velocity;
    double surface_speed = ra * sa.spin, inverse_inertia = ra * ra * sa.inverse_inertia;
    c.inverse_mass = sa.inverse_mass;
    if (b < 0) {
        const EventWall& wall = store.laws.walls[static_cast<std::size_t>(-1 - b)];
        c.normal = -wall.normal;
        c.separation = dot(wall.normal, xa) - wall.offset - ra;
        velocity = -va;
        c.friction = pair_friction(sa.friction, store.laws.wall_friction);
    } else {
        const auto ib = static_cast<std::size_t>(b);
        const EventSurface& sb = store.surfaces[ib];
        const double rb = store.movers[ib].radius;
        const Vec2 d = store.position_at(ib, time) - xa;
        const double distance = std::sqrt(length_squared(d));
        c.normal = distance > 0
                       ? (1 / distance) * d
                       : normal_of_coincident(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
        c.separation = distance - (ra + rb);
        velocity = store.velocity_at(ib, time) - va;
        surface_speed += rb * sb.spin;
        inverse_inertia += rb * rb * sb.inverse_inertia;
        c.inverse_mass += sb.inverse_mass;
        c.friction = pair_friction(sa.friction, sb.friction);
    }
    // The normal's length is 1 but for round-off, whose mean is not zero (of sqrt, where the reach is a power
    // of two). What J changes along it is J k n², and counting that keeps the energy of 1e6 impacts: 1e-13,
    // not 1e-12.
    c.inverse_mass *= length_squared(c.normal);
    c.inverse_slip_mass = c.inverse_mass + inverse_inertia;
    c.normal_velocity = dot(velocity, c.normal);
    c.slip = dot(velocity, turned(c.normal)) - surface_speed;
    c.normal_velocity_after = c.normal_velocity, c.slip_bounced = c.slip_after = c.slip;
    return c;
}

/// Restitution, the collapse rule applied.
void EventImpacts::set_targets(const EventStore& store, EventContact& c, double time) {
    const EventSurface& sa = store.surfaces[static_cast<std::size_t>(c.a)];
    double restitution = 0, last = sa.last_impact, floor = rule.slowest_speed;
    const bool has_partner = c.b >= 0;
    const auto ib = static_cast<std::size_t>(has_partner ? c.b : 0);
    restitution = pair_restitution(
        sa.restitution, has_partner ? store.surfaces[ib].restitution : store.laws.wall_restitution);
    if (has_partner && !store.is_immovable(ib))
        last = std::max(last, store.surfaces[ib].last_impact);
    else  // what it falls back on within the contact time is a support: it stays off for that long
        floor = std::max(floor, 0.5 * rule.contact_time * dot(store.laws.gravity, c.normal));
    if (restitution < 1 && time - last < rule.contact_time) restitution = 1, ++counters->collapse_impacts;
    c.target = -restitution * c.normal_velocity;
    if (c.target < floor) c.target = floor, ++counters->collapse_impacts;
}

void EventImpacts::apply(EventStore& store, const EventContact& c, double time) {
    const Vec2 impulse = impulse_of(c);
    const auto push = [&](std::int32_t disc, double sign) {
        const auto i = static_cast<std::size_t>(disc);
        EventSurface& surface = store.surfaces[i];
        store.movers[i].velocity += (sign * surface.inverse_mass) * impulse;
        surface.last_impact = time;
        if (c.friction_impulse == 0) return;
        surface.angle = store.angle_at(i, time), surface.angle_time = time;
        surface.spin -= store.movers[i].radius * surface.inverse_inertia * c.friction_impulse;
    };
    push(c.a, -1);
    if (c.b >= 0 && !store.is_immovable(static_cast<std::size_t>(c.b))) push(c.b, 1);
    ++counters->impacts;
    if (c.b < 0) ++counters->wall_impacts;
    if (books) book(store, c);
}

void EventImpacts::book(const EventStore& store, const EventContact& c) {
    const Vec2 impulse = impulse_of(c);
    if (c.b < 0) {
        books->add_wall_impulse(-c.impulse * c.normal);
        books->wall_momentum -= c.friction_impulse * turned(c.normal);
    }
    if (!books->is_open) return;
    books->restitution += impact_work(c.impulse, c.normal_velocity, c.normal_velocity_after);
    books->friction += impact_work(c.friction_impulse, c.slip_bounced, c.slip_after);
    const auto ib = static_cast<std::size_t>(c.b);
    if (c.b < 0 || !store.is_immovable(ib)) return;
    books->immovable_momentum -= impulse;
    // The rim of B moves against the tangent, and so does friction push A.
    books->drive -= dot(impulse, store.movers[ib].velocity);
    books->drive += c.friction_impulse * store.movers[ib].radius * store.surfaces[ib].spin;
}

void EventImpacts::carry_out(EventStore& store, EventContact& c, double time) {
    store.bring_to(static_cast<std::size_t>(c.a), time);
    if (c.b >= 0) store.bring_to(static_cast<std::size_t>(c.b), time);
    set_targets(store, c, time);
    c.impulse = (c.target - c.normal_velocity) / c.inverse_mass;
    c.normal_velocity_after = c.target;
    if (c.friction > 0) {
        c.friction_impulse = hold_within(0.0, -c.slip / c.inverse_slip_mass, c.friction * c.impulse).impulse;
        c.slip_after = c.slip + c.friction_impulse * c.inverse_slip_mass;
    }
    apply(store, c, time);
}

EventImpacts::Change* EventImpacts::change_of(const EventStore& store, std::int32_t disc) {
    if (disc < 0 || store.is_immovable(static_cast<std::size_t>(disc))) return nullptr;
    if (place_of_disc_.size() < store.count()) place_of_disc_.resize(store.count(), -1);
    std::int32_t& place = place_of_disc_[static_cast<std::size_t>(disc)];
    if (place < 0) {
        place = static_cast<std::int32_t>(changes_.size());
        changes_.emplace_back();
    }
    return &changes_[static_cast<std::size_t>(place)];
}

/// @return the largest change of a velocity [m/s].
double EventImpacts::solve_sweep(const EventStore& store, std::vector<EventContact>& contacts,
                                 bool with_friction) {
    double largest = 0;
    for (EventContact& c : contacts) {
        Change* a = change_of(store, c.a);
        Change* b = change_of(store, c.b);
        Vec2 velocity = -a->velocity;
        if (b) velocity += b->velocity;
        const Vec2 tangent = turned(c.normal);
        const auto spin_of = [&](const Change* change, std::int32_t disc) {
            return change ? store.movers[static_cast<std::size_t>(disc)].radius * change->spin : 0;
        };
        double change = 0;
        if (with_friction) {
            const double slip = c.slip + dot(velocity, tangent) - spin_of(a, c.a) - spin_of(b, c.b);
            const auto friction = hold_within(
                c.friction_impulse, c.friction_impulse - slip / c.inverse_slip_mass, c.friction * c.impulse);
            c.friction_impulse = friction.impulse, change = friction.added;
        } else {
            const double speed = c.normal_velocity + dot(velocity, c.normal);
            const auto normal = push_only(c.impulse, c.impulse - (speed - c.target) / c.inverse_mass);
            c.impulse = normal.impulse, change = normal.added;
        }
        const Vec2 along = change * (with_friction ? tangent : c.normal);
        const auto push = [&](Change* of, std::int32_t disc, double sign) {
            if (!of) return;
            const EventSurface& surface = store.surfaces[static_cast<std::size_t>(disc)];
            of->velocity += (sign * surface.inverse_mass) * along;
            if (with_friction)
                of->spin -=
                    store.movers[static_cast<std::size_t>(disc)].radius * surface.inverse_inertia * change;
        };
        push(a, c.a, -1), push(b, c.b, 1);
        largest =
            std::max(largest, std::fabs(change) * (with_friction ? c.inverse_slip_mass : c.inverse_mass));
    }
    return largest;
}

/// What the impulses so far have made of the velocities. Each of the two solves takes energy on its own, so
/// that neither books what is the other's.
void EventImpacts::measure_after(const EventStore& store, std::vector<EventContact>& contacts,
                                 bool with_friction) {
    for (EventContact& c : contacts) {
        Vec2 velocity = -change_of(store, c.a)->velocity;
        double spins = store.movers[static_cast<std::size_t>(c.a)].radius * change_of(store, c.a)->spin;
        if (const Change* b = change_of(store, c.b)) {
            velocity += b->velocity;
            spins += store.movers[static_cast<std::size_t>(c.b)].radius * b->spin;
        }
        c.slip_after = c.slip + dot(velocity, turned(c.normal)) - spins;
        if (with_friction) continue;
        c.normal_velocity_after = c.normal_velocity + dot(velocity, c.normal);
        c.slip_bounced = c.slip_after;
    }
}

void EventImpacts::carry_out(EventStore& store, std::vector<EventContact>& contacts, double time) {
    double fastest = 0;
    bool has_friction = false;
    for (EventContact& c : contacts) {
        set_targets(store, c, time);
        fastest = std::max({fastest, -c.normal_velocity, std::fabs(c.slip)});
        has_friction = has_friction || c.friction > 0;
        change_of(store, c.a), change_of(store, c.b);
    }
    for (const bool with_friction : {false, true}) {
        if (with_friction && !has_friction) break;
        for (int sweep = 0; sweep < kMostSweeps; ++sweep)
            if (solve_sweep(store, contacts, with_friction) <= kConverged * fastest) break;
        measure_after(store, contacts, with_friction);
    }
    for (const EventContact& c : contacts)
        for (const std::int32_t disc : {c.a, c.b})
            if (disc >= 0 && store.movers[static_cast<std::size_t>(disc)].time != time)
                store.bring_to(static_cast<std::size_t>(disc), time);
    for (const EventContact& c : contacts)
        if (c.impulse > 0) apply(store, c, time);
    counters->simultaneous_impacts += static_cast<std::int64_t>(contacts.size());
    for (const EventContact& c : contacts)
        for (const std::int32_t disc : {c.a, c.b})
            if (disc >= 0) place_of_disc_[static_cast<std::size_t>(disc)] = -1;
    changes_.clear();
}

std::size_t EventImpacts::bytes() const {
    return changes_.capacity() * sizeof(Change) + place_of_disc_.capacity() * sizeof(std::int32_t);
}

}  // namespace carom
