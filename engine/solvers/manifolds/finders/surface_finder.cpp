#include "solvers/manifolds/finders/surface_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraints/partner.hpp"
#include "effects/friction.hpp"
#include "effects/restitution.hpp"
#include "kernels/manifolds/manifold_arguments.hpp"
#include "math/rotation.hpp"
#include "narrowphase/convex.hpp"
#include "narrowphase/disc_edge.hpp"
#include "shapes/walls.hpp"
#include "solvers/manifolds/meetings/meeting.hpp"

namespace carom {
namespace {

constexpr double kNanosecondsToLookForWalls = 1;  // a row, on one thread, for the executor
/// Share by which a reach may be off through rounding.
constexpr double kRoundingOfReach = 1e-6;

/// How far a body can come in a step [m].
template <class Real>
double reach_in_step(const Bodies<Real>& bodies, std::size_t row, double dt) {
    const double turns = bodies.has_rotation ? std::fabs(bodies.angular_velocity[row]) : 0;
    return dt * (std::fabs(bodies.velocity_x[row]) + std::fabs(bodies.velocity_y[row]) +
                 turns * static_cast<double>(bodies.radius[row]));
}

/// A body, or a piece of it, in the world.
template <class Real>
PlacedConvex placed_row(const WorldState<Real>& world, std::size_t row, const ConvexShape<Real>& shape) {
    const Bodies<Real>& bodies = world.bodies;
    return placed(shape, {bodies.position_x[row], bodies.position_y[row]},
                  rotation_by(bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0));
}

/// A piece around its own centroid, which edges ask for: they have to know on which side of them it is.
PlacedConvex around_own_centre(const PlacedConvex& placed, Vec2 offset) {
    PlacedConvex piece = placed;
    for (int i = 0; i < kMostVertices; ++i) piece.shape.x[i] -= offset.x, piece.shape.y[i] -= offset.y;
    piece.centre += rotate(piece.turn, offset);
    return piece;
}

/// The manifold of a piece with its levers about the centre of mass of its body.
/// @param lever  m, from there to the centroid of the piece
Manifold<double> about_body(Manifold<double> m, Vec2 lever) {
    const Vec2 n{m.normal_x, m.normal_y};
    const double across = cross(lever, n);
    m.lever_a1 += across, m.lever_a2 += across, m.lever_a_t += dot(lever, n);
    return m;
}

/// A manifold of a frame that is turned, and whose origin is the body b's.
Manifold<double> turned(Manifold<double> m, const Rotation& turn) {
    const Vec2 n = rotate(turn, {m.normal_x, m.normal_y});
    m.normal_x = n.x, m.normal_y = n.y;
    return m;
}

/// An edge, made longer at ends where its chain goes straight on or bends towards a body: there it has no end
/// that the body could pass.
/// @param centre  m, of the body, in the frame of the chain  @param extent  m, of its shape
Edge with_what_goes_on(std::span<const Edge> edges, std::int32_t number, Vec2 centre, double extent) {
    Edge edge = edges[static_cast<std::size_t>(number)];
    const Vec2 along = edge.b - edge.a;
    const double length = std::sqrt(length_squared(along)), side = cross(along, centre - edge.a) < 0 ? -1 : 1;
    const auto goes_on = [&](std::int32_t neighbour, double sign) {
        if (neighbour < 0) return false;
        const Edge& other = edges[static_cast<std::size_t>(neighbour)];
        const Vec2 way = other.b - other.a;
        const double of_both = length * std::sqrt(length_squared(way));
        return dot(along, way) >= kParallel * of_both || sign * side * cross(along, way) > 0;
    };
    const Vec2 longer = (2 * extent / length) * along;
    const bool goes_on_before = goes_on(edge.previous, -1), goes_on_after = goes_on(edge.next, 1);
    if (goes_on_before) edge.a -= longer;
    if (goes_on_after) edge.b += longer;
    return edge;
}

}  // namespace

template <class Real>
void SurfaceFinder<Real>::take_over(const WorldState<Real>& world, std::span<const EdgePair> pairs) {
    const Bodies<Real>& bodies = world.bodies;
    const auto before = static_cast<std::ptrdiff_t>(pairs_.size());
    for (const EdgePair& pair : pairs) {
        const auto row = static_cast<std::size_t>(pair.row);
        if (!bodies.is_disc(row) && bodies.shape[row] >= 0 && !bodies.is_immovable(row))
            pairs_.push_back({pair.row, world.edges.track_of(pair.edge), pair.edge});
    }
    // They come by row and edge, which is in order of tracks, too, where the edges of each were added
    // together.
    const auto added = pairs_.begin() + before;
    if (!std::is_sorted(added, pairs_.end())) std::sort(added, pairs_.end());
    std::inplace_merge(pairs_.begin(), added, pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
}

template <class Real>
void SurfaceFinder<Real>::renew(const WorldState<Real>& world, const EdgeCandidates<Real>& edges) {
    clear();
    if (world.bodies.has_shapes) take_over(world, edges.pairs());
}

template <class Real>
void SurfaceFinder<Real>::add(const WorldState<Real>& world, const EdgeCandidates<Real>& edges) {
    if (world.bodies.has_shapes && !edges.new_pairs().empty()) take_over(world, edges.new_pairs());
}

template <class Real>
void SurfaceFinder<Real>::find(const Inputs& in, ManifoldList<Real>& list, const Executor& executor) {
    const WorldState<Real>& world = in.world;
    list.clear(), manifolds_.clear(), pieces_.clear();
    carried_from_.clear(), some_are_carried_ = false, keep_numbers_ = true;
    if (world.walls) list_near_walls(in, executor), find_walls(in, list);
    carried_from_.resize(list.count(), -1);
    find_edges(in, list);
    list.fit();
    const Bodies<Real>& bodies = world.bodies;
    const auto real = [](double value) { return static_cast<Real>(value); };
    for (std::size_t i = 0; i < list.count(); ++i) {
        list.set_manifold(i, manifolds_[i]);
        const auto row = static_cast<std::size_t>(list.a[i]);
        const StoredPiece* piece = pieces_[i];
        list.thickness[i] = piece ? world.shapes[piece->number].inradius : bodies.inradius(row);
        const Partner support(list.b[i]);
        double friction = 0, restitution = 0;
        if (support.is_wall()) {
            friction = world.walls->material.friction, restitution = world.walls->material.restitution;
        } else {
            const std::size_t other = in.edges.pose_of(world.edges[support.edge_number()]).row;
            friction = bodies.friction[other], restitution = bodies.restitution[other];
        }
        const double own_friction = piece ? piece->material.friction : double{bodies.friction[row]},
                     own_restitution = piece ? piece->material.restitution : double{bodies.restitution[row]};
        list.friction[i] = real(pair_friction(own_friction, friction));
        list.restitution[i] = real(pair_restitution(own_restitution, restitution));
    }
}

/// Rows that may come near a wall in the step, by a bound that is cheaper than what `find_walls` asks: a body
/// is no thicker than its radius.
template <class Real>
void SurfaceFinder<Real>::list_near_walls(const Inputs& in, const Executor& executor) {
    const Bodies<Real>& bodies = in.world.bodies;
    const Enclosure<double> enclosure(&*in.world.walls);
    const double radii = 2 + in.near.share, fall = in.near.fall;
    rows_near_walls_.choose(bodies.moving(), kNanosecondsToLookForWalls, executor, [&](std::size_t row) {
        const double most =
            radii * static_cast<double>(bodies.radius[row]) + fall + static_cast<double>(in.poses.way(row));
        return enclosure.clearance(bodies.position_x[row], bodies.position_y[row]) <
               (1 + kRoundingOfReach) * most;
    });
}

/// A wall is a wall everywhere: it is kept one thickness farther than others, as a crowd may yet throw a body
/// there within the step.
template <class Real>
void SurfaceFinder<Real>::find_walls(const Inputs& in, ManifoldList<Real>& list) {
    const WorldState<Real>& world = in.world;
    const Bodies<Real>& bodies = world.bodies;
    const Walls& walls = *world.walls;
    const Enclosure<double> enclosure(&walls);
    const auto look_at = [&](std::size_t row) {
        if (bodies.is_disc(row) || bodies.shape[row] < 0 || bodies.is_immovable(row)) return;
        if (bodies.flags_of(row) & kSensor) return;
        const double way = reach_in_step(bodies, row, in.terms.dt), thickness = bodies.inradius(row);
        const double reach = static_cast<double>(bodies.radius[row]) + in.near(thickness) + thickness + way;
        const auto find_wall = [&](std::int32_t side) {
            world.shapes.for_each_piece(
                bodies.shape[row],
                [&](const ConvexShape<Real>& shape, std::int32_t number, const StoredPiece* piece) {
                    const double thick = shape.inradius, margin = in.near(thick) + thick + way;
                    const std::int32_t shape_number = piece ? piece->number : bodies.shape[row];
                    const MovingConvex moving =
                        moving_row(world, row, in.flights.velocity(bodies, row), shape_number);
                    Manifold<double> m = manifold_on_plane(at_time(moving, in.ahead[row]), wall_normal(side),
                                                           wall_corner(walls, side));
                    move_back(m, relative_motion(moving, {}), in.ahead[row]);
                    if (m.separation1 > margin && m.separation2 > margin) return;
                    list.add(static_cast<std::int32_t>(row), Partner::wall(side).stored(),
                             {bodies.id[row], BodyId{}, ManifoldName::place_of_side(side, number)});
                    manifolds_.push_back(m), pieces_.push_back(piece);
                });
        };
        enclosure.for_each_side_within(bodies.position_x[row], bodies.position_y[row], reach, find_wall);
    };
    rows_near_walls_.for_each([&](std::int32_t row) { look_at(static_cast<std::size_t>(row)); });
}

template <class Real>
void SurfaceFinder<Real>::find_edges(const Inputs& in, ManifoldList<Real>& list) {
    const WorldState<Real>& world = in.world;
    groups_before_.swap(groups_), groups_.clear();
    auto before = groups_before_.begin();
    for (std::size_t first = 0, last = 0; first < pairs_.size(); first = last) {
        while (last < pairs_.size() && pairs_[last].row == pairs_[first].row &&
               pairs_[last].track == pairs_[first].track)
            ++last;
        const auto row = static_cast<std::size_t>(pairs_[first].row);
        const auto begin = static_cast<std::int32_t>(list.count());
        Group group{pairs_[first].row, pairs_[first].track, begin, 0};
        const EdgePose& pose = in.edges.pose_of(world.edges[pairs_[first].edge]);
        while (before != groups_before_.end() && before->is_before(group)) ++before;
        if (before != groups_before_.end() && before->is_same_pair(group) && may_carry(in, pose, row)) {
            carry(in, *before, list);
        } else if (pose.takes_part) {
            find_on_edges(in, pose, std::span(pairs_).subspan(first, last - first), list);
        }
        group.contacts = static_cast<std::int32_t>(list.count()) - begin;
        groups_.push_back(group);
    }
}

/// Whether a body touches edges as it did in the step before: neither it nor they have moved. A compound
/// would have to be watched by its thinnest piece.
template <class Real>
bool SurfaceFinder<Real>::may_carry(const Inputs& in, const EdgePose& pose, std::size_t row) const {
    return in.world.bodies.stands(pose.row) && pose.takes_part &&
           !in.poses.has_moved(static_cast<std::int32_t>(row)) &&
           !in.world.shapes.is_compound(in.world.bodies.shape[row]);
}

/// Takes the contacts of a body over from the step before.
template <class Real>
void SurfaceFinder<Real>::carry(const Inputs& in, const Group& group, ManifoldList<Real>& list) {
    for (std::int32_t i = group.first_contact; i < group.first_contact + group.contacts; ++i) {
        const auto from = static_cast<std::size_t>(i);
        some_are_carried_ = true, keep_numbers_ = keep_numbers_ && from == list.count();
        list.add(group.row, in.before.b[from], in.before.names[from]);
        list.memory.back() = in.before.memory[from];
        manifolds_.push_back(in.before.manifold(from)), pieces_.push_back(nullptr);
        carried_from_.push_back(i);
    }
}

/// Finds where a body touches its near edges.
/// @param pairs  of one body and one chain or track
template <class Real>
void SurfaceFinder<Real>::find_on_edges(const Inputs& in, const EdgePose& pose, std::span<const Near> pairs,
                                        ManifoldList<Real>& list) {
    const auto row = static_cast<std::size_t>(pairs[0].row);
    near_edges_.clear();
    list_near_edges(in, pose, row, pairs);
    if (near_edges_.empty()) return;
    in.world.shapes.for_each_piece(
        in.world.bodies.shape[row],
        [&](const ConvexShape<Real>& shape, std::int32_t number, const StoredPiece* piece) {
            find_on_chain(in, pose, row, shape, number, piece, list);
        });
    carried_from_.resize(list.count(), -1);
}

/// Lists edges but those that a body cannot meet in the step, by a bound that is cheaper than to place its
/// shape: fast bodies have margins of several steps, most edges within which are beyond the way of one.
template <class Real>
void SurfaceFinder<Real>::list_near_edges(const Inputs& in, const EdgePose& pose, std::size_t row,
                                          std::span<const Near> pairs) {
    // What is far from the axis of something that turns is fast.
    double most = std::numeric_limits<double>::infinity();
    const Bodies<Real>& bodies = in.world.bodies;
    if (!pose.turns()) {
        const auto radius = static_cast<double>(bodies.radius[row]);
        const double come = reach_in_step(bodies, row, in.terms.dt) +
                            std::sqrt(length_squared(pose.end_position - pose.position));
        // To where it is by the end of its way, and from there as far as a contact is looked for, which is
        // that way and the distance of contacts at rest. No piece is thicker than the radius of its body.
        most = (1 + kRoundingOfReach) * ((1 + kMeetingTarget) * radius + in.near(radius) + 2 * come);
    }
    const Vec2 centre =
        rotate_back(pose.turn, Vec2{bodies.position_x[row], bodies.position_y[row]} - pose.position);
    for (const Near& pair : pairs)
        if (!is_beyond_box(centre, in.world.edges[pair.edge], most)) near_edges_.push_back(pair.edge);
}

/// Finds where a body, or a piece of it, touches the near edges, which are of one chain or track.
template <class Real>
void SurfaceFinder<Real>::find_on_chain(const Inputs& in, const EdgePose& pose, std::size_t row,
                                        const ConvexShape<Real>& shape, std::int32_t number,
                                        const StoredPiece* piece, ManifoldList<Real>& list) {
    const WorldState<Real>& world = in.world;
    const Bodies<Real>& bodies = world.bodies;
    const double thickness = shape.inradius, dt = in.terms.dt;
    const double margin = in.near(thickness) + reach_in_step(bodies, row, dt) +
                          std::sqrt(length_squared(pose.end_position - pose.position)) +
                          std::fabs(pose.end_angle - pose.angle) * world.edges.body_of(near_edges_[0]).reach;
    PlacedConvex body = placed_row(world, row, shape);
    const Vec2 centre = body.centre;
    const double angle_in_chain =
        (bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0) - pose.angle;
    // In the frame of the chain.
    body.centre = rotate_back(pose.turn, body.centre - pose.position);
    body.turn = {body.turn.cos * pose.turn.cos + body.turn.sin * pose.turn.sin,
                 body.turn.sin * pose.turn.cos - body.turn.cos * pose.turn.sin};
    const Vec2 flight = in.flights.velocity(bodies, row);
    const Vec2 velocity =
        (1 / dt) * (rotate_back(pose.end_turn, centre + dt * flight - pose.end_position) - body.centre);
    const double spin = (bodies.has_rotation ? static_cast<double>(bodies.angular_velocity[row]) : 0) -
                        (pose.end_angle - pose.angle) / dt;
    const Vec2 centre_now = body.centre;
    const auto moving = [&] { return MovingConvex{body.shape, centre_now, velocity, angle_in_chain, spin}; };
    // Only what is so fast can meet an edge later than at once.
    const double way = dt * (std::sqrt(length_squared(velocity)) + std::fabs(spin) * body.shape.extent);
    const double met =
        way > kFastThicknesses * thickness ? time_of_meeting_edges(world, moving(), way, dt, thickness) : 0;
    // What an edge that turns does in the step is in turning_edges.hpp.
    const double time = met > 0 ? met : pose.turns() ? 0 : in.ahead[row];
    if (time > 0)
        body.centre = centre_now + time * velocity, body.turn = rotation_by(angle_in_chain + time * spin);
    found_.clear();
    const Vec2 offset = piece ? Vec2{piece->x, piece->y} : Vec2{};
    const RelativeMotion motion{Vec2{} - velocity, spin, 0};
    if (piece)
        find_chain_manifolds(around_own_centre(body, offset), world.edges.edges, near_edges_, margin, found_);
    else
        find_chain_manifolds(body, world.edges.edges, near_edges_, margin, found_);
    for (ChainManifold& found : found_) {
        if (piece) found.manifold = about_body(found.manifold, rotate(body.turn, offset));
        if (time > 0) move_back(found.manifold, motion, time);
        if (pass_plane(found.manifold, motion, dt, thickness)) {
            const Edge edge = with_what_goes_on(world.edges.edges, found.edge, centre_now, body.shape.extent);
            if (pass_each_other(moving(), still_edge(edge), found.manifold, dt, thickness)) continue;
        }
        const std::int32_t track = world.edges.track_of(found.edge);
        list.add(static_cast<std::int32_t>(row), Partner::edge(found.edge).stored(),
                 {bodies.id[row], world.edges.bodies[static_cast<std::size_t>(track)].id,
                  ManifoldName::place_of_side(0, number)});
        manifolds_.push_back(turned(found.manifold, pose.turn)), pieces_.push_back(piece);
    }
}

/// The time at which a body that flies or turns farther in a step than it is thick meets the first of its
/// near edges [s]; 0 if it does not.
/// @param body  in the frame of the chain  @param way  m, of its points in the step
template <class Real>
double SurfaceFinder<Real>::time_of_meeting_edges(const WorldState<Real>& world, const MovingConvex& body,
                                                  double way, double dt, double thickness) const {
    const double target = kMeetingTarget * thickness,
                 reach = kWiderCircle * (body.shape.extent + way + target);
    double first = 0;
    for (const std::int32_t number : near_edges_) {
        const Edge& edge = world.edges[number];
        if (distance_squared(body.centre, edge.a, edge.b) > reach * reach) continue;
        const ConvexImpact impact = impact_time(body, still_edge(edge), dt, target);
        if (!impact.touches) continue;
        if (!(impact.time > 0)) return 0;  // it touches already
        if (first == 0 || impact.time < first) first = impact.time;
    }
    return first;
}

template <class Real>
std::size_t SurfaceFinder<Real>::bytes() const {
    return rows_near_walls_.bytes() + pairs_.capacity() * sizeof(Near) +
           (near_edges_.capacity() + carried_from_.capacity()) * sizeof(std::int32_t) +
           found_.capacity() * sizeof(ChainManifold) + manifolds_.capacity() * sizeof(Manifold<double>) +
           (groups_.capacity() + groups_before_.capacity()) * sizeof(Group);
}

template class SurfaceFinder<float>;
template class SurfaceFinder<double>;

}  // namespace carom
