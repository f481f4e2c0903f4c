#include "world/measure.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "broadphase/edge_candidates.hpp"
#include "math/rotation.hpp"
#include "math/vec2_math.hpp"
#include "narrowphase/disc_edge.hpp"
#include "shapes/convex_geometry.hpp"
#include "shapes/walls.hpp"
#include "state/edge_tracks.hpp"
#include "world/shape_separations.hpp"

namespace carom {
namespace {

struct Overlaps {
    OverlapReport report;
    double sum = 0;

    void add(double separation, double radius) {
        if (!(separation < 0)) return;
        ++report.touching;
        sum -= separation / radius;
        report.max = std::fmax(report.max, -separation / radius);
    }

    /// Walls are no pairs; a wall that is touched counts as a candidate, so that no more touch than there
    /// are.
    void add_wall(double separation, double radius) {
        if (separation < 0) ++report.candidates;
        add(separation, radius);
    }
};

template <class Real>
Rotation turn_of(const Bodies<Real>& bodies, std::size_t row) {
    if (!bodies.has_rotation || bodies.is_disc(row)) return {};
    return rotation_by(bodies.angle[row]);
}

/// How far a body reaches in a direction [m].
template <class Real>
double reach_along(const WorldState<Real>& world, std::size_t row, Rotation turn, Vec2 direction) {
    if (world.bodies.is_disc(row)) return world.bodies.radius[row];
    return world.shapes.reach_along(world.bodies.shape[row], turn, direction);
}

template <class Real>
void add_walls(const WorldState<Real>& world, Overlaps& overlaps) {
    const Walls& walls = *world.walls;
    for (std::size_t row = 0; row < world.bodies.count; ++row) {
        if (world.bodies.is_immovable(row) || (world.bodies.flags_of(row) & kSensor)) continue;
        const Vec2 x{world.bodies.position_x[row], world.bodies.position_y[row]};
        const Rotation turn = turn_of(world.bodies, row);
        for (const std::int32_t side : kWallSides)
            if (has_wall(walls, side))
                overlaps.add_wall(
                    wall_clearance(walls, side, x) - reach_along(world, row, turn, wall_normal(side)),
                    world.bodies.inradius(row));
    }
}

/// Edges count like walls.
/// @param shapes  null in a world of discs; gets pairs with what is no disc
template <class Real>
void add_edges(const WorldState<Real>& world, const Candidates<Real>& discs, ShapeSeparations<Real>* shapes,
               Overlaps& overlaps) {
    EdgeCandidates<Real> edges;
    edges.place(world, 0);
    edges.find(world, discs);
    for (const EdgePair pair : edges.pairs()) {
        const auto row = static_cast<std::size_t>(pair.row);
        const Edge& edge = world.edges[pair.edge];
        const EdgePose& pose = edges.pose_of(edge);
        if (!world.bodies.is_disc(row)) {
            shapes->add(pair.row, edge, pose);
            continue;
        }
        const Vec2 x{world.bodies.position_x[row], world.bodies.position_y[row]};
        const Vec2 p = rotate_back(pose.turn, x - pose.position);
        const double share = nearest_share(p, edge.a, edge.b);
        if (!is_touched_here(p, share, world.edges, edge)) continue;
        const double radius = world.bodies.radius[row];
        overlaps.add_wall(std::sqrt(length_squared(p - point_at(edge.a, edge.b, share))) - radius, radius);
    }
}

/// @param shapes  null in a world of discs; gets pairs with what is no disc
template <class Real>
void add_pairs(const WorldState<Real>& world, const Candidates<Real>& discs, ShapeSeparations<Real>* shapes,
               Overlaps& overlaps) {
    const Bodies<Real>& bodies = world.bodies;
    overlaps.report.candidates += static_cast<std::int64_t>(discs.pair_count());
    for (std::size_t p = 0; p < discs.pair_count(); ++p) {
        const auto a = static_cast<std::size_t>(discs.pair_a()[p]);
        const auto b = static_cast<std::size_t>(discs.pair_b()[p]);
        if (!world.may_collide(a, b)) continue;
        if (!bodies.are_discs(discs.pair_a()[p], discs.pair_b()[p])) {
            shapes->add(discs.pair_a()[p], discs.pair_b()[p]);
            continue;
        }
        const Vec2 d{static_cast<double>(bodies.position_x[b]) - static_cast<double>(bodies.position_x[a]),
                     static_cast<double>(bodies.position_y[b]) - static_cast<double>(bodies.position_y[a])};
        const double radius_a = bodies.radius[a], radius_b = bodies.radius[b];
        overlaps.add(std::sqrt(length_squared(d)) - radius_a - radius_b, std::fmin(radius_a, radius_b));
    }
}

/// While it lives, rows that sleep count among those that are awake.
template <class Real>
class AllAwake {
  public:
    explicit AllAwake(Bodies<Real>& bodies) : bodies_(bodies), asleep_(bodies.asleep) {
        bodies_.count += asleep_, bodies_.asleep = 0;
    }
    ~AllAwake() { bodies_.count -= asleep_, bodies_.asleep = asleep_; }
    AllAwake(const AllAwake&) = delete;
    AllAwake& operator=(const AllAwake&) = delete;

  private:
    Bodies<Real>& bodies_;
    std::size_t asleep_;
};

/// While it lives, segments that lie end to end are joined: measuring leaves no trace.
template <class Real>
class JoinedForNow {
  public:
    explicit JoinedForNow(WorldState<Real>& world) : edges_(world.edges) {
        if (!edges_.has_changes()) return;
        before_ = edges_;
        join_segments(world);
    }
    ~JoinedForNow() {
        if (before_) std::swap(edges_, *before_);
    }
    JoinedForNow(const JoinedForNow&) = delete;
    JoinedForNow& operator=(const JoinedForNow&) = delete;

  private:
    EdgeStore& edges_;
    std::optional<EdgeStore> before_;
};

}  // namespace

// The candidates of the world are left alone. They would not do: what a disc reaches with a renewed margin is
// not among their pairs, strays are in none, and sleepers have none.
template <class Real>
OverlapReport measure_overlaps(Simulation<Real>& sim) {
    WorldState<Real>& world = sim.world;
    const AllAwake<Real> all_awake(world.bodies);
    const JoinedForNow<Real> joined(world);
    Candidates<Real> discs;
    discs.prepare(world.bodies.count);
    // A clock that stands still: pairs of the present positions.
    discs.update(world.bodies, FlightClock{}, {}, {}, 0, *sim.kernels, sim.executor);
    Overlaps overlaps;
    std::optional<ShapeSeparations<Real>> shapes;
    if (world.bodies.has_shapes) shapes.emplace(world);
    ShapeSeparations<Real>* const of_shapes = shapes ? &*shapes : nullptr;
    add_pairs(world, discs, of_shapes, overlaps);
    if (world.walls) add_walls(world, overlaps);
    if (!world.edges.empty()) add_edges(world, discs, of_shapes, overlaps);
    if (shapes)
        shapes->for_each_touching(*sim.kernels, [&](double separation, double inradius, bool is_edge) {
            is_edge ? overlaps.add_wall(separation, inradius) : overlaps.add(separation, inradius);
        });
    if (overlaps.report.touching > 0)
        overlaps.report.mean = overlaps.sum / static_cast<double>(overlaps.report.touching);
    return overlaps.report;
}

template OverlapReport measure_overlaps(Simulation<float>&);
template OverlapReport measure_overlaps(Simulation<double>&);

}  // namespace carom
