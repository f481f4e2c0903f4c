#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "kernels/paths/path_system.hpp"
#include "kernels/paths/sweep_paths.hpp"

// Paths whose active set does not settle as a whole. They are few in a batch, and what is done for them takes
// longer than all that was done before, so they leave their batches and share one.
// docs/decisions/0094-unsettled-paths.md has the measurements.

namespace carom {
namespace {

/// Iterations of the active set of a piece.
constexpr int kIterationsOfPiece = 12;

/// What does not settle as a whole may in pieces: first those that begin with the path, then those that begin
/// half a piece later, across the ends of the first.
/// @return lanes in which some piece did not
template <class Lanes, class Real>
typename Lanes::Mask solve_in_pieces(const PathBatch<Real>& p, LinkScratch<Lanes>* scratch,
                                     typename Lanes::Mask where) {
    const SolvePaths<Real>& k = p.k;
    auto bad = where;
    typename Lanes::Batch restless;
    for (const std::size_t shift : {std::size_t{0}, kPiece / 2}) {
        bad = bad & (!bad);  // none yet
        for (std::size_t from = 0; from < p.length;) {
            const std::size_t to = from == 0 && shift > 0 ? shift : from + kPiece;
            const std::size_t length = (to < p.length ? to : p.length) - from;
            const PathBatch<Real> piece{k, p.link + from, length, p.lane, p.near_rows(from)};
            bad = bad | solve_exactly<Lanes>(piece, scratch, kIterationsOfPiece, where, restless);
            from += length;
        }
    }
    return bad;
}

/// Paths whose active set did not settle: they are solved in pieces where that is asked for, then swept.
template <class Lanes, class Real>
void solve_unsettled(const PathBatch<Real>& p, LinkScratch<Lanes>* scratch, typename Lanes::Mask bad) {
    if (p.k.tries_pieces) bad = solve_in_pieces<Lanes>(p, scratch, bad);
    if (!simd::any(bad)) return;
    for (int i = 0; i < p.k.sweeps_of_unsettled; ++i) sweep_paths<Lanes>(p, i % 2 == 0, bad);
}

/// Paths that did not settle, a lane each, which are solved when they are a batch. Lanes do not know of each
/// other, so the bits are those that each would have in its own batch.
template <class Lanes, class Real>
class UnsettledPaths {
  public:
    /// @param scratch  of the kernel: free whenever `add` or `finish` is called
    /// @param links  room for as many as the longest path has
    UnsettledPaths(const SolvePaths<Real>& k, LinkScratch<Lanes>* scratch, PathLink<Real>* links)
        : k_(k), scratch_(scratch), links_(links) {}

    /// Adds the lanes of a batch that are set in `bad`, and solves those that there are if they become a
    /// batch.
    void add(const PathBatch<Real>& p, unsigned bad) {
        if (p.length != length_) finish(), length_ = p.length;
        for (; bad != 0; bad &= bad - 1) {
            const std::size_t lane = p.lane + static_cast<std::size_t>(std::countr_zero(bad));
            copy(p.link, lane, links_, count_);
            heads_[count_] = p.head[lane - p.lane], from_[count_] = {p.link, lane};
            if (++count_ == Lanes::size) solve();
        }
    }

    /// Solves what is left.
    void finish() {
        if (count_ == 0) return;
        // Lanes that are free repeat the first one, and come to the same.
        for (std::size_t lane = count_; lane < Lanes::size; ++lane)
            copy(links_, 0, links_, lane), heads_[lane] = heads_[0];
        solve();
    }

  private:
    /// Copies a lane of each link.
    void copy(const PathLink<Real>* from, std::size_t from_lane, PathLink<Real>* to, std::size_t to_lane) {
        for (std::size_t i = 0; i < length_; ++i)
            for_each_column(from[i], to[i],
                            [&](const auto* of, auto* here) { here[to_lane] = of[from_lane]; });
    }

    void solve() {
        solve_unsettled<Lanes>(PathBatch<Real>{k_, links_, length_, 0, heads_}, scratch_, F(0) <= F(0));
        for (std::size_t lane = 0; lane < count_; ++lane)
            for (std::size_t i = 0; i < length_; ++i) {
                PathLink<Real>& link = from_[lane].link[i];
                link.normal1[from_[lane].lane] = links_[i].normal1[lane];
                link.normal2[from_[lane].lane] = links_[i].normal2[lane];
                link.tangent[from_[lane].lane] = links_[i].tangent[lane];
            }
        count_ = 0;
    }

    using F = typename Lanes::Batch;
    struct From {
        PathLink<Real>* link;  // the first of a path
        std::size_t lane;
    };

    const SolvePaths<Real>& k_;
    LinkScratch<Lanes>* scratch_;
    PathLink<Real>* links_;
    std::int32_t heads_[kPathLanes]{};
    From from_[Lanes::size];
    std::size_t count_ = 0, length_ = 0;
};

}  // namespace
}  // namespace carom
