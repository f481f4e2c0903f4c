#include "peers/body_measures.hpp"

#include <carom/carom.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "peers/peer.hpp"

namespace carom::bench {
namespace {

/// A plain cell list, independent of any engine's broadphase.
class CellList {
  public:
    CellList(double size, const std::vector<BodyState>& bodies) : size_(size) {
        for (std::size_t i = 0; i < bodies.size(); ++i)
            if (is_finite(bodies[i].position)) cells_[key_of(bodies[i].position)].push_back(i);
    }
    /// Calls fn(other) for every body in the nine cells around a position.
    template <class Fn>
    void for_each_near(Vec2 position, const Fn& fn) const {
        for (int dv = -1; dv <= 1; ++dv)
            for (int du = -1; du <= 1; ++du) {
                const auto cell = cells_.find(key_of({position.x + du * size_, position.y + dv * size_}));
                if (cell == cells_.end()) continue;
                for (const std::size_t other : cell->second) fn(other);
            }
    }
    static bool is_finite(Vec2 v) { return std::abs(v.x) < 1e9 && std::abs(v.y) < 1e9; }

  private:
    std::uint64_t key_of(Vec2 position) const {
        const auto u = static_cast<std::int64_t>(std::floor(position.x / size_));
        const auto v = static_cast<std::int64_t>(std::floor(position.y / size_));
        return (static_cast<std::uint64_t>(u) << 32) ^ (static_cast<std::uint64_t>(v) & 0xffffffffU);
    }
    double size_;  // m
    std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

void add_overlaps(const Scene& scene, const std::vector<BodyState>& bodies, BodyMeasures& measures) {
    double largest = 0;
    for (const Body& body : scene.bodies) largest = std::max(largest, radius_of(body));
    const CellList cells(2 * largest, bodies);
    double sum = 0;
    for (std::size_t a = 0; a < bodies.size(); ++a) {
        const Vec2 at = bodies[a].position;
        if (!CellList::is_finite(at)) continue;
        cells.for_each_near(at, [&](std::size_t b) {
            if (b <= a) return;
            const double reach = radius_of(scene.bodies[a]) + radius_of(scene.bodies[b]);
            const double overlap =
                reach - std::hypot(bodies[b].position.x - at.x, bodies[b].position.y - at.y);
            if (overlap <= 0) return;
            ++measures.touching;
            sum += overlap / (reach / 2);
            measures.overlap_max = std::max(measures.overlap_max, overlap / (reach / 2));
        });
    }
    if (measures.touching > 0) measures.overlap_mean = sum / static_cast<double>(measures.touching);
}

/// The world's own measure, from positions and angles in double precision. Bodies whose position is no number
/// are left out.
void add_overlaps_of_shapes(const Scene& scene, const std::vector<BodyState>& bodies,
                            BodyMeasures& measures) {
    Scene still = scene;
    still.bodies.clear();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (!CellList::is_finite(bodies[i].position)) continue;
        Body body = scene.bodies[i];
        body.position = bodies[i].position, body.angle = bodies[i].angle;
        body.velocity = {}, body.angular_velocity = 0;
        still.bodies.push_back(std::move(body));
    }
    const OverlapReport overlaps = World64(still, {.threads = 1}).overlaps();
    measures.touching = overlaps.touching;
    measures.overlap_mean = overlaps.mean, measures.overlap_max = overlaps.max;
}

bool is_outside(const std::optional<Walls>& walls, Vec2 at) {
    if (!CellList::is_finite(at)) return true;
    return walls && ((walls->left && at.x < walls->min.x) || (walls->right && at.x > walls->max.x) ||
                     (walls->bottom && at.y < walls->min.y) || (walls->top && at.y > walls->max.y));
}

}  // namespace

BodyMeasures measure_bodies(const Scene& scene, const std::vector<BodyState>& bodies) {
    BodyMeasures measures;
    double squares = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyState& state = bodies[i];
        const double mass = mass_of(scene.bodies[i]), inertia = inertia_of(scene.bodies[i]);
        const double speed = std::hypot(state.velocity.x, state.velocity.y);
        squares += speed * speed;
        measures.speed_max = std::max(measures.speed_max, speed);
        measures.kinetic +=
            mass * speed * speed / 2 + inertia * state.angular_velocity * state.angular_velocity / 2;
        measures.potential -=
            mass * (scene.gravity.x * state.position.x + scene.gravity.y * state.position.y);
        if (is_outside(scene.walls, state.position)) ++measures.outside;
    }
    if (!bodies.empty()) measures.speed_rms = std::sqrt(squares / static_cast<double>(bodies.size()));
    if (std::all_of(scene.bodies.begin(), scene.bodies.end(), is_disc))
        add_overlaps(scene, bodies, measures);
    else
        add_overlaps_of_shapes(scene, bodies, measures);
    return measures;
}

}  // namespace carom::bench
