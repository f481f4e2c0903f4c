#include "solvers/soft/impacts/shape_tunnelling.hpp"

#include <algorithm>
#include <cmath>

#include "math/vec2_math.hpp"
#include "narrowphase/disc_edge.hpp"
#include "narrowphase/line_crossing.hpp"
#include "solvers/manifolds/meetings/meeting.hpp"

namespace carom {
namespace {

/// What moves less than this share of its inradius towards what it touches is still held by its contact.
constexpr double kSmallestWayOfShape = 0.5;

/// A body that is put back may get behind something else by that. In the last round it is kept from passing
/// what is static alone: what is squeezed against that stays on its side.
constexpr int kRoundsOfShapeTunnelling = 4;

/// The core of a body, in inradii: where another one is in it, their contact may take the wrong side.
constexpr double kCore = 0.5;

constexpr double kNanosecondsToLookAtShape = 1;  // a body or a contact, on one thread, for the executor

/// A disc that moves straight on for a time of 1.
MovingConvex moving_disc(Vec2 from, Vec2 to, double radius) {
    ConvexShape<double> disc{};
    disc.count = 1, disc.radius = disc.extent = disc.inradius = radius;
    return {disc, from, to - from, 0, 0};
}

/// When a core meets something, as a share of its way; 2 if it does not. What begins the step in it is none
/// that has passed it.
struct CoreImpact {
    double time;
    Vec2 normal;  // into it

    CoreImpact(const MovingConvex& core, const MovingConvex& still) {
        const ConvexImpact impact = impact_time(core, still, 1, kMeetingTarget * core.shape.radius);
        const bool comes_nearer = impact.distance > 0 && dot(core.velocity, impact.normal) > 0;
        time = impact.touches && (impact.time > 0 || comes_nearer) ? impact.time : 2;
        normal = impact.normal;
    }
};

/// Where a body that nothing moves is over the step.
template <class Real>
EdgePose pose_of(const Bodies<Real>& bodies, const StepFlight<Real>& flight, std::size_t row) {
    const bool moves = (bodies.flags_of(row) & kKinematic) != 0;
    const double angle = bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0,
                 turned = moves && bodies.has_rotation
                              ? flight.dt * static_cast<double>(bodies.angular_velocity[row])
                              : 0;
    const Vec2 at{bodies.position_x[row], bodies.position_y[row]};
    return {moves ? flight.start_of(row) : at,
            at,
            rotation_by(angle - turned),
            rotation_by(angle),
            angle - turned,
            angle,
            true,
            static_cast<std::uint32_t>(row)};
}

/// m, sum of the components: at least how far it is.
template <class Real>
Real way_along_axes(const Real* xy) {
    return std::fabs(xy[0]) + std::fabs(xy[1]);
}

}  // namespace

template <class Real>
typename ShapeTunnelling<Real>::Core ShapeTunnelling<Real>::Core::seen_from(const EdgePose& pose) const {
    return {rotate_back(pose.turn, from - pose.position), rotate_back(pose.end_turn, to - pose.end_position),
            radius};
}

template <class Real>
void ShapeTunnelling<Real>::mark(std::size_t row) {
    if (is_swift_[row] != 0) return;
    is_swift_[row] = 1;
    swift_.push_back(static_cast<std::int32_t>(row));
}

/// Lists bodies that came far enough towards something that they touched, and those that came farther than
/// their contacts were looked for: the velocity of the start takes them so far, and what they could not have
/// reached then is an inradius beyond that.
template <class Real>
void ShapeTunnelling<Real>::list_swift(const Inputs& in, const Manifolds<Real>& manifolds,
                                       const Executor& executor) {
    const Bodies<Real>& bodies = in.world.bodies;
    const auto dt = static_cast<Real>(in.flight.dt);
    const auto least = static_cast<Real>(kSmallestWayOfShape);
    const Real* displacement = in.records.displacement.data();
    const Real* motion = in.flight.motion.data();
    swift_.clear(), is_swift_.resize(bodies.rows());
    chosen_.choose(bodies.moving(), kNanosecondsToLookAtShape, executor, [&](std::size_t row) {
        const Real foreseen = dt * way_along_axes(motion + 4 * row + 2);
        return way_along_axes(displacement + 2 * row) > foreseen + bodies.inradius(row);
    });
    chosen_.for_each([&](std::int32_t row) { mark(static_cast<std::size_t>(row)); });
    const auto comes_far = [&](std::size_t row, Real of_other) {
        return way_along_axes(displacement + 2 * row) + of_other > least * bodies.inradius(row);
    };
    // Without bodies that nothing moves only contacts of surfaces are looked at, which come last.
    std::span<const std::int32_t> live = manifolds.live();
    if (in.world.immovable_rows.empty() && bodies.asleep == 0)
        live = live.subspan(static_cast<std::size_t>(
            std::partition_point(live.begin(), live.end(), [](std::int32_t n) { return n >= 0; }) -
            live.begin()));
    const auto is_swift = [&](std::size_t n) {
        const ManifoldList<Real>& list = manifolds.list_of(live[n]);
        const std::size_t i = Manifolds<Real>::place_of(live[n]);
        if (live[n] <
            0)  // an edge has one but where it faces a body; it tells whether the body is pressed into it
            return std::min(list.separation1[i], list.separation2[i]) < -least * list.thickness[i];
        const auto other = static_cast<std::size_t>(list.b[i]);
        if (other < bodies.count && !bodies.is_immovable(other)) return false;
        Real of_other = dt * (std::fabs(bodies.velocity_x[other]) + std::fabs(bodies.velocity_y[other]));
        if (bodies.has_rotation)
            of_other += dt * std::fabs(bodies.angular_velocity[other]) * bodies.radius[other];
        return comes_far(static_cast<std::size_t>(list.a[i]), of_other);
    };
    chosen_.choose(live.size(), kNanosecondsToLookAtShape, executor, is_swift);
    chosen_.for_each([&](std::int32_t n) {
        const std::int32_t contact = live[static_cast<std::size_t>(n)];
        mark(static_cast<std::size_t>(manifolds.list_of(contact).a[Manifolds<Real>::place_of(contact)]));
    });
    const std::span<const EdgePair> pairs = in.flight.edges.pairs();
    for (std::size_t first = 0, last = 0; first < pairs.size(); first = last) {
        const auto row = static_cast<std::size_t>(pairs[first].row);
        while (last < pairs.size() && pairs[last].row == pairs[first].row) ++last;
        if (is_swift_[row] == 0 && comes_upon_edges(in, pairs.subspan(first, last - first))) mark(row);
    }
    for (const std::int32_t row : swift_) is_swift_[static_cast<std::size_t>(row)] = 0;
    std::sort(swift_.begin(), swift_.end());
}

/// Whether one of the edges near a body comes far enough towards it, or is in its core, were it in one piece,
/// at the start of the step. What is pressed into an edge slowly has come no way in any step; discs go on
/// until their centre crosses it (Tunnelling).
/// @param pairs  of one body
template <class Real>
bool ShapeTunnelling<Real>::comes_upon_edges(const Inputs& in, std::span<const EdgePair> pairs) const {
    const Bodies<Real>& bodies = in.world.bodies;
    const auto row = static_cast<std::size_t>(pairs[0].row);
    const Real thickness = bodies.inradius(row);
    const Real least = static_cast<Real>(kSmallestWayOfShape) * thickness,
               come = way_along_axes(in.records.displacement.data() + 2 * row);
    const double core = kCore * static_cast<double>(thickness);
    const bool has_core = !bodies.is_disc(row);
    const EdgePose* seen_from = nullptr;
    Vec2 from;  // m, where the body begins, in the frame of `seen_from`
    for (const EdgePair& pair : pairs) {
        const Edge& edge = in.world.edges[pair.edge];
        const EdgePose& pose = in.flight.edges.pose_of(edge);
        if (&pose != seen_from) {
            seen_from = &pose;
            from = rotate_back(pose.turn, in.flight.start_of(row) - pose.position);
            const Vec2 way = pose.end_position - pose.position;
            const double reach = in.world.edges.bodies[static_cast<std::size_t>(edge.body)].reach;
            const auto of_edge = static_cast<Real>(std::fabs(way.x) + std::fabs(way.y) +
                                                   std::fabs(pose.end_angle - pose.angle) * reach);
            if (come + of_edge > least) return true;
        }
        if (has_core && !is_beyond_box(from, edge, core) &&
            distance_squared(from, edge.a, edge.b) < core * core)
            return true;
    }
    return false;
}

template <class Real>
void ShapeTunnelling<Real>::undo(WorldState<Real>& world, const StepFlight<Real>& flight,
                                 const BodyRecords<Real>& records, const Manifolds<Real>& manifolds,
                                 const Executor& executor) {
    const Inputs in{world, flight, records};
    list_swift(in, manifolds, executor);
    for (const std::int32_t row : swift_) look_at(in, static_cast<std::size_t>(row));
}

template <class Real>
void ShapeTunnelling<Real>::look_at(const Inputs& in, std::size_t row) {
    constexpr std::uint8_t kTakesNoPart = kImmovable | kDisabled | kSensor | kEdges;
    const Bodies<Real>& bodies = in.world.bodies;
    if ((bodies.flags_of(row) & kTakesNoPart) != 0) return;
    Way way{row, in.flight.start_of(row), {bodies.position_x[row], bodies.position_y[row]}, 0, 0};
    if (bodies.has_rotation) {
        way.turned = static_cast<double>(in.records.turn()[row]) / static_cast<double>(bodies.rim(row));
        way.angle = static_cast<double>(bodies.angle[row]) - way.turned;
    }
    for (int round = 0; round < kRoundsOfShapeTunnelling; ++round) {
        const Passed passed = first_passed(in, way, round + 1 == kRoundsOfShapeTunnelling);
        if (passed.time > 1) return;
        put_back(in, way, passed, round > 0);
    }
}

/// What the core of a body, or of a piece of it, met first.
template <class Real>
typename ShapeTunnelling<Real>::Passed ShapeTunnelling<Real>::first_passed(const Inputs& in, const Way& way,
                                                                           bool is_last) {
    const Bodies<Real>& bodies = in.world.bodies;
    Passed first;
    const double half = 0.5 * std::sqrt(length_squared(way.end - way.start));
    const std::size_t found = in.flight.candidates.find_around(way.row, half + bodies.radius[way.row],
                                                               0.5 * (way.start + way.end), near_);
    const Rotation at_start = rotation_by(way.angle), at_end = rotation_by(way.angle + way.turned);
    in.world.shapes.for_each_piece(
        bodies.shape[way.row], [&](const ConvexShape<Real>& shape, std::int32_t, const StoredPiece* piece) {
            const Vec2 centre = piece ? Vec2{piece->x, piece->y} : Vec2{};
            const Core core{way.start + rotate(at_start, centre), way.end + rotate(at_end, centre),
                            kCore * static_cast<double>(shape.inradius)};
            look_at_edges(in, way, core, is_last, first);
            for (std::size_t k = 0; k < found; ++k) {
                const auto other = static_cast<std::size_t>(near_[k]);
                if (is_last && (bodies.flags_of(other) & kKinematic) != 0) continue;
                look_at_body(in, way, core, other, first);
            }
        });
    return first;
}

/// Whether an edge that was in the core comes nearer to its centre. Small steps that each may be taken would
/// lead across.
template <class Real>
bool ShapeTunnelling<Real>::sinks_in(const Core& core, const Edge& edge) {
    const double before = distance_squared(core.from, edge.a, edge.b);
    return before < core.radius * core.radius && distance_squared(core.to, edge.a, edge.b) < before;
}

template <class Real>
void ShapeTunnelling<Real>::look_at_edges(const Inputs& in, const Way& way, const Core& core, bool is_last,
                                          Passed& first) {
    // An impact is found a little before the core is there.
    const double reach =
        (1 + 2 * kMeetingTarget) * core.radius + 0.5 * std::sqrt(length_squared(core.to - core.from));
    const auto look_at = [&](std::int32_t edges) {
        const EdgeBody& body = in.world.edges.bodies[static_cast<std::size_t>(edges)];
        const EdgePose& pose = in.flight.edges.pose_of(in.world.edges[body.first]);
        if (!pose.takes_part || (in.world.has_filters() && !in.world.may_collide(way.row, pose.row))) return;
        if (is_last && (in.world.bodies.flags_of(pose.row) & kKinematic) != 0) return;
        const Core seen = core.seen_from(pose);
        const MovingConvex moving = moving_disc(seen.from, seen.to, seen.radius);
        const double half = 0.5 * std::sqrt(length_squared(moving.velocity));
        in.world.edges.for_each_near(
            body, 0.5 * (seen.from + seen.to), kWiderCircle * (half + seen.radius), [&](std::int32_t number) {
                const Edge& edge = in.world.edges[number];
                const double wider = kWiderCircle * (half + (1 + 2 * kMeetingTarget) * seen.radius);
                if (distance_squared(0.5 * (seen.from + seen.to), edge.a, edge.b) > wider * wider) return;
                MovingConvex still = still_edge(edge);
                const double time = sinks_in(seen, edge)
                                        ? 0
                                        : std::min(time_of_crossing(seen.from, seen.to, edge.a, edge.b),
                                                   CoreImpact(moving, still).time);
                if (!(time < first.time)) return;
                const Vec2 along = edge.b - edge.a;
                const double length = std::sqrt(length_squared(along)),
                             side = cross(along, seen.from - edge.a) > 0 ? 1 / length : -1 / length;
                for (int i = 0; i < kMostVertices; ++i)
                    still.shape.x[i] += still.centre.x, still.shape.y[i] += still.centre.y;
                first = {time, pose, seen.from + time * moving.velocity, side * Vec2{along.y, -along.x},
                         still.shape};
            });
    };
    in.world.edges.for_each_body_near(0.5 * (core.from + core.to), kWiderCircle * reach, near_bodies_,
                                      look_at);
}

template <class Real>
void ShapeTunnelling<Real>::look_at_body(const Inputs& in, const Way& way, const Core& core,
                                         std::size_t other, Passed& first) const {
    constexpr std::uint8_t kTakesNoPart = kDisabled | kSensor | kEdges;
    const Bodies<Real>& bodies = in.world.bodies;
    const std::uint8_t flags = bodies.flags_of(other);
    if ((flags & kImmovable) == 0 || (flags & kTakesNoPart) != 0) return;
    if (in.world.has_filters() && !in.world.may_collide(way.row, other)) return;
    const EdgePose pose = pose_of(bodies, in.flight, other);
    const Core seen = core.seen_from(pose);
    const MovingConvex moving = moving_disc(seen.from, seen.to, seen.radius);
    const double reach = static_cast<double>(bodies.radius[other]) + seen.radius +
                         0.5 * std::sqrt(length_squared(moving.velocity));
    if (length_squared(0.5 * (seen.from + seen.to)) > reach * reach) return;
    in.world.shapes.for_each_piece(bodies.shape[other], [&](const ConvexShape<Real>& shape, std::int32_t,
                                                            const StoredPiece*) {
        const MovingConvex still{placed(shape, {}, {}).shape, {}, {}, 0, 0};
        const ConvexImpact impact = impact_time(moving, still, 1, kMeetingTarget * seen.radius);
        // What begins the step in it is none that has passed it.
        if (!impact.touches || !(impact.time > 0) || !(impact.time < first.time)) return;
        first = {impact.time, pose, seen.from + impact.time * moving.velocity, impact.normal, still.shape};
    });
}

/// To where it met what it passed, as seen from there, and on along its surface, without its velocity into
/// it: what joints draw over something round in each step must not be held there. In a corner that may be
/// behind something else: then to where it was before the step, beside the same thing.
template <class Real>
void ShapeTunnelling<Real>::put_back(const Inputs& in, Way& way, const Passed& passed, bool to_start) {
    Bodies<Real>& bodies = in.world.bodies;
    const EdgePose& pose = passed.pose;
    const Core line = Core{way.start, way.end, 0}.seen_from(pose);
    const double turned = pose.end_angle - pose.angle;
    MovingConvex moving{{}, line.from, line.to - line.from, way.angle - pose.angle, way.turned - turned};
    const MovingConvex still{passed.obstacle, {}, {}, 0, 0};
    const double thickness = bodies.inradius(way.row);
    double time = passed.time;
    in.world.shapes.for_each_piece(
        bodies.shape[way.row], [&](const ConvexShape<Real>& shape, std::int32_t, const StoredPiece*) {
            moving.shape = placed(shape, {}, {}).shape;
            const ConvexImpact impact = impact_time(moving, still, 1, kMeetingTarget * thickness);
            if (impact.touches) time = std::min(time, impact.time);
        });
    if (to_start) time = 0;
    Vec2 left = to_start ? Vec2{} : (1 - time) * moving.velocity;
    left -= std::fmax(dot(left, passed.normal), 0.0) * passed.normal;
    const Vec2 x = pose.end_position + rotate(pose.end_turn, moving.centre + time * moving.velocity + left);
    bodies.position_x[way.row] = static_cast<Real>(x.x), bodies.position_y[way.row] = static_cast<Real>(x.y);
    way.end = {bodies.position_x[way.row], bodies.position_y[way.row]};
    if (bodies.has_rotation) {
        way.turned = turned + time * moving.spin;
        bodies.angle[way.row] = static_cast<Real>(way.angle + way.turned);
    }
    stop(in, way, passed);
}

/// Takes the velocity of a body into what it has passed.
template <class Real>
void ShapeTunnelling<Real>::stop(const Inputs& in, const Way& way, const Passed& passed) {
    Bodies<Real>& bodies = in.world.bodies;
    const EdgePose& pose = passed.pose;
    const Vec2 v{bodies.velocity_x[way.row], bodies.velocity_y[way.row]};
    const Vec2 arm = rotate(pose.end_turn, passed.point), normal = rotate(pose.end_turn, passed.normal);
    const double spin = (pose.end_angle - pose.angle) / in.flight.dt;
    const Vec2 surface =
        (1 / in.flight.dt) * (pose.end_position - pose.position) + spin * Vec2{-arm.y, arm.x};
    const double into = dot(v - surface, normal);
    if (!(into > 0)) return;
    const Vec2 held = v - into * normal;
    bodies.velocity_x[way.row] = static_cast<Real>(held.x);
    bodies.velocity_y[way.row] = static_cast<Real>(held.y);
    if (!in.world.books.is_open) return;
    const double mass = bodies.mass[way.row];
    const Vec2 now{bodies.velocity_x[way.row], bodies.velocity_y[way.row]};
    const double drive = mass * dot(now - v, surface);
    in.world.books.drive += drive;
    in.world.books.restitution += 0.5 * mass * (length_squared(now) - length_squared(v)) - drive;
    in.world.books.immovable_momentum += mass * (now - v);
}

template class ShapeTunnelling<float>;
template class ShapeTunnelling<double>;

}  // namespace carom
