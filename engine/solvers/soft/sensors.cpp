#include "solvers/soft/sensors.hpp"

#include <algorithm>
#include <cmath>

#include "narrowphase/disc_edge.hpp"
#include "shapes/convex_geometry.hpp"
#include "solvers/soft/stages.hpp"
#include "state/edge_tracks.hpp"

namespace carom {
namespace {

/// Bodies that come farther in a step, in thicknesses of the thinner one, may have passed.
constexpr double kPassingThicknesses = 0.5;
/// As near as this share of the thickness counts as met on the way.
constexpr double kSensedTarget = 1e-3;

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

/// Calls fn(piece at the end of the step) for all that a body consists of, edges aside, until one is true.
template <class Real>
template <class Fn>
void SensorFinder<Real>::for_each_piece(std::size_t row, const Fn& fn) const {
    const Bodies<Real>& bodies = world_.bodies;
    const Vec2 at{bodies.position_x[row], bodies.position_y[row]};
    const double angle = bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0;
    const auto piece = [&](const ConvexShape<double>& shape) {
        fn(MovingConvex{shape, at, velocity(row), angle, spin(row)});
    };
    if (!bodies.has_shapes)
        return piece(convex_shape_of<double>(Disc{static_cast<double>(bodies.radius[row])}));
    world_.shapes.for_each_piece(bodies.shape[row],
                                 [&](const ConvexShape<Real>& shape, std::int32_t, const StoredPiece*) {
                                     piece(placed(shape, at, {}).shape);
                                 });
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
    const SensedPair pair{bodies.id[sensor], bodies.id[body]};
    bool is_inside = false;
    for_each_piece(sensor, [&](const MovingConvex& a) {
        for_each_piece(body,
                       [&](const MovingConvex& b) { is_inside = is_inside || look_at_pieces(a, b, pair); });
    });
}

/// @return whether they overlap at the end
template <class Real>
bool SensorFinder<Real>::look_at_pieces(const MovingConvex& a, const MovingConvex& b,
                                        const SensedPair& pair) {
    const double distance = separation_of(at_time(a, 0), at_time(b, 0)).distance;
    if (distance < 0) return inside.push_back(pair), true;
    const double thickness = std::min(a.shape.inradius, b.shape.inradius), target = kSensedTarget * thickness;
    const double way = dt_ * (std::sqrt(length_squared(b.velocity - a.velocity)) +
                              std::fabs(a.spin) * a.shape.extent + std::fabs(b.spin) * b.shape.extent);
    if (!(way > kPassingThicknesses * thickness)) return false;
    // Back from the end, as they came. What is no farther than the target at either end has not passed: it is
    // about to come in, or was in before.
    const auto backwards = [](const MovingConvex& forwards) {
        MovingConvex body = forwards;
        body.velocity = -body.velocity, body.spin = -body.spin;
        return body;
    };
    const MovingConvex from_a = backwards(a), from_b = backwards(b);
    if (distance > target && separation_of(at_time(from_a, dt_), at_time(from_b, dt_)).distance > target &&
        impact_time(from_a, from_b, dt_, target).touches)
        passed.push_back(pair);
    return false;
}

/// A segment or chain is in a sensor if one of its edges is.
template <class Real>
void SensorFinder<Real>::look_at_edges(std::size_t sensor) {
    const Bodies<Real>& bodies = world_.bodies;
    const Vec2 place{bodies.position_x[sensor], bodies.position_y[sensor]};
    const double extent = bodies.radius[sensor];
    const auto overlaps = [&](const PlacedConvex& line) {
        bool any = false;
        for_each_piece(sensor, [&](const MovingConvex& piece) {
            any = any || separation_of(at_time(piece, 0), line).distance < 0;
        });
        return any;
    };
    const auto look_at_body = [&](std::int32_t body) {
        const EdgeBody& edges = world_.edges.bodies[static_cast<std::size_t>(body)];
        const std::size_t row = world_.handles.row_of_slot(edges.id.index);
        if ((bodies.flags_of(row) & kDisabled) || (!moves(sensor) && !moves(row))) return;
        const EdgeFrame frame = frame_of(world_, edges, row);
        const Vec2 at = frame.position;
        const double near = edges.reach + extent;
        if (length_squared(at - place) >= near * near) return;
        if (world_.has_filters() && !world_.may_collide(sensor, row)) return;
        const Rotation turn = rotation_by(frame.angle);
        bool is_inside = false;
        const auto look_at = [&](std::int32_t number) {
            if (is_inside) return;
            const Edge& edge = world_.edges[number];
            const Vec2 along = edge.b - edge.a;
            const double length = std::sqrt(length_squared(along));
            const Vec2 middle = at + rotate(turn, 0.5 * (edge.a + edge.b));
            const double reach = 0.5 * length + extent;
            if (length_squared(middle - place) >= reach * reach) return;
            const Vec2 direction = rotate(turn, (1 / length) * along);
            const PlacedConvex line{
                convex_shape_of<double>(Capsule{length, 0}), middle, {direction.x, direction.y}};
            is_inside = overlaps(line);
        };
        world_.edges.for_each_near(edges, rotate_back(turn, place - at), kWiderCircle * extent, look_at);
        if (is_inside) inside.push_back({bodies.id[sensor], edges.id});
    };
    std::vector<std::int32_t> near_bodies;
    world_.edges.for_each_body_near(place, kWiderCircle * extent, near_bodies, look_at_body);
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
