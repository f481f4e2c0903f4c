#include "solvers/manifolds/poses_ahead.hpp"

#include <algorithm>

namespace carom {
namespace {

/// A body that comes by more than this share of its thinnest contact in a step is looked for where it is:
/// what flies into another one would be seen so deep in it that another side of it is nearer.
constexpr double kLeadShare = 0.1;

constexpr std::size_t kRowsPerTask = 1024;
constexpr double kNanosecondsToLook = 3;  // a row, on one thread, for the executor

/// Whether some contact may have no friction. Pieces have materials of their own, which are not looked at.
template <class Real>
bool may_be_smooth(const WorldState<Real>& world, const PieceItems<Real>& pieces) {
    const auto is_smooth = [](double friction) { return !(friction > 0); };
    const auto& friction = world.bodies.friction;
    if (!pieces.empty() || (world.walls && is_smooth(world.walls->material.friction))) return true;
    if (friction.is_uniform()) return is_smooth(friction.uniform_value());
    return std::any_of(friction.column().begin(), friction.column().end(), is_smooth);
}

}  // namespace

template <class Real>
void PosesAhead<Real>::look(const WorldState<Real>& world, double dt, const PoseWatch<Real>& now,
                            const PieceItems<Real>& pieces, const Executor& executor) {
    items_ = 0;
    if (!may_be_smooth(world, pieces)) return;
    const std::size_t rows = world.bodies.rows(), items = rows + pieces.count();
    items_ = static_cast<std::int32_t>(items);
    pose.resize(8 * items), come.resize(8 * items), shape.resize(2 * items);
    executor.for_each_chunk(rows, kRowsPerTask, kNanosecondsToLook,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                for (std::size_t row = first; row < last; ++row)
                                    look_at(world.bodies, static_cast<Real>(dt), now, row);
                            });
    pieces.for_each_piece([&](std::size_t item, std::size_t row, std::int32_t number) {
        for (const std::size_t from : {std::size_t{0}, items}) {
            std::copy_n(&pose[4 * (from + row)], 4, &pose[4 * (from + item)]);
            std::copy_n(&come[4 * (from + row)], 4, &come[4 * (from + item)]);
            shape[from + item] = number;
        }
    });
}

template <class Real>
void PosesAhead<Real>::look_at(const Bodies<Real>& bodies, Real dt, const PoseWatch<Real>& now,
                               std::size_t row) {
    const std::size_t ahead = static_cast<std::size_t>(items_) + row;
    const Real* at = &now.pose[4 * row];
    Real *to = &pose[4 * ahead], *way = &come[4 * ahead];
    std::copy_n(at, 4, &pose[4 * row]), std::copy_n(at, 4, to), std::fill_n(way, 4, Real(0));
    std::fill_n(&come[4 * row], 4, Real(0));
    shape[row] = shape[ahead] = bodies.shape[row];
    const Real most = static_cast<Real>(kLeadShare) * std::min(bodies.inradius(row), now.thinnest(row));
    const Real all = now.way(row);  // m, in the step
    // What nothing moves may have a velocity all the same.
    if (!(all > 0) || all > most) return;
    way[0] = dt * bodies.velocity_x[row], way[1] = dt * bodies.velocity_y[row], way[3] = dt;
    to[0] += way[0], to[1] += way[1];
    if (!bodies.has_rotation) return;
    way[2] = dt * bodies.angular_velocity[row];
    // By the tangent of half of the angle, as small as it is: a turn of any angle, whatever rounding does.
    const Real half = Real(0.5) * way[2], grown = 1 / (1 + half * half), cosine = (1 - half * half) * grown,
               sine = 2 * half * grown;
    to[2] = at[2] * cosine - at[3] * sine, to[3] = at[3] * cosine + at[2] * sine;
}

template class PosesAhead<float>;
template class PosesAhead<double>;

}  // namespace carom
