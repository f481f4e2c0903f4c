#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "constraints/partner.hpp"
#include "kernels/paths/path_arguments.hpp"
#include "solvers/manifolds/manifolds.hpp"
#include "solvers/paths/cut/path_choice.hpp"
#include "solvers/paths/cut/path_pieces.hpp"
#include "solvers/paths/cut/turn_rows.hpp"
#include "solvers/paths/path_rolling.hpp"
#include "solvers/paths/turning_edges.hpp"
#include "solvers/substeps/body_records.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/world_state.hpp"

namespace carom {

/// What the solver of paths counts, of the last step.
struct PathCounters {
    std::int64_t contacts = 0;   ///< that can touch
    std::int64_t bundles = 0;    ///< of paths
    std::int64_t links = 0;      ///< of bundles: kPathLanes times as many places for contacts
    std::int64_t unsettled = 0;  ///< paths whose active set did not settle, in all substeps
    std::int64_t impacts = 0;    ///< so far
    std::int64_t solves = 0;     ///< of all paths, or of those near bodies in turns, so far
    std::int64_t cuts = 0;       ///< steps that cut the contacts into paths anew, so far
};

/// A contact in its place along a path.
template <class Real>
struct PathContact {
    const PathLink<Real>& link;
    std::size_t lane;
    std::int32_t near, far;  ///< rows in the records; those of what nothing moves are beyond the bodies
    Partner partner;         ///< b of the contact
    double restitution;
};

/// Solves the contacts of convex shapes that are no discs exactly, along paths of contacts.
///
/// Cost: docs/decisions/0027-paths-of-contacts.md.
template <class Real>
class PathSolver {
  public:
    PathCounters counters;
    Manifolds<Real> manifolds;  ///< what can touch

    /// Finds the contacts of the step and lays them out along paths.
    void find(const WorldState<Real>& world, const EdgeCandidates<Real>& edges, const SubstepTerms& terms,
              const ContactDistance& near, BodyRecords<Real>& records, const StepLoops<Real>& loops);
    /// Gives the bodies the impulses of the step before.
    void warm_start(const SubstepTerms& terms, BodyRecords<Real>& records, const StepLoops<Real>& loops);
    /// Bundles of paths that are solved: all; but those that hardly moved when they were solved last; those
    /// alone that are near bodies in turns.
    enum class Bundles : std::uint8_t { all, restless, near_turns };
    /// Solves a substep.
    /// @param passes  times that the paths are solved, at least once; more where there are no impulses to
    /// start from
    /// @param sweeps  whether to sweep over all contacts at the end
    void solve(const SubstepTerms& terms, BodyRecords<Real>& records, const StepLoops<Real>& loops,
               int passes, bool sweeps, Bundles which = Bundles::all);
    /// Sweeps over all contacts once.
    void sweep(const SubstepTerms& terms, BodyRecords<Real>& records, const StepLoops<Real>& loops,
               Bundles which = Bundles::all);
    /// Solves once more what is solved already, since something else has changed velocities: a turn of many,
    /// so rolling resistance takes one in each, and what does not settle is swept in place of solved in
    /// pieces. Wild crowds are swept, but for rolling resistance.
    void solve_again(const SubstepTerms& terms, BodyRecords<Real>& records, const StepLoops<Real>& loops,
                     bool sweeps, Bundles which);
    /// Whether contacts come and go among so many that a solution is soon out of date.
    bool is_wild_crowd() const { return choice_.mood_of_cut() == PathMood::wild && manifolds.is_crowd(); }
    TurnRows turns;             ///< whose contacts are solved in turns
    bool is_of_crowd = false;   ///< whether the world has a crowd of mechanisms
    bool pushes_twice = false;  ///< whether a solve takes as much from overlaps as two would
    /// The bundles of a turn.
    Bundles near_turns() const { return turns.are_known() ? Bundles::near_turns : Bundles::all; }
    /// Velocities of now: `sweep_restless` goes by what has changed since.
    void begin_restless(const BodyRecords<Real>& records) {
        if (manifolds.is_crowd()) pieces_.remember(records.velocity);
    }
    /// Sweeps once over pieces of paths around bodies whose velocities have changed by more than `least`
    /// [m/s] since `begin_restless`, or since it was called last.
    /// @return whether it did: not where contacts are few, where those of such bodies are many, where paths
    /// are short anyhow, or with rolling resistance
    bool sweep_restless(const SubstepTerms& terms, BodyRecords<Real>& records, const StepLoops<Real>& loops,
                        Real least);
    /// Hides a contact from `solve` until `unhide`: it is to have an impact in a later substep.
    void hide(const PathContact<Real>& contact) {
        hidden_.push_back({static_cast<std::size_t>(&contact.link - links_.data()), contact.lane,
                           contact.link.separation1[contact.lane], contact.link.separation2[contact.lane]});
    }
    void unhide() { hidden_.clear(); }
    /// Contacts that come fast, a bit for each lane of each link.
    struct FastContacts {
        std::span<const std::uint32_t> may_meet, comes;  // in the substep; surely fast, and surely not yet
    };
    /// Tells which contacts have a point that comes faster than `speed` [m/s] and do not press by more than a
    /// share of what would stop their bodies, or may by rounding or what joints hold.
    /// @param sure_speed  m/s: what comes faster is fast whatever joints hold
    /// @param velocity  [rows][4], as records have them, of the start of the substep
    FastContacts find_fast(Column<Real>& velocity, double speed, double sure_speed, double light_press,
                           const SubstepTerms& terms, BodyRecords<Real>& records,
                           const StepLoops<Real>& loops);
    /// The place of a contact: kPathLanes times its link, plus its lane.
    std::size_t place_of(const PathContact<Real>& contact) const {
        return kPathLanes * static_cast<std::size_t>(&contact.link - links_.data()) + contact.lane;
    }
    using LoadPass = typename PathKernels<Real>::Pass PathKernels<Real>::*;
    /// Runs a pass of coarse correction (kernels/paths/path_loads.hpp) over all contacts.
    void run_loads(LoadPass pass, const PathLoads<Real>& loads, const SubstepTerms& terms,
                   BodyRecords<Real>& records, const StepLoops<Real>& loops);
    /// To be called when bodies may have become others, that move or do not: paths are cut anew.
    void forget_cut() { choice_.forget_cut(), turns.forget(); }
    /// Moves the surfaces of kinematic bodies on by a substep.
    void advance(const SubstepTerms& terms, BodyRecords<Real>& records);
    const PathRolling<Real>& rolling() const { return rolling_; }
    /// To be called when impulses are those of substeps of another length, by this factor.
    void rescale(double factor) {
        if (factor == 1) return;
        manifolds.rescale(factor), rolling_.rescale(static_cast<Real>(factor));
        links_hold_ = false;
    }
    /// Calls fn(contact) for each PathContact of the step.
    template <class Fn>
    void for_each(const Fn& fn) const {
        for_each_of(0, manifolds.live().size(), fn);
    }
    /// The same for those with numbers first ... last - 1 among all of the step.
    template <class Fn>
    void for_each_of(std::size_t first, std::size_t last, const Fn& fn) const;
    /// The same for those with walls and edges, which come last.
    template <class Fn>
    void for_each_surface(const Fn& fn) const {
        const auto live = manifolds.live();
        std::size_t first = live.size();
        while (first > 0 && live[first - 1] < 0) --first;
        for_each_of(first, live.size(), fn);
    }
    /// The same for all with something that no impulse moves.
    template <class Fn>
    void for_each_unmoved(const Fn& fn) const {
        if (manifolds.live().empty()) return;
        for (const std::int32_t n : with_kinematic_)
            for_each_of(static_cast<std::size_t>(n), static_cast<std::size_t>(n) + 1, fn);
        for_each_surface(fn);
    }
    /// Takes the impulses back that contacts of some bodies have, and forgets them.
    /// @param is_of  [rows], not 0 for these bodies
    void take_back(const std::vector<std::uint8_t>& is_of, BodyRecords<Real>& records);
    /// Takes the impulses that contacts of some bodies have from velocities; contacts keep theirs.
    /// @param is_of  [rows], not 0 for these bodies  @param velocity  [rows][4], as records have them
    void take_from(const std::vector<std::uint8_t>& is_of, Column<Real>& velocity) const;
    /// Adds to the impulses of a contact [N s]: of its points, along its tangent. Velocities stay as they
    /// are.
    /// @param number  among all contacts of the step
    void add_impulses(std::size_t number, const std::array<double, 3>& more);
    /// Multiplies the impulses of each contact by share_of(row, row); velocities stay as they are.
    template <class ShareOf>
    void scale(const ShareOf& share_of);
    /// Keeps the impulses for the next step.
    void end(const Executor& executor);

    /// Whether all contacts of the step are along one path.
    bool is_single_path() const { return cut().paths() <= 1; }
    /// Whether the loops over the contacts of the last step are long enough for more than one thread.
    bool has_long_loops() const;

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.counters, self.manifolds, self.rolling_, self.choice_, self.turns);
        if constexpr (!std::is_const_v<Self>) self.links_hold_ = false;
    }

  private:
    using Pass = typename PathKernels<Real>::Pass;
    /// A contact that `solve` does not see, and its separations [m].
    struct Hidden {
        std::size_t link, lane;
        Real separation1, separation2;
    };

    SolvePaths<Real> arguments(const SubstepTerms& terms, BodyRecords<Real>& records);
    /// Bundles first ... last - 1.
    struct BundleRange {
        std::size_t first, last;
    };
    BundleRange share_of(std::size_t colour, std::size_t share, Bundles which) const;
    void find_shares();
    void run(Pass pass, SolvePaths<Real> arguments, const StepLoops<Real>& loops,
             Bundles which = Bundles::all);
    const PathCut& cut() const { return choice_.cut(); }
    /// Row of the body where a link begins.
    std::int32_t near_row(PathCut::Place place) const {
        const bool is_first = place.link == cut().first_link()[place.bundle];
        return is_first ? heads_[kPathLanes * place.bundle + place.lane]
                        : links_[place.link - 1].body[place.lane];
    }
    /// Calls fn() while the contacts that are hidden have no points.
    template <class Fn>
    void without_hidden(const Fn& fn);
    void solve(SolvePaths<Real> arguments, BodyRecords<Real>& records, const StepLoops<Real>& loops,
               int passes, int turns_of_rolling, bool sweeps, Bundles which);
    void solve_watched(const SolvePaths<Real>& arguments, const StepLoops<Real>& loops, Bundles which,
                       bool has_floors);
    void lay_out(const WorldState<Real>& world, const EdgeCandidates<Real>& edges, const SubstepTerms& terms,
                 BodyRecords<Real>& records, const StepLoops<Real>& loops);
    void name_rows(const WorldState<Real>& world, const BodyRecords<Real>& records,
                   const StepLoops<Real>& loops);
    /// Row of the body where the path that begins with a live contact begins.
    std::int32_t head_row(std::int32_t first) const;
    void lay_out_padding(const StepLoops<Real>& loops);
    void fill_links(bool found, const WorldState<Real>& world, const BodyRecords<Real>& records,
                    const StepLoops<Real>& loops);
    void carry_links(const SubstepTerms& terms, BodyRecords<Real>& records, const StepLoops<Real>& loops);
    void move_still_rows(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                         const SubstepTerms& terms, BodyRecords<Real>& records);

    PathRolling<Real> rolling_;
    TurningEdges<Real> turning_edges_;
    std::vector<std::int32_t> row_of_far_;             // of each contact: the row of b in the records
    Column<std::uint32_t> closing_, is_fast_, comes_;  // kernels/paths/path_arguments.hpp
    PathChoice<Real> choice_;
    Column<PathLink<Real>> links_;
    std::vector<Hidden> hidden_;
    std::vector<std::size_t> first_of_share_;  // bundle, [colours][shares + 1]
    std::size_t shares_ = 1;                   // of a colour
    bool links_hold_ = false;  // they are laid out as the cut says, with what the step before left
    std::vector<std::int32_t> with_kinematic_;  // contacts of two bodies, one of which is kinematic
    Column<std::int32_t> heads_;
    // Rows in the records of padding and of what nothing moves.
    std::size_t first_still_row_ = 0, still_rows_ = 0;
    Column<Real> restless_;  // m/s, kernels/paths/path_arguments.hpp
    Column<std::byte> scratch_;
    PathPieces<Real> pieces_;
    std::vector<typename PathPieces<Real>::Ends> ends_;  // scratch: of contacts
};

template <class Real>
template <class Fn>
void PathSolver<Real>::for_each_of(std::size_t first, std::size_t last, const Fn& fn) const {
    const auto live = manifolds.live();
    for (std::size_t n = first; n < last; ++n) {
        const ManifoldList<Real>& list = manifolds.list_of(live[n]);
        const std::size_t i = Manifolds<Real>::place_of(live[n]);
        const typename PathCut::Place place = cut().places()[n];
        fn(PathContact<Real>{links_[place.link], place.lane, near_row(place),
                             links_[place.link].body[place.lane], Partner(list.b[i]),
                             static_cast<double>(list.restitution[i])});
    }
}

template <class Real>
void PathSolver<Real>::add_impulses(std::size_t number, const std::array<double, 3>& more) {
    const PathCut::Place place = cut().places()[number];
    PathLink<Real>& link = links_[place.link];
    link.normal1[place.lane] += static_cast<Real>(more[0]);
    link.normal2[place.lane] += static_cast<Real>(more[1]);
    link.tangent[place.lane] += static_cast<Real>(more[2]);
}

template <class Real>
void PathSolver<Real>::take_back(const std::vector<std::uint8_t>& is_of, BodyRecords<Real>& records) {
    take_from(is_of, records.velocity);
    const auto is_theirs = [&](std::int32_t row) { return is_of[static_cast<std::size_t>(row)] != 0; };
    scale([&](std::int32_t near, std::int32_t far) { return is_theirs(near) || is_theirs(far) ? 0 : 1; });
}

template <class Real>
template <class ShareOf>
void PathSolver<Real>::scale(const ShareOf& share_of) {
    if (manifolds.live().empty()) return;  // then the cut is that of an earlier step
    for (const PathCut::Place place : cut().places()) {
        PathLink<Real>& link = links_[place.link];
        const auto share = static_cast<Real>(share_of(near_row(place), link.body[place.lane]));
        for (Real* impulse :
             {&link.normal1[place.lane], &link.normal2[place.lane], &link.tangent[place.lane]})
            *impulse = share > 0 ? share * *impulse : Real(0);
    }
    rolling_.scale(share_of);
}

template <class Real>
template <class Fn>
void PathSolver<Real>::without_hidden(const Fn& fn) {
    const auto none = static_cast<Real>(kNoPoint);
    for (const Hidden& h : hidden_)
        links_[h.link].separation1[h.lane] = links_[h.link].separation2[h.lane] = none;
    fn();
    for (const Hidden& h : hidden_) {
        links_[h.link].separation1[h.lane] = h.separation1;
        links_[h.link].separation2[h.lane] = h.separation2;
    }
}

extern template class PathSolver<float>;
extern template class PathSolver<double>;

}  // namespace carom
