#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace carom {

/// How many impacts a body may have in a step. A crowd that collapses has ever more of them, ever slower; a
/// dense gas has many that are as fast as others. So an impact costs the more the more energy it takes, and a
/// tenth if it is fast beside the step's fastest of the body; elastic ones are nearly free, but for the time
/// that they take: that of what joints hold is answered by all of its group.
/// docs/decisions/0022-impacts-in-soft.md has the measurements.
///
/// A light body that is caught between heavy ones rattles: it has thousands of elastic impacts, as many as
/// all others together. So a step has a number of impacts for all bodies, too, and where they have had more,
/// those lose their restitution that have had many times what a body has in the mean; an impact is one of the
/// lighter of its bodies. What is far away, or is struck by what rattles, keeps its own.
/// docs/decisions/0103-bodies-that-rattle.md.
class ImpactBudget {
  public:
    /// Nothing is spent yet. @param bodies  rows from zero on
    void begin_step(std::size_t bodies) {
        ++step_;
        bodies_ = std::max<std::size_t>(bodies, 1), impacts_ = 0, looks_ = 0;
        tallies_.resize(std::max(tallies_.size(), bodies));
    }
    /// Whether a body may still have restitution.
    bool has_enough(std::int32_t row) { return tally_of(row).spent < kBudget; }
    /// Whether it has had so many that it may be in a crowd that collapses.
    bool may_collapse(std::int32_t row) { return tally_of(row).spent > kCollapsing; }
    /// Whether it has to wait for the sweeps of the next substep.
    /// @param would_be_deep  whether it would be deep in what it hits by then
    bool is_exhausted(std::int32_t row, bool would_be_deep) {
        return tally_of(row).spent >= kBudget + (would_be_deep ? kOverdraftOfDeep : kOverdraft);
    }
    /// Counts looks at contacts of a body that was deflected.
    void look(std::size_t contacts) { looks_ += contacts; }
    /// Counts an impact. @param row  of the lighter body
    void count(std::int32_t row) {
        Tally& tally = tally_of(row);
        ++impacts_, ++tally.impacts, looks_ += kLooksOfOne;
        if (looks_ <= kLooksOfStep + kLooksOfBody * bodies_) return;
        const std::size_t usual = impacts_ / bodies_;
        if (tally.impacts > std::clamp(kRattling * usual, kFewestRattling, kMostImpacts))
            tally.spent = std::max(tally.spent, kBudget);
    }
    /// Takes the cost of an impact. @param speed  m/s, along the normal
    /// @param joints  that answer it
    void spend(std::int32_t row, double restitution, double speed, std::size_t joints) {
        Tally& tally = tally_of(row);
        const double time = 1 + kTimeOfJoint * static_cast<double>(joints);  // 1: that of free bodies
        if (!(tally.spent < kBudget)) restitution = 0;                       // that it has left
        double cost = std::fmin(1, kCostOfLoss * (1 - restitution)) + kCostOfOne * time;
        if (speed > kFastShare * static_cast<double>(tally.fastest)) cost *= kCostOfFast;
        if (tally.spent >= kBudget + kOverdraft) cost = std::fmax(cost, kCostOnCredit * time);
        tally.spent += static_cast<float>(cost);
        tally.fastest = std::max(tally.fastest, static_cast<float>(speed));
    }
    std::size_t bytes() const { return tallies_.capacity() * sizeof(Tally); }

  private:
    static constexpr float kBudget = 2;      // costs that a body may have and still bounce
    static constexpr float kCollapsing = 1;  // half of it: an impact that takes all of its energy
    /// Spent beyond the budget, on impacts without restitution.
    static constexpr float kOverdraft = 8;
    /// Likewise on those that would be deep, and the least that each of these costs of free bodies, however
    /// elastic it is: docs/decisions/0088-what-falls-on-heaps.md.
    static constexpr float kOverdraftOfDeep = 64;
    static constexpr double kCostOnCredit = 0.3;
    /// The cost for each unit of 1 - e, but at most 1; and what every impact costs besides.
    static constexpr double kCostOfLoss = 10, kCostOfOne = 0.002;
    /// What an impact takes longer by each joint that answers it, in times of an impact of free bodies.
    static constexpr double kTimeOfJoint = 4;
    /// Impacts of this share of the fastest are not those of a collapse: they cost less.
    static constexpr double kFastShare = 0.15, kCostOfFast = 0.1;

    /// Looks at contacts that a step has, and for each body, before what rattles is looked for, and those
    /// that an impact takes as long as, besides those at the contacts of its bodies. That is 4,096 impacts
    /// and 16 a body with 16 contacts: billiards of three bodies have 3,141 of them in a few steps (Galperin
    /// 2003), a dense gas a few a body.
    static constexpr std::size_t kLooksOfOne = 16;
    static constexpr std::size_t kLooksOfStep = std::size_t{1} << 17;
    static constexpr std::size_t kLooksOfBody = 512;
    /// A body rattles if it has more impacts than this times the mean of all, and than the fewest, in any
    /// case beyond the most: where few bodies are the mean is of what rattles.
    static constexpr std::size_t kRattling = 8;
    static constexpr std::size_t kFewestRattling = 1024;
    static constexpr std::size_t kMostImpacts = 2048;

    struct Tally {
        std::uint32_t step = 0;  // of the other three
        float spent = 0;
        float fastest = 0;  // m/s
        std::uint32_t impacts = 0;
    };
    Tally& tally_of(std::int32_t row) {
        Tally& tally = tallies_[static_cast<std::size_t>(row)];
        if (tally.step != step_) tally = {step_, 0, 0, 0};
        return tally;
    }

    std::vector<Tally> tallies_;
    std::uint32_t step_ = 0;
    std::size_t bodies_ = 1, impacts_ = 0, looks_ = 0;  // the latter two of the step so far
};

}  // namespace carom
