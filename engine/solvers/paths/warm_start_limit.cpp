#include "solvers/paths/warm_start_limit.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

/// A body is thrown if impulses make it so many times as fast as it was, what gravity adds in a substep
/// included. Small bodies between heavy ones are at 16 by round-off.
constexpr double kMostTimes = 64;
/// A speed that takes a body so far in a step, in inradii, is none.
constexpr double kNoWay = 1e-3;
/// What is forgotten leaves the next body of a squeeze with what it had on its other side alone: so many
/// bodies behind each other are looked at.
constexpr int kRounds = 16;

constexpr std::size_t kRowsPerTask = 2048;
constexpr double kNanosecondsToLook = 1;  // a row, on one thread, for the executor

}  // namespace

template <class Real>
void WarmStartLimit<Real>::apply(PathSolver<Real>& paths, const Bodies<Real>& bodies,
                                 const SubstepTerms& terms, BodyRecords<Real>& records, const Real* joined,
                                 const StepLoops<Real>& loops) {
    if (paths.manifolds.live().empty()) return;
    const std::size_t rows = records.moving();
    const StartColumns<Real> start = records.start_columns();
    const auto fall = static_cast<Real>(terms.fall_speed()), times = static_cast<Real>(kMostTimes),
               none = static_cast<Real>(kNoWay / terms.dt);
    const auto is_thrown = [&](std::size_t row) {
        const Real* now = &records.velocity[4 * row];
        const Real speed = std::fabs(now[0]) + std::fabs(now[1]) + std::fabs(now[2]),
                   before = std::fabs(start.x[row]) + std::fabs(start.y[row]) +
                            (start.rim ? std::fabs(start.rim[row]) : Real(0));
        return speed > times * (before + fall) + none * bodies.inradius(row) && !(joined && joined[row] > 0);
    };
    is_thrown_.assign(records.rows(), 0);
    has_thrown_.assign((rows + kRowsPerTask - 1) / kRowsPerTask, 0);
    for (int round = 0; round < kRounds; ++round) {
        loops.executor->for_each_chunk(rows, kRowsPerTask, kNanosecondsToLook,
                                       [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                           std::uint8_t any = 0;
                                           for (std::size_t row = first; row < last; ++row)
                                               any = std::max(any, is_thrown_[row] = is_thrown(row));
                                           has_thrown_[chunk] = any;
                                       });
        if (std::find(has_thrown_.begin(), has_thrown_.end(), 1) == has_thrown_.end()) return;
        paths.take_back(is_thrown_, records);
    }
}

template class WarmStartLimit<float>;
template class WarmStartLimit<double>;

}  // namespace carom
