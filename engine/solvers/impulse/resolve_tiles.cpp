#include <algorithm>

#include "solvers/impulse/impulse_solver.hpp"
#include "state/add_books.hpp"

// The part of the impulse solver that shares the impacts of a substep out by tiles.

namespace carom {
namespace {

constexpr double kNanosecondsOfImpact = 100;  // on one thread, for the executor
// Impacts of a tile beyond this many are left to the end, where the embedding program may end the step.
constexpr std::size_t kMostImpactsOfTile = 20000;

}  // namespace

template <class Real>
void ImpulseSolver<Real>::resolve_impacts(const Executor& executor) {
    if (tiles_.count() > 1) {
        lists_.begin(outcome_.of_other_tiles, tiles_.count());
        for (std::size_t phase = 0; phase < tiles_.phases(); ++phase) {
            const std::int64_t before = outcome_.impacts;
            resolve_phase(phase, executor);
            const auto done = static_cast<std::size_t>(outcome_.impacts - before);
            if (flights.is_interrupted_after(done * Interruption::kImpact)) return;
        }
        take_left();
    }
    all_.resolve();
    if (all_.budget == 0) counters.unresolved_impacts += static_cast<std::int64_t>(all_.waiting());
    counters.impacts += outcome_.impacts, counters.wall_impacts += outcome_.wall_impacts;
    counters.simultaneous_impacts += outcome_.simultaneous_impacts;
}

template <class Real>
void ImpulseSolver<Real>::resolve_phase(std::size_t phase, const Executor& executor) {
    const std::size_t tiles = tiles_.tiles_of(phase);
    if (outcomes_.size() < tiles) outcomes_.resize(tiles);
    std::size_t expected = 0;
    for (std::size_t n = 0; n < tiles; ++n) expected += lists_.expected(tiles_.tile(phase, n));
    executor.for_each_task(tiles, kNanosecondsOfImpact * static_cast<double>(expected),
                           [&](std::size_t n) { work_on_tile(phase, n); });
    for (std::size_t n = 0; n < tiles; ++n) collect(outcomes_[n]);
}

/// @param number  of the tile in its phase
template <class Real>
void ImpulseSolver<Real>::work_on_tile(std::size_t phase, std::size_t number) {
    ImpactOutcome& outcome = outcomes_[number];
    outcome.begin(outcome_.overshoot);
    outcome.resting.clear();
    outcome.books = {};
    outcome.books.is_open = flights.books->is_open;
    const std::size_t tile = tiles_.tile(phase, number);
    resolvers_.with_resolver([&](ImpactResolver<Real>& resolver) {
        resolver.begin_substep(flights, terms_, outcome, outcome.books);
        resolver.prefetch_tile(tile);
        resolver.begin_phase(phase, tiles_.reach(tile), lists_.expected(tile));
        resolver.budget = kMostImpactsOfTile;
        lists_.for_each_of(tile, [&](const Impact& impact) { resolver.add(impact); });
        resolver.resolve();
        resolver.leave_rest();
    });
}

/// Puts together what the tiles found and left, in the order of tiles, whichever was done first.
template <class Real>
void ImpulseSolver<Real>::collect(ImpactOutcome& outcome) {
    add_books(*flights.books, outcome.books);
    outcome_.impacts += outcome.impacts, outcome_.wall_impacts += outcome.wall_impacts;
    outcome_.simultaneous_impacts += outcome.simultaneous_impacts;
    outcome_.overshoot = std::max(outcome_.overshoot, outcome.overshoot);
    all_.budget -= std::min(all_.budget, static_cast<std::size_t>(outcome.impacts));
    for (const PlacedImpact& placed : outcome.of_other_tiles) lists_.add(placed);
    const auto append = [](auto& list, const auto& more) {
        list.insert(list.end(), more.begin(), more.end());
    };
    append(outcome_.resting, outcome.resting);
    append(outcome_.left, outcome.left);
    append(outcome_.left_bodies, outcome.left_bodies);
}

/// What tiles have left comes last, in the order of time.
template <class Real>
void ImpulseSolver<Real>::take_left() {
    all_.begin_phase(ImpactResolver<Real>::kAfterAll, {}, outcome_.left.size());
    for (const Impact& impact : outcome_.left) all_.add(impact);
    for (const ImpactOutcome::Unforeseen& body : outcome_.left_bodies)
        if (deflections_[static_cast<std::size_t>(body.row)] == body.deflections)
            all_.foresee_near(body.row, body.from);
}

template class ImpulseSolver<float>;
template class ImpulseSolver<double>;

}  // namespace carom
