#include "solvers/soft/impacts/tunnelling.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "math/vec2_math.hpp"
#include "narrowphase/disc_edge.hpp"
#include "narrowphase/line_crossing.hpp"

namespace carom {
namespace {

/// A disc that moves less than this share of its radius in a step in which its centre gets past an edge was
/// pressed into it: it goes back to where it was.
constexpr double kSmallestWayOfDisc = 0.5;

/// A disc is looked at by itself if the fastest body moves more than this share of the disc's radius.
constexpr double kFastWay = 0.25;

constexpr double kNanosecondsToLookAtDisc = 3;  // on one thread, for the executor

/// A disc that is put back may get behind another edge by that. In the last round what moves by itself is
/// left out: what a kinematic edge presses against a static one stays on its side of that.
constexpr int kRoundsOfTunnelling = 4;

}  // namespace

template <class Real>
void Tunnelling<Real>::note_crossing(const WorldState<Real>& world, const StepFlight<Real>& flight,
                                     std::int32_t disc, std::int32_t number) {
    const auto row = static_cast<std::size_t>(disc);
    const Edge& edge = world.edges[number];
    const EdgePose& pose = flight.edges.pose_of(edge);
    if (is_last_ && (world.bodies.flags_of(pose.row) & kKinematic) != 0) return;
    const Vec2 x{world.bodies.position_x[row], world.bodies.position_y[row]};
    const Vec2 from = rotate_back(pose.turn, flight.start_of(row) - pose.position);
    const Vec2 to = rotate_back(pose.end_turn, x - pose.end_position);
    const double time = time_of_crossing(from, to, edge.a, edge.b);
    if (time <= 1) crossings_.push_back({disc, number, time, from, from + time * (to - from)});
}

/// The edges that a disc crossed, whether they are among its supports or not.
template <class Real>
void Tunnelling<Real>::note_crossings(const WorldState<Real>& world, const StepFlight<Real>& flight,
                                      std::int32_t disc) {
    const auto row = static_cast<std::size_t>(disc);
    const Vec2 x{world.bodies.position_x[row], world.bodies.position_y[row]};
    const Vec2 start = flight.start_of(row);
    const double half_way = 0.5 * std::sqrt(length_squared(x - start));
    world.edges.for_each_body_near(
        0.5 * (start + x), kWiderCircle * half_way, near_bodies_, [&](std::int32_t number) {
            const EdgeBody& body = world.edges.bodies[static_cast<std::size_t>(number)];
            const EdgePose& pose = flight.edges.pose_of(world.edges[body.first]);
            const Vec2 from = rotate_back(pose.turn, start - pose.position);
            const Vec2 to = rotate_back(pose.end_turn, x - pose.end_position);
            const double half = 0.5 * std::sqrt(length_squared(to - from));
            world.edges.for_each_near(body, 0.5 * (from + to), kWiderCircle * half,
                                      [&](std::int32_t edge) { note_crossing(world, flight, disc, edge); });
        });
}

/// Lists which disc crossed which edge, the first edge first.
template <class Real>
void Tunnelling<Real>::find_crossings(const WorldState<Real>& world, const StepFlight<Real>& flight,
                                      const ContactRows<Real>& supports) {
    crossings_.clear();
    supports.for_each([&](std::size_t i) {
        if (const Partner support = supports.partner(i); support.is_edge())
            note_crossing(world, flight, supports.a[i], support.edge_number());
    });
    strays_.for_each_below(world.bodies.moving(),
                           [&](std::int32_t row) { note_crossings(world, flight, row); });
    std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& left, const Crossing& right) {
        return std::tie(left.row, left.time, left.edge) < std::tie(right.row, right.time, right.edge);
    });
}

/// Lists discs that have left their margins: edges beyond these are none of their supports.
template <class Real>
void Tunnelling<Real>::find_strays(const WorldState<Real>& world, const StepFlight<Real>& flight,
                                   const Executor& executor) {
    const Candidates<Real>& candidates = flight.candidates;
    const Bodies<Real>& bodies = world.bodies;
    strays_.prepare(0, kRowsPerChunk);
    // No disc is made faster than the fastest by much, and only a fast one can pass.
    const double largest = flight.fastest * flight.dt / kFastWay;  // m, of discs that are fast
    if (!(largest > candidates.smallest_radius())) return;
    const auto is_stray = [&](std::size_t row) {
        const double radius = bodies.radius[row];
        if (radius >= largest) return false;
        const Vec2 way = Vec2{bodies.position_x[row], bodies.position_y[row]} -
                         Vec2{candidates.built_x()[row], candidates.built_y()[row]};
        const double margin = static_cast<double>(candidates.reach()[row]) - radius;
        const double squared = length_squared(way);
        if (squared <= margin * margin || !bodies.is_moving_disc(row)) return false;
        // Edges somewhat beyond its margin are among the supports, too.
        return std::sqrt(squared) - margin + candidates.farther_than_first(row) > flight.edges.allowance();
    };
    strays_.prepare(bodies.moving(), kRowsPerChunk);
    executor.for_each_chunk(bodies.moving(), kRowsPerChunk, kNanosecondsToLookAtDisc,
                            [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                std::size_t count = 0;
                                for (std::size_t row = first; row < last; ++row)
                                    if (is_stray(row))
                                        strays_.part(chunk)[count++] = static_cast<std::int32_t>(row);
                                strays_.set_count(chunk, count);
                            });
}

template <class Real>
void Tunnelling<Real>::undo(WorldState<Real>& world, const StepFlight<Real>& flight,
                            const ContactRows<Real>& supports, const Executor& executor) {
    find_strays(world, flight, executor);
    for (int round = 0; round < kRoundsOfTunnelling; ++round) {
        is_last_ = round + 1 == kRoundsOfTunnelling;
        find_crossings(world, flight, supports);
        if (crossings_.empty()) return;
        std::int32_t done = -1;
        for (const Crossing& passed : crossings_) {
            if (passed.row == done) continue;  // the edge it crossed first
            done = passed.row;
            put_back(world, flight, passed, round > 0);
        }
    }
}

/// To where it crossed the edge, on the side it came from, without its velocity into the edge. In a sharp
/// corner that can be behind the other edge: then to where it was before the step, beside the same edge, and
/// so where it is slow.
template <class Real>
void Tunnelling<Real>::put_back(WorldState<Real>& world, const StepFlight<Real>& flight,
                                const Crossing& passed, bool to_start) {
    Bodies<Real>& bodies = world.bodies;
    const auto row = static_cast<std::size_t>(passed.row);
    const Edge& edge = world.edges[passed.edge];
    const EdgePose& pose = flight.edges.pose_of(edge);
    const Vec2 along = edge.b - edge.a;
    const double length = std::sqrt(length_squared(along));
    const double side = cross(along, passed.from - edge.a) > 0 ? 1 / length : -1 / length;
    const Vec2 out = side * Vec2{-along.y, along.x};
    const double radius = bodies.radius[row], least = kSmallestWayOfDisc * radius * passed.time;
    const bool is_slow = length_squared(passed.point - passed.from) < least * least;
    const Vec2 place = to_start || is_slow ? passed.from : passed.point + radius * out;
    const Vec2 x = pose.end_position + rotate(pose.end_turn, place);
    const Vec2 n = rotate(pose.end_turn, out);
    const double spin = (pose.end_angle - pose.angle) / flight.dt;
    const Vec2 arm = rotate(pose.end_turn, passed.point);
    const Vec2 surface = (1 / flight.dt) * (pose.end_position - pose.position) + spin * Vec2{-arm.y, arm.x};
    const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]};
    const double leaving = dot(v - surface, n);
    Vec2 held = leaving < 0 ? v - leaving * n : v;
    // What stays where it was has fallen nowhere, and is no faster than it was: in a gap that is too narrow
    // for it a disc is put back in every step.
    if (to_start || is_slow) {
        const double most = length_squared(flight.start_velocity_of(row) - surface),
                     speed = length_squared(held - surface);
        if (speed > most) held = surface + std::sqrt(most / speed) * (held - surface);
    }
    bodies.position_x[row] = static_cast<Real>(x.x), bodies.position_y[row] = static_cast<Real>(x.y);
    bodies.velocity_x[row] = static_cast<Real>(held.x), bodies.velocity_y[row] = static_cast<Real>(held.y);
    if (!world.books.is_open) return;
    const double mass = bodies.mass[row];
    const Vec2 now{bodies.velocity_x[row], bodies.velocity_y[row]};
    const double drive = mass * dot(now - v, surface);
    world.books.drive += drive;
    world.books.restitution += 0.5 * mass * (length_squared(now) - length_squared(v)) - drive;
    world.books.immovable_momentum += mass * (now - v);
}

template class Tunnelling<float>;
template class Tunnelling<double>;

}  // namespace carom
