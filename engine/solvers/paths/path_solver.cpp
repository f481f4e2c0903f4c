#include "solvers/paths/path_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "solvers/paths/cut/path_plan.hpp"
#include "solvers/paths/path_link.hpp"

namespace carom {
namespace {

// docs/decisions/0027-paths-of-contacts.md has the measurements behind these.

/// Share of an overlap that a substep takes away. Pushes do work on the loads that they lift: at 0.4 heaps of
/// boxes shake for ever.
constexpr double kRecovery = 0.1;
/// What two such substeps take away, where turns of joints and contacts sweep.
constexpr double kRecoveryOfTwo = 1 - (1 - kRecovery) * (1 - kRecovery);
/// Overlaps of contacts that hardly move are left, up to this share of the thickness: what one push parts
/// another one closes, so a heap that lies still would creep for ever. Slow is less than this share of what
/// gravity adds to a speed in a substep. docs/decisions/0037-heaps-that-lie-still.md.
constexpr double kSlop = 0.015, kSlowShare = 0.1;
/// Largest displacement of that kind, in thicknesses a second.
constexpr double kPushThicknesses = 6;
/// Iterations of the active set that change all of its rows that are wrong.
constexpr int kBoldIterations = 4;
/// By which a contact may miss its law, in shares of what gravity adds to a speed in a substep.
constexpr double kTolerance = 2e-3;
/// Paths whose contacts all were slower than this may rest for a substep, in shares of the same,
constexpr double kRestingSpeed = 0.25;
/// and what such a path moves in a substep is less than this share of the thickness of its bodies.
constexpr double kRestingShare = 1e-4;

/// Turns of rolling resistance and contacts a substep: a rolling disc loses a third of what is wrong in each.
constexpr int kTurnsOfRolling = 3;

// ns on one thread, for the executor.
constexpr double kNanosecondsToSolve = 10;
constexpr std::size_t kWatchedPerTask = 64;
/// Shares of the bundles of a colour, tasks with room of their own in `scratch`: the same in all loops over
/// links, so that a thread finds them in its cache. A thread alone has one: in a share, paths that do not
/// settle are solved together.
constexpr std::size_t kShares = 16;

}  // namespace

template <class Real>
void PathSolver<Real>::find(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                            const SubstepTerms& terms, const ContactDistance& near,
                            BodyRecords<Real>& records, const StepLoops<Real>& loops) {
    unhide();
    const bool is_same = manifolds.find(world, edges, terms, near, loops);
    counters.contacts = static_cast<std::int64_t>(manifolds.live().size());
    if (manifolds.live().empty()) return rolling_.clear();
    using Change = typename PathChoice<Real>::Change;
    const Change change = choice_.choose(world, manifolds, terms.dt, is_same, counters.unsettled, turns,
                                         is_of_crowd, *loops.executor);
    if (change != Change::none) links_hold_ = false;
    if (change == Change::paths) ++counters.cuts;
    lay_out(world, edges, terms, records, loops);
    if (world.effects.rolling_resistance) rolling_.find(world, manifolds, row_of_far_);
}

/// Rows at rest for the padding of each bundle and for what nothing moves, and the row where each path
/// begins.
template <class Real>
void PathSolver<Real>::name_rows(const WorldState<Real>& world, const BodyRecords<Real>& records,
                                 const StepLoops<Real>& loops) {
    const Bodies<Real>& bodies = world.bodies;
    const std::span<const std::int32_t> live = manifolds.live();
    row_of_far_.resize(live.size()), with_kinematic_.clear();
    first_still_row_ = records.rows();
    std::size_t row = first_still_row_ + cut().bundles();
    for (std::size_t n = 0; n < live.size(); ++n) {
        const std::int32_t partner = manifolds.list_of(live[n]).b[Manifolds<Real>::place_of(live[n])];
        const auto b = static_cast<std::size_t>(partner);
        const bool b_moves = partner >= 0 && b < bodies.count && !bodies.is_immovable(b);
        row_of_far_[n] = b_moves ? partner : static_cast<std::int32_t>(row++);
        if (!b_moves && live[n] >= 0 && (bodies.flags_of(b) & kKinematic) != 0)
            with_kinematic_.push_back(static_cast<std::int32_t>(n));
    }
    still_rows_ = row - first_still_row_;
    heads_.resize_for_overwrite(kPathLanes * cut().bundles());
    for (std::size_t lane = 0; lane < kPathLanes * cut().bundles(); ++lane) {
        const std::int32_t first = cut().first_contacts()[lane];
        heads_[lane] =
            first >= 0 ? head_row(first) : static_cast<std::int32_t>(first_still_row_ + lane / kPathLanes);
    }
    closing_.resize(cut().bundles());
    shares_ = loops.executor->threads() == 1 ? 1 : kShares;
    scratch_.resize(path_scratch_bytes(cut().longest()) * shares_);
    find_shares();
}

template <class Real>
SolvePaths<Real> PathSolver<Real>::arguments(const SubstepTerms& terms, BodyRecords<Real>& records) {
    SolvePaths<Real> k{};
    k.links = links_.data(), k.first_link = cut().first_link().data(), k.heads = heads_.data();
    k.velocity = records.velocity.data(), k.displacement = records.displacement.data();
    k.turn = records.turn();
    k.h = static_cast<Real>(terms.substep_dt), k.inverse_h = static_cast<Real>(1 / terms.substep_dt);
    k.recovery = static_cast<Real>(pushes_twice ? kRecoveryOfTwo : kRecovery),
    k.push = static_cast<Real>(kPushThicknesses);
    k.slop = static_cast<Real>(kSlop), k.slow = static_cast<Real>(kSlowShare * terms.fall_speed());
    k.fall = static_cast<Real>(terms.fall_speed());
    k.velocity_tolerance = static_cast<Real>(kTolerance * terms.fall_speed());
    k.closing = closing_.data();
    k.restless = restless_.data(), k.is_slender = cut().is_slender().data(), k.resting_speed = 0;
    k.resting_thickness =
        static_cast<Real>(kRestingSpeed * terms.fall_speed() * terms.substep_dt / kRestingShare);
    const PathPlan& plan = plan_of(choice_.mood_of_cut(), manifolds.is_crowd());
    k.bold_iterations = kBoldIterations;
    k.most_iterations = plan.most, k.most_of_slender = plan.most_of_slender;
    k.tries_pieces = plan.tries_pieces, k.sweeps_of_unsettled = plan.sweeps_of_unsettled;
    return k;
}

/// Bundles come in order of their length: shares have as many links as each other, not bundles.
template <class Real>
void PathSolver<Real>::find_shares() {
    first_of_share_.clear();
    for (std::size_t colour = 0; colour < cut().colours(); ++colour) {
        const std::size_t first = cut().first_bundle()[colour], last = cut().first_bundle()[colour + 1];
        const std::span<const std::size_t> starts = cut().first_link().subspan(first, last - first);
        const std::size_t links = cut().first_link()[last] - starts.front();
        for (std::size_t share = 0; share <= shares_; ++share) {
            const std::size_t link = starts.front() + share * links / shares_;
            const auto at = std::lower_bound(starts.begin(), starts.end(), link);
            first_of_share_.push_back(first + static_cast<std::size_t>(at - starts.begin()));
        }
    }
}

template <class Real>
typename PathSolver<Real>::BundleRange PathSolver<Real>::share_of(std::size_t colour, std::size_t share,
                                                                  Bundles which) const {
    const std::size_t* first = &first_of_share_[colour * (shares_ + 1) + share];
    if (which != Bundles::near_turns) return {first[0], first[1]};
    const std::size_t end = cut().end_of_turns()[colour];
    return {std::min(first[0], end), std::min(first[1], end)};
}

/// Colour after colour; the bundles of a colour side by side.
template <class Real>
void PathSolver<Real>::run(Pass pass, SolvePaths<Real> arguments, const StepLoops<Real>& loops,
                           Bundles which) {
    const std::size_t bytes = path_scratch_bytes(cut().longest());
    for (std::size_t colour = 0; colour < cut().colours(); ++colour) {
        const std::size_t first = cut().first_bundle()[colour], last = which == Bundles::near_turns
                                                                           ? cut().end_of_turns()[colour]
                                                                           : cut().first_bundle()[colour + 1];
        if (first == last) continue;
        const std::size_t links = cut().first_link()[last] - cut().first_link()[first];
        const bool is_one = last - first < 2;  // bundle
        std::array<std::size_t, kShares> unsettled{};
        loops.executor->for_each_task(
            is_one ? 1 : shares_, kNanosecondsToSolve * kPathLanes * static_cast<double>(links),
            [&](std::size_t share) {
                const BundleRange own = is_one ? BundleRange{first, last} : share_of(colour, share, which);
                if (own.first == own.last) return;
                SolvePaths<Real> k = arguments;
                k.scratch = scratch_.data() + share * bytes;
                unsettled[share] = pass(k, own.first, own.last).unsettled;
            });
        for (const std::size_t more : unsettled) counters.unsettled += static_cast<std::int64_t>(more);
    }
}

/// Contacts beside the paths: all are looked at, those that close are solved one by one.
/// @param has_floors  whether they have the floors of the substep
template <class Real>
void PathSolver<Real>::solve_watched(const SolvePaths<Real>& arguments, const StepLoops<Real>& loops,
                                     Bundles which, bool has_floors) {
    const std::size_t begin = cut().first_watched(),
                      end = which == Bundles::near_turns ? cut().end_of_watched_turns() : cut().bundles();
    const PathKernels<Real>& kernels = loops.kernels->convex->paths;
    const int sweeps = plan_of(choice_.mood_of_cut(), manifolds.is_crowd()).sweeps_of_watched;
    for (int sweep = 0; sweep < sweeps && begin < end; ++sweep) {
        const Pass watch = has_floors || sweep > 0 ? kernels.watch_again : kernels.watch;
        loops.executor->for_each_chunk(end - begin, kWatchedPerTask, kNanosecondsToSolve * kPathLanes,
                                       [&](std::size_t, std::size_t first, std::size_t last) {
                                           watch(arguments, begin + first, begin + last);
                                       });
        if (kernels.settle(arguments, begin, end).closing == 0) return;
    }
}

template <class Real>
void PathSolver<Real>::warm_start(const SubstepTerms& terms, BodyRecords<Real>& records,
                                  const StepLoops<Real>& loops) {
    counters.unsettled = 0;
    if (!manifolds.live().empty()) {
        run(loops.kernels->convex->paths.warm_start, arguments(terms, records), loops);
        for (const std::uint32_t n : cut().watched()) {
            const PathCut::Place place = cut().places()[n];
            const PathLink<Real>& link = links_[place.link];
            if (link.normal1[place.lane] + link.normal2[place.lane] > 0)
                give_impulses(link, place.lane, static_cast<std::size_t>(near_row(place)),
                              static_cast<std::size_t>(link.body[place.lane]), Real(1), records.velocity);
        }
    }
    rolling_.warm_start(records);
}

/// @param turns_of_rolling  in each of which all paths are solved once more
template <class Real>
void PathSolver<Real>::solve(SolvePaths<Real> k, BodyRecords<Real>& records, const StepLoops<Real>& loops,
                             int passes, int turns_of_rolling, bool sweeps, Bundles which) {
    const auto solve_all = [&] {
        ++counters.solves;
        run(loops.kernels->convex->paths.solve, k, loops, which);
    };
    for (int pass = 0; pass < passes; ++pass) solve_all();
    solve_watched(k, loops, which, false);
    choice_.note_solved(static_cast<std::int64_t>(cut().paths()) * std::max(passes, 1));
    for (int turn = 0; turn < turns_of_rolling && !rolling_.empty(); ++turn) {
        rolling_.solve(records, [&](std::size_t n) {
            const PathCut::Place place = cut().places()[n];
            return links_[place.link].normal1[place.lane] + links_[place.link].normal2[place.lane];
        });
        solve_all();
    }
    // In a crowd paths are short, and what they hand on to each other is more than what is left in them:
    // docs/decisions/0058-large-heaps.md.
    if (!sweeps && !(manifolds.is_crowd() && rolling_.empty())) return;
    k.resting_speed = sweeps ? Real(0) : static_cast<Real>(kRestingSpeed) * k.fall;
    run(loops.kernels->convex->paths.sweep, k, loops, which);
    solve_watched(k, loops, which, rolling_.empty());  // else displacements have changed
}

template <class Real>
void PathSolver<Real>::solve(const SubstepTerms& terms, BodyRecords<Real>& records,
                             const StepLoops<Real>& loops, int passes, bool sweeps, Bundles which) {
    if (manifolds.live().empty()) return;
    SolvePaths<Real> k = arguments(terms, records);
    if (which == Bundles::restless && rolling_.empty())
        k.resting_speed = static_cast<Real>(kRestingSpeed) * k.fall;
    without_hidden([&] { solve(k, records, loops, passes, kTurnsOfRolling, sweeps, which); });
}

/// A turn of rolling resistance ends with a solve of the paths: that is the only one.
template <class Real>
void PathSolver<Real>::solve_again(const SubstepTerms& terms, BodyRecords<Real>& records,
                                   const StepLoops<Real>& loops, bool sweeps, Bundles which) {
    if (manifolds.live().empty()) return;
    if (is_wild_crowd() && rolling_.empty()) return sweep(terms, records, loops, which);
    SolvePaths<Real> k = arguments(terms, records);
    k.tries_pieces = false;
    without_hidden([&] { solve(k, records, loops, rolling_.empty() ? 1 : 0, 1, sweeps, which); });
}

template <class Real>
void PathSolver<Real>::sweep(const SubstepTerms& terms, BodyRecords<Real>& records,
                             const StepLoops<Real>& loops, Bundles which) {
    if (manifolds.live().empty()) return;
    const SolvePaths<Real> k = arguments(terms, records);
    without_hidden([&] {
        solve_watched(k, loops, which, false);
        run(loops.kernels->convex->paths.sweep, k, loops, which);
        solve_watched(k, loops, which, true);
    });
}

template <class Real>
bool PathSolver<Real>::sweep_restless(const SubstepTerms& terms, BodyRecords<Real>& records,
                                      const StepLoops<Real>& loops, Real least) {
    if (!manifolds.is_crowd() || !rolling_.empty() || is_wild_crowd()) return false;
    if (!pieces_.knows_contacts()) {
        ends_.clear();
        for (const PathCut::Place& place : cut().places())
            ends_.push_back({near_row(place), links_[place.link].body[place.lane]});
        pieces_.list_contacts(cut(), ends_, records.rows());
    }
    bool are_few = false;
    without_hidden([&] {
        are_few = pieces_.gather(cut(), records.velocity, records.count(), least, links_, heads_,
                                 static_cast<std::int32_t>(first_still_row_));
    });
    if (!are_few) return false;
    pieces_.sweep(arguments(terms, records), loops.kernels->convex->paths,
                  plan_of(choice_.mood_of_cut(), manifolds.is_crowd()).sweeps_of_watched, links_);
    return true;
}

template <class Real>
void PathSolver<Real>::run_loads(LoadPass pass, const PathLoads<Real>& loads, const SubstepTerms& terms,
                                 BodyRecords<Real>& records, const StepLoops<Real>& loops) {
    if (manifolds.live().empty()) return;
    SolvePaths<Real> k = arguments(terms, records);
    k.coarse = loads;
    const Pass kernel = loops.kernels->convex->paths.*pass;
    run(kernel, k, loops);
    k.coarse.is_beside = true;
    kernel(k, cut().first_watched(), cut().bundles());
}

template <class Real>
typename PathSolver<Real>::FastContacts PathSolver<Real>::find_fast(Column<Real>& velocity, double speed,
                                                                    double sure_speed, double light_press,
                                                                    const SubstepTerms& terms,
                                                                    BodyRecords<Real>& records,
                                                                    const StepLoops<Real>& loops) {
    if (manifolds.live().empty()) return {};
    is_fast_.resize_for_overwrite(cut().links()), comes_.resize_for_overwrite(cut().links());
    SolvePaths<Real> k = arguments(terms, records);
    k.foreseen = k.velocity, k.velocity = velocity.data();
    k.is_fast = is_fast_.data(), k.comes = comes_.data();
    k.fast = static_cast<Real>(speed), k.surely_fast = static_cast<Real>(sure_speed);
    k.light_press = static_cast<Real>(light_press);
    const Pass kernel = loops.kernels->convex->paths.find_fast;
    run(kernel, k, loops);
    kernel(k, cut().first_watched(), cut().bundles());
    return {{is_fast_.data(), cut().links()}, {comes_.data(), cut().links()}};
}

template <class Real>
void PathSolver<Real>::advance(const SubstepTerms& terms, BodyRecords<Real>& records) {
    if (manifolds.live().empty()) return;
    const auto h = static_cast<Real>(terms.substep_dt);
    for (std::size_t row = first_still_row_; row < records.rows(); ++row) {
        const Real* velocity = &records.velocity[4 * row];
        records.displacement[2 * row] += h * velocity[0],
            records.displacement[2 * row + 1] += h * velocity[1];
        records.turn()[row] += h * velocity[2];
    }
    turning_edges_.advance(terms.substep_dt, records);
}

template <class Real>
void PathSolver<Real>::take_from(const std::vector<std::uint8_t>& is_of, Column<Real>& velocity) const {
    if (manifolds.live().empty()) return;  // then the cut is that of an earlier step
    for (const PathCut::Place place : cut().places()) {
        const PathLink<Real>& link = links_[place.link];
        const auto near = static_cast<std::size_t>(near_row(place)),
                   far = static_cast<std::size_t>(link.body[place.lane]);
        if ((is_of[near] | is_of[far]) != 0) give_impulses(link, place.lane, near, far, Real(-1), velocity);
    }
    rolling_.take_from(is_of, velocity);
}

template <class Real>
bool PathSolver<Real>::has_long_loops() const {
    return kNanosecondsToSolve * static_cast<double>(manifolds.live().size()) >
           PathCut::kColours * kShortestParallelLoop;
}

template <class Real>
std::size_t PathSolver<Real>::bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return manifolds.bytes() + rolling_.bytes() + turning_edges_.bytes() + of(row_of_far_) +
           of(with_kinematic_) + closing_.bytes() + is_fast_.bytes() + comes_.bytes() + choice_.bytes() +
           links_.bytes() + heads_.bytes() + restless_.bytes() + turns.bytes() + pieces_.bytes() + of(ends_) +
           scratch_.bytes() + of(hidden_) + of(first_of_share_);
}

template class PathSolver<float>;
template class PathSolver<double>;

}  // namespace carom
