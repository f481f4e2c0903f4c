#include "world/measure.hpp"

#include <algorithm>
#include <cmath>

#include "broadphase/edge_candidates.hpp"
#include "math/vec2_math.hpp"
#include "narrowphase/disc_edge.hpp"
#include "shapes/walls.hpp"

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
void add_walls(const WorldState<Real>& world, Overlaps& overlaps) {
    const Walls& walls = *world.walls;
    for (std::size_t row = 0; row < world.bodies.count; ++row) {
        if (world.bodies.is_immovable(row)) continue;
        const Vec2 x{world.bodies.position_x[row], world.bodies.position_y[row]};
        const double radius = world.bodies.radius[row];
        for (const std::int32_t side : kWallSides)
            if (has_wall(walls, side)) overlaps.add_wall(wall_clearance(walls, side, x) - radius, radius);
    }
}

/// Edges count like walls.
template <class Real>
void add_edges(Simulation<Real>& sim, Overlaps& overlaps) {
    const WorldState<Real>& world = sim.world;
    Candidates<Real> discs;  // those of the world have margins of their own, which a disc may have renewed
    discs.prepare(world.bodies.count);
    discs.update(world.bodies, FlightClock{}, {}, {}, 0, *sim.kernels, sim.executor);
    EdgeCandidates<Real> edges;
    edges.place(world, 0);
    edges.find(world, discs);
    for (const EdgePair pair : edges.pairs()) {
        const auto row = static_cast<std::size_t>(pair.row);
        const Edge& edge = world.edges[pair.edge];
        const EdgePose& pose = edges.pose_of(edge);
        const Vec2 x{world.bodies.position_x[row], world.bodies.position_y[row]};
        const Vec2 p = rotate_back(pose.turn, x - pose.position);
        const double share = nearest_share(p, edge.a, edge.b);
        if (!is_touched_here(p, share, world.edges, edge)) continue;
        const double radius = world.bodies.radius[row];
        overlaps.add_wall(std::sqrt(length_squared(p - point_at(edge.a, edge.b, share))) - radius, radius);
    }
}

}  // namespace

template <class Real>
OverlapReport measure_overlaps(Simulation<Real>& sim);

/// As if all were awake: those that sleep are in no candidate pair.
template <class Real>
OverlapReport measure_with_sleepers(Simulation<Real>& sim) {
    Bodies<Real>& bodies = sim.world.bodies;
    const std::size_t asleep = bodies.asleep;
    Candidates<Real> of_those_awake;
    std::swap(of_those_awake, sim.candidates);
    bodies.count += asleep, bodies.asleep = 0;
    const OverlapReport report = measure_overlaps(sim);
    bodies.count -= asleep, bodies.asleep = asleep;
    std::swap(of_those_awake, sim.candidates);
    return report;
}

template <class Real>
OverlapReport measure_overlaps(Simulation<Real>& sim) {
    const Bodies<Real>& bodies = sim.world.bodies;
    if (bodies.asleep > 0) return measure_with_sleepers(sim);
    sim.candidates.prepare(bodies.count);
    // A clock that stands still: if there are no pairs yet, those of the present positions.
    if (!sim.candidates.is_valid())
        sim.candidates.update(bodies, FlightClock{}, {}, {}, 0, *sim.kernels, sim.executor);
    Overlaps overlaps;
    overlaps.report.candidates = static_cast<std::int64_t>(sim.candidates.pair_count());
    for (std::size_t p = 0; p < sim.candidates.pair_count(); ++p) {
        const auto a = static_cast<std::size_t>(sim.candidates.pair_a()[p]);
        const auto b = static_cast<std::size_t>(sim.candidates.pair_b()[p]);
        const Vec2 d{static_cast<double>(bodies.position_x[b]) - static_cast<double>(bodies.position_x[a]),
                     static_cast<double>(bodies.position_y[b]) - static_cast<double>(bodies.position_y[a])};
        const double radius_a = bodies.radius[a], radius_b = bodies.radius[b];
        overlaps.add(std::sqrt(length_squared(d)) - radius_a - radius_b, std::fmin(radius_a, radius_b));
    }
    if (sim.world.walls) add_walls(sim.world, overlaps);
    if (!sim.world.edges.empty()) add_edges(sim, overlaps);
    if (overlaps.report.touching > 0)
        overlaps.report.mean = overlaps.sum / static_cast<double>(overlaps.report.touching);
    return overlaps.report;
}

template OverlapReport measure_overlaps(Simulation<float>&);
template OverlapReport measure_overlaps(Simulation<double>&);

}  // namespace carom
