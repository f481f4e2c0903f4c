#include "solvers/paths/warm_start_limit.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

/// A body is thrown if impulses make it so many times as fast as it was, what gravity adds in a substep
/// included. Small bodies between heavy ones are at 16 by round-off.
constexpr double kMostTimes = 64;
/// Where bodies lie on each other one that loses a contact is as fast as the weight that it carries makes it,
/// which is no squeeze: chains of loads carry several times what lies above them. A body is thrown if it is
/// so many times as fast for each layer.
constexpr double kTimesOfLayer = 8;
/// Contacts by which the layers are counted, about.
constexpr std::size_t kContactsToMeasure = 1024;
/// A speed that takes a body so far in a step, in inradii, is none.
constexpr double kNoWay = 1e-3;
/// What is forgotten leaves the next body of a squeeze with what it had on its other side alone: so many
/// bodies behind each other are looked at.
constexpr int kRounds = 16;

constexpr std::size_t kRowsPerTask = 2048;  // some microseconds of work
constexpr double kNanosecondsToLook = 1;    // a row, on one thread, for the executor

/// How many layers of bodies push on each other, about: how far the contacts that push spread along gravity,
/// over how thick bodies are. Evenly spread ones reach sqrt(3) of their root mean square to either side.
template <class Real>
double layers_of(const PathSolver<Real>& paths, const Bodies<Real>& bodies, Vec2 gravity) {
    const double length = std::sqrt(length_squared(gravity));
    if (!(length > 0)) return 0;
    const Vec2 down = (1 / length) * gravity;
    const std::size_t contacts = paths.manifolds.live().size(), stride = contacts / kContactsToMeasure + 1;
    double count = 0, thickness = 0, sum = 0, squares = 0, from = 0;
    const auto add = [&](const PathContact<Real>& contact) {
        if (!(contact.link.normal1[contact.lane] + contact.link.normal2[contact.lane] > 0)) return;
        const auto near = static_cast<std::size_t>(contact.near), far = static_cast<std::size_t>(contact.far);
        const std::size_t row = near < bodies.count ? near : far;
        const double height = down.x * static_cast<double>(bodies.position_x[row]) +
                              down.y * static_cast<double>(bodies.position_y[row]);
        if (count == 0) from = height;
        count += 1, sum += height - from, squares += (height - from) * (height - from);
        thickness += 2 * static_cast<double>(bodies.inradius(row));
    };
    for (std::size_t n = 0; n < contacts; n += stride) paths.for_each_of(n, n + 1, add);
    if (!(thickness > 0)) return 0;
    const double mean = sum / count, variance = std::fmax(squares / count - mean * mean, 0);
    return 2 * std::sqrt(3 * variance) * count / thickness;
}

}  // namespace

template <class Real>
void WarmStartLimit<Real>::apply(PathSolver<Real>& paths, const Bodies<Real>& bodies,
                                 const SubstepTerms& terms, BodyRecords<Real>& records, const Real* joined,
                                 const StepLoops<Real>& loops) {
    if (paths.manifolds.live().empty()) return;
    const std::size_t rows = records.moving();
    const auto fall = static_cast<Real>(terms.fall_speed()), none = static_cast<Real>(kNoWay / terms.dt);
    FindThrown<Real> k{};
    k.velocity = records.velocity.data(), k.start = records.start_columns();
    k.inradius = bodies.inradius().data(), k.uniform_inradius = bodies.inradius().uniform_value();
    k.joined = joined, k.times = kMostTimes, k.fall = fall, k.none = none;
    is_thrown_.assign(padded(records.rows()), 0);
    k.is_thrown = is_thrown_.data();
    has_thrown_.assign((rows + kRowsPerTask - 1) / kRowsPerTask, 0);
    for (int round = 0; round < kRounds; ++round) {
        loops.executor->for_each_chunk(rows, kRowsPerTask, kNanosecondsToLook,
                                       [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                           has_thrown_[chunk] =
                                               loops.kernels->convex->find_thrown(k, first, padded(last));
                                       });
        std::fill_n(is_thrown_.begin() + static_cast<std::ptrdiff_t>(rows), padded(rows) - rows, 0);
        if (std::find(has_thrown_.begin(), has_thrown_.end(), 1) == has_thrown_.end()) return;
        if (round == 0) {
            k.times = static_cast<Real>(kTimesOfLayer * layers_of(paths, bodies, terms.gravity_change));
            if (k.times > static_cast<Real>(kMostTimes)) continue;
            k.times = static_cast<Real>(kMostTimes);
        }
        paths.take_back(is_thrown_, records);
    }
}

template class WarmStartLimit<float>;
template class WarmStartLimit<double>;

}  // namespace carom
