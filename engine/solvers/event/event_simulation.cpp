#include "solvers/event/event_simulation.hpp"

#include <algorithm>
#include <cmath>

#include "effects/touching.hpp"
#include "scene/validation/wording.hpp"
#include "shapes/walls.hpp"

// Between the columns of a world and solver `event`, which keeps discs in an order and a precision of its
// own.

namespace carom {
namespace {

EventLaws laws_of(const std::optional<Walls>& walls, Vec2 gravity) {
    EventLaws laws;
    laws.gravity = gravity;
    if (!walls) return laws;
    for (const std::int32_t side : kWallSides) {
        const Vec2 inward = -wall_normal(side);
        laws.walls[static_cast<std::size_t>(-1 - side)] = {has_wall(*walls, side), inward,
                                                           dot(inward, wall_corner(*walls, side))};
    }
    laws.wall_restitution = walls->material.restitution;
    laws.wall_friction = walls->material.friction;
    return laws;
}

template <class Real>
EventBody body_of(const Bodies<Real>& bodies, std::size_t row) {
    EventBody body;
    body.position = {bodies.position_x[row], bodies.position_y[row]};
    body.velocity = {bodies.velocity_x[row], bodies.velocity_y[row]};
    if (bodies.has_rotation) body.angle = bodies.angle[row], body.spin = bodies.angular_velocity[row];
    body.radius = bodies.radius[row];
    body.inverse_mass = bodies.inverse_mass(row);
    const bool turns = bodies.has_rotation && (bodies.flags_of(row) & kFixedAngle) == 0;
    body.inverse_inertia = turns ? 2 * body.inverse_mass / (body.radius * body.radius) : 0;
    body.restitution = bodies.restitution[row], body.friction = bodies.friction[row];
    return body;
}

std::string label_of(BodyId id) {
    return "body " + std::to_string(id.index);
}

template <class Real>
void refuse_overlap(const EventSimulation<Real>& sim, std::string_view where) {
    const auto overlap = sim.events.find_overlap(kSlopFraction);
    if (!overlap) return;
    const auto id_of = [&](std::int32_t row) {
        return sim.world.bodies.id[static_cast<std::size_t>(sim.event_rows[static_cast<std::size_t>(row)])];
    };
    const std::string other = overlap->b < 0 ? "a wall" : label_of(id_of(overlap->b));
    throw Error(
        ErrorCode::inconsistent,
        join(where, ": ", label_of(id_of(overlap->a)), " and ", other, " overlap by ", -overlap->separation,
             " m; the solver \"event\" needs at most ", kSlopFraction,
             " of the smaller radius. Move them apart, or use \"impulse\", which pushes them apart."));
}

/// Writes a disc's state into its row. @return whether it is within the limits
template <class Real>
bool write_row(Bodies<Real>& bodies, std::size_t row, const EventDynamics::State& state) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    const bool is_sound = std::fabs(state.position.x) <= kLargestPosition &&
                          std::fabs(state.position.y) <= kLargestPosition &&
                          length_squared(state.velocity) <= kLargestSpeed * kLargestSpeed;
    if (!is_sound) return false;
    bodies.position_x[row] = real(state.position.x), bodies.position_y[row] = real(state.position.y);
    bodies.velocity_x[row] = real(state.velocity.x), bodies.velocity_y[row] = real(state.velocity.y);
    if (bodies.has_rotation)
        bodies.angle[row] = real(state.angle), bodies.angular_velocity[row] = real(state.spin);
    return true;
}

template <class Real>
void hand_over(EventSimulation<Real>& sim) {
    std::vector<EventBody> bodies;
    for (std::size_t row = 0; row < sim.world.bodies.count; ++row) {
        if ((sim.world.bodies.flags_of(row) & kDisabled) != 0) continue;
        sim.event_rows.push_back(static_cast<std::int32_t>(row));
        bodies.push_back(body_of(sim.world.bodies, row));
    }
    sim.events.load(bodies, laws_of(sim.world.walls, sim.world.gravity));
}

/// Ends the step with the words that its error will have.
template <class Real>
void give_up(EventSimulation<Real>& sim, double dt) {
    const EventDynamics::Busiest busiest = sim.events.find_busiest();
    const auto label = [&](std::int32_t row) -> std::string {
        if (row < 0) return "a wall";
        return label_of(
            sim.world.bodies.id[static_cast<std::size_t>(sim.event_rows[static_cast<std::size_t>(row)])]);
    };
    std::string most;
    for (std::size_t i = 0; i < std::min<std::size_t>(busiest.sides.size(), 2); ++i)
        most += join(i == 0 ? "" : " and ", label(busiest.sides[i].row), " (", busiest.sides[i].impacts, ")");
    sim.interruption.give_up(join(
        "the step of ", dt, " s from ", sim.world.time, " s on was given up after ", sim.flight_dt,
        " s, because it has more than ", sim.events.most_impacts(),
        " impacts, the limit of solver \"event\" for so many bodies. Of the last ", busiest.impacts,
        " most were of ", most,
        ". Where bodies are squeezed or come to rest use \"soft\" or \"auto\"; else take a shorter step."));
}

}  // namespace

template <class Real>
void EventSimulation<Real>::check_bodies(std::string_view where) {
    if (!event_rows.empty()) return;
    hand_over(*this);
    refuse_overlap(*this, where);
}

template <class Real>
void run_events(EventSimulation<Real>& sim) {
    WorldState<Real>& world = sim.world;
    if (sim.event_rows.empty()) hand_over(sim);
    sim.events.keep_books(&world.books);
    const double wanted = sim.flight_dt;
    sim.flight_dt = sim.events.advance(wanted, sim.interruption);
    if (sim.events.has_given_up()) give_up(sim, wanted);
    if (world.books.is_open)
        world.books.gravity_momentum += (world.dynamic_mass * sim.flight_dt) * world.gravity;
    bool any_lost = false;
    for (std::size_t i = 0; i < sim.event_rows.size(); ++i) {
        const auto row = static_cast<std::size_t>(sim.event_rows[i]);
        const EventDynamics::State state = sim.events.state(i);
        if (write_row(world.bodies, row, state)) continue;
        world.quarantine(row, world.sums_of(row, state.position, state.velocity, state.spin));
        any_lost = true;
    }
    sim.candidates.invalidate();  // no pairs were kept while the bodies moved
    if (any_lost) sim.forget_derived_state();
}

template <class Real>
void EventSimulation<Real>::forget_derived_state() {
    this->candidates.invalidate();
    event_rows.clear();
}

template <class Real>
void EventSimulation<Real>::report(Profile& profile) const {
    const EventCounters& counters = events.counters();
    profile.pair_tests += counters.pair_tests;
    profile.impacts += counters.impacts, profile.wall_impacts += counters.wall_impacts;
    profile.simultaneous_impacts += counters.simultaneous_impacts;
}

template <class Real>
std::size_t EventSimulation<Real>::bytes() const {
    return Simulation<Real>::bytes() + sizeof(*this) + events.bytes() +
           event_rows.capacity() * sizeof(std::int32_t);
}

template class EventSimulation<float>;
template class EventSimulation<double>;
template void run_events(EventSimulation<float>&);
template void run_events(EventSimulation<double>&);

}  // namespace carom
