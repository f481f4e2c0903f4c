#include "solvers/soft/sensors.hpp"

#include <algorithm>
#include <cmath>

#include "shapes/convex_geometry.hpp"
#include "solvers/soft/stages.hpp"

namespace carom {
namespace {

/// Bodies that come farther in a step, in thicknesses of the thinner one, may have passed.
constexpr double kFastThicknesses = 0.5;
/// As near as this share of the thickness counts as met on the way.
constexpr double kMeetingTarget = 1e-3;

}  // namespace

template <class Real>
Vec2 SensorFinder<Real>::velocity(std::size_t row) const {
    return {world_.bodies.velocity_x[row], world_.bodies.velocity_y[row]};
}

template <class Real>
double SensorFinder<Real>::spin(std::size_t row) const {
    return world_.bodies.has_rotation ? static_cast<double>(world_.bodies.angular_velocity[row]) : 0;
}

/// Whether a row can change its place: a body that rests and one that sleeps can.
template <class Real>
bool SensorFinder<Real>::moves(std::size_t row) const {
    return !world_.bodies.is_immovable(row) || (world_.bodies.flags_of(row) & kKinematic) != 0;
}

template <class Real>
double SensorFinder<Real>::way_of(std::size_t row) const {
    return dt_ * std::sqrt(length_squared(velocity(row)));
}

/// A body at the end of the step, whatever its shape but edges.
template <class Real>
MovingConvex SensorFinder<Real>::moving(std::size_t row) const {
    const Bodies<Real>& bodies = world_.bodies;
    const Vec2 at{bodies.position_x[row], bodies.position_y[row]};
    const double angle = bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0;
    const ConvexShape<double> shape =
        bodies.has_shapes ? placed(world_.shapes[bodies.shape[row]], at, {}).shape
                          : convex_shape_of<double>(Disc{static_cast<double>(bodies.radius[row])});
    return {shape, at, velocity(row), angle, spin(row)};
}

/// Whether the discs around both were apart all the time.
template <class Real>
bool SensorFinder<Real>::is_apart(std::size_t sensor, std::size_t body) const {
    const Bodies<Real>& bodies = world_.bodies;
    const Vec2 apart{
        static_cast<double>(bodies.position_x[body]) - static_cast<double>(bodies.position_x[sensor]),
        static_cast<double>(bodies.position_y[body]) - static_cast<double>(bodies.position_y[sensor])};
    const Vec2 way = dt_ * (velocity(body) - velocity(sensor));
    const double squared = length_squared(way);
    const double share = squared > 0 ? std::clamp(dot(apart, way) / squared, 0.0, 1.0) : 0;
    const double reach =
        static_cast<double>(bodies.radius[sensor]) + static_cast<double>(bodies.radius[body]);
    return length_squared(apart - share * way) >= reach * reach;
}

template <class Real>
void SensorFinder<Real>::look(std::size_t sensor, std::size_t body) {
    const Bodies<Real>& bodies = world_.bodies;
    if (sensor == body || (bodies.flags_of(body) & kNotInGrid) || (!moves(sensor) && !moves(body))) return;
    if (is_apart(sensor, body)) return;
    if (world_.has_filters() && !world_.may_collide(sensor, body)) return;
    MovingConvex a = moving(sensor), b = moving(body);
    const SensedPair pair{bodies.id[sensor], bodies.id[body]};
    const double distance = separation_of(at_time(a, 0), at_time(b, 0)).distance;
    if (distance < 0) {
        inside.push_back(pair);
        return;
    }
    const double thickness = std::min(a.shape.inradius, b.shape.inradius),
                 target = kMeetingTarget * thickness;
    const double way = dt_ * (std::sqrt(length_squared(b.velocity - a.velocity)) +
                              std::fabs(a.spin) * a.shape.extent + std::fabs(b.spin) * b.shape.extent);
    if (!(way > kFastThicknesses * thickness)) return;
    // Back from the end, as they came. What is no farther than the target at either end has not passed: it is
    // about to come in, or was in before.
    for (MovingConvex* each : {&a, &b}) each->velocity = -each->velocity, each->spin = -each->spin;
    if (distance > target && separation_of(at_time(a, dt_), at_time(b, dt_)).distance > target &&
        impact_time(a, b, dt_, target).touches)
        passed.push_back(pair);
}

/// A segment or chain is in a sensor if one of its edges is.
template <class Real>
void SensorFinder<Real>::look_at_edges(std::size_t sensor) {
    const Bodies<Real>& bodies = world_.bodies;
    const PlacedConvex placed_sensor = at_time(moving(sensor), 0);
    for (const EdgeBody& edges : world_.edges.bodies) {
        const std::size_t row = world_.handles.row_of_slot(edges.id.index);
        if ((bodies.flags_of(row) & kDisabled) || (!moves(sensor) && !moves(row))) continue;
        const Vec2 at{bodies.position_x[row], bodies.position_y[row]};
        const double near = edges.reach + placed_sensor.shape.extent;
        if (length_squared(at - placed_sensor.centre) >= near * near) continue;
        if (world_.has_filters() && !world_.may_collide(sensor, row)) continue;
        const Rotation turn = rotation_by(bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0);
        for (std::int32_t i = edges.first; i < edges.first + edges.count; ++i) {
            const Edge& edge = world_.edges[i];
            const Vec2 along = edge.b - edge.a;
            const double length = std::sqrt(length_squared(along));
            const Vec2 middle = at + rotate(turn, 0.5 * (edge.a + edge.b));
            const double reach = 0.5 * length + placed_sensor.shape.extent;
            if (length_squared(middle - placed_sensor.centre) >= reach * reach) continue;
            const Vec2 direction = rotate(turn, (1 / length) * along);
            const PlacedConvex line{
                convex_shape_of<double>(Capsule{length, 0}), middle, {direction.x, direction.y}};
            if (!(separation_of(placed_sensor, line).distance < 0)) continue;
            inside.push_back({bodies.id[sensor], edges.id});
            break;
        }
    }
}

/// Sorts out what is news: bodies that came, those that left, those that passed.
template <class Real>
void tell(WorldState<Real>& world, SensorFinder<Real>& found, double time) {
    Sensing& sensing = world.sensing;
    const auto sort = [](std::vector<SensedPair>& pairs) {
        std::sort(pairs.begin(), pairs.end());
        pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    };
    sort(found.inside), sort(found.passed);
    std::vector<std::pair<SensedPair, bool>> news;  // true: it begins
    const auto is_in = [](const std::vector<SensedPair>& pairs, const SensedPair& pair) {
        return std::binary_search(pairs.begin(), pairs.end(), pair);
    };
    for (const SensedPair& pair : found.inside)
        if (!is_in(sensing.inside, pair)) news.emplace_back(pair, true);
    for (const SensedPair& pair : found.passed)
        if (!is_in(sensing.inside, pair) && !is_in(found.inside, pair))
            news.emplace_back(pair, true), news.emplace_back(pair, false);
    for (const SensedPair& pair : sensing.inside)
        if (!is_in(found.inside, pair)) news.emplace_back(pair, false);
    std::stable_sort(news.begin(), news.end(),
                     [](const auto& left, const auto& right) { return left.first < right.first; });
    for (const auto& [pair, begins] : news) {
        SensorEvent event{pair.sensor, pair.body, begins, time, {}};
        if (world.handles.is_alive(pair.body)) {
            const std::size_t row = world.handles.row_of_slot(pair.body.index);
            event.position = {world.bodies.position_x[row], world.bodies.position_y[row]};
        }
        sensing.events.push_back(event);
    }
    std::swap(sensing.inside, found.inside);
}

template <class Real>
void sense(SoftSimulation<Real>& sim) {
    WorldState<Real>& world = sim.world;
    const Bodies<Real>& bodies = world.bodies;
    SensorFinder<Real> found(world, sim.flight_dt);
    Column<std::int32_t> near;
    for (const BodyId id : world.sensing.sensors) {
        const std::size_t row = world.handles.row_of_slot(id.index);
        if ((bodies.flags_of(row) & kDisabled) || !sim.can_meet()) continue;
        const Vec2 place{bodies.position_x[row], bodies.position_y[row]};
        const double reach = static_cast<double>(bodies.radius[row]) + found.way_of(row);
        const std::size_t count = sim.candidates.find_up_to_end(place, reach, near);
        for (std::size_t i = 0; i < count; ++i) found.look(row, static_cast<std::size_t>(near[i]));
        for (const std::int32_t sleeper :
             sim.sleepers.around(world, place, reach, *sim.kernels, sim.executor))
            found.look(row, static_cast<std::size_t>(sleeper));
        if (!world.edges.empty()) found.look_at_edges(row);
    }
    tell(world, found, world.time + sim.flight_dt);
}

template class SensorFinder<float>;
template class SensorFinder<double>;
template void sense(SoftSimulation<float>&);
template void sense(SoftSimulation<double>&);

}  // namespace carom
