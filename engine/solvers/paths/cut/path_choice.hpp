#pragma once

#include <cstdint>
#include <vector>

#include "solvers/manifolds/manifolds.hpp"
#include "solvers/paths/cut/path_cut.hpp"
#include "solvers/paths/cut/turn_rows.hpp"
#include "state/world_state.hpp"

namespace carom {

/// How paths are solved: what has settled, what settles, and where contacts come and go.
enum class PathMood : std::uint8_t { calm, restless, wild };

/// Which contacts of a step are in paths and which stand beside them, and when contacts are cut into paths
/// anew. docs/decisions/0043-contacts-beside-paths.md.
template <class Real>
class PathChoice {
  public:
    /// What a choice has changed: nothing, which contacts there are in the paths, or the paths.
    enum class Change : std::uint8_t { none, contacts, paths };

    /// Chooses for a step.
    /// @param is_same    whether the contacts are those of the step before
    /// @param unsettled  paths whose active set did not settle in the step before
    /// @param turns  bodies whose contacts are solved in turns; paths are cut for them
    /// @param is_of_crowd  whether the world has a crowd of mechanisms
    Change choose(const WorldState<Real>& world, Manifolds<Real>& manifolds, double dt, bool is_same,
                  std::int64_t unsettled, TurnRows& turns, bool is_of_crowd, const Executor& executor);
    /// To be called with the number of paths that were solved.
    void note_solved(std::int64_t paths) { solved_ += paths; }
    /// To be called when bodies may have become others, that move or do not: paths are cut anew.
    void forget_cut() { is_cut_forgotten_ = true; }

    const PathCut& cut() const { return cut_; }
    /// The mood for which the paths were cut.
    PathMood mood_of_cut() const { return mood_of_cut_; }

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.cut_, self.since_cut_, self.solved_, self.mood_, self.mood_of_cut_,
                self.is_cut_forgotten_);
    }

  private:
    void judge_mood(const Manifolds<Real>& manifolds, std::int64_t unsettled);
    bool is_wild_crowd(const Manifolds<Real>& manifolds) const;
    void cut_paths(const WorldState<Real>& world, Manifolds<Real>& manifolds, double dt, TurnRows& turns,
                   const Executor& executor);
    bool keep_paths(const WorldState<Real>& world, Manifolds<Real>& manifolds, const TurnRows& turns,
                    double most);

    PathCut cut_;
    int since_cut_ = 0;              // steps
    bool is_cut_forgotten_ = false;  // by the next step it is made anew
    std::int64_t solved_ = 0;        // paths, in the substeps of the last step
    PathMood mood_ = PathMood::calm, mood_of_cut_ = PathMood::calm;
    // Scratch of `choose`.
    std::vector<ContactLink> contact_links_;
    std::vector<PathCut::Slot> slots_;
};

extern template class PathChoice<float>;
extern template class PathChoice<double>;

}  // namespace carom
