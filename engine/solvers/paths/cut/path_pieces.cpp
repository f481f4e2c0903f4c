#include "solvers/paths/cut/path_pieces.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "narrowphase/convex.hpp"
#include "state/columns/index.hpp"

namespace carom {
namespace {

// docs/decisions/0098-turns-around-what-is-restless.md has the measurements behind these.

/// Contacts of a path before and behind those of restless bodies that are swept with them.
constexpr int kBeyond = 2;
/// Share of the contacts of a step beyond which pieces are not worth it.
constexpr double kMostRestless = 0.4;

}  // namespace

template <class Real>
void PathPieces<Real>::list_contacts(const PathCut& cut, std::span<const Ends> ends, std::size_t rows) {
    is_contact_.assign(cut.links(), 0);
    first_at_.assign(rows + 2, 0);
    for (const Ends& both : ends)
        for (const std::int32_t row : both) ++first_at_[index(row) + 2];
    for (std::size_t row = 2; row < first_at_.size(); ++row) first_at_[row] += first_at_[row - 1];
    slot_at_.resize(2 * ends.size());
    for (std::size_t n = 0; n < ends.size(); ++n) {
        const PathCut::Place& place = cut.places()[n];
        is_contact_[place.link] |= 1U << place.lane;
        for (const std::int32_t row : ends[n])
            slot_at_[first_at_[index(row) + 1]++] =
                static_cast<std::uint32_t>(kPathLanes * place.link + place.lane);
    }
}

template <class Real>
void PathPieces<Real>::remember(const Column<Real>& velocity) {
    remembered_.resize_for_overwrite(velocity.size());
    std::copy(velocity.begin(), velocity.end(), remembered_.begin());
}

/// Marks the contacts of restless bodies. @return whether they are few
template <class Real>
bool PathPieces<Real>::mark_restless(const PathCut& cut, const Column<Real>& velocity, std::size_t bodies,
                                     Real least) {
    restless_.clear();
    std::size_t contacts = 0;  // those between two such bodies twice
    for (std::size_t row = 0; row < bodies; ++row) {
        Real change = 0;  // the fourth number, a mass, stays
        for (std::size_t i = 4 * row; i < 4 * row + 4; ++i)
            change = std::max(change, std::abs(velocity[i] - remembered_[i]));
        if (!(change > least)) continue;
        restless_.push_back(static_cast<std::int32_t>(row));
        contacts += first_at_[row + 1] - first_at_[row];
    }
    if (static_cast<double>(contacts) > kMostRestless * static_cast<double>(slot_at_.size())) return false;
    marks_.assign(cut.links(), 0);
    for (const std::int32_t row : restless_)
        for (std::uint32_t k = first_at_[index(row)]; k < first_at_[index(row) + 1]; ++k)
            marks_[slot_at_[k] / kPathLanes] |= 1U << slot_at_[k] % kPathLanes;
    return true;
}

/// Lists the pieces of a bundle: contacts that are marked, and those beside them along their paths.
template <class Real>
void PathPieces<Real>::list_pieces(const PathCut& cut, std::size_t bundle) {
    const std::size_t first = cut.first_link()[bundle], last = cut.first_link()[bundle + 1];
    if (std::all_of(&marks_[first], &marks_[first] + (last - first), [](std::uint32_t m) { return m == 0; }))
        return;
    for (int i = 0; i < kBeyond; ++i) {
        std::uint32_t before = 0;
        for (std::size_t link = first; link < last; ++link) {
            const std::uint32_t own = marks_[link], behind = link + 1 < last ? marks_[link + 1] : 0;
            marks_[link] = (before | own | behind) & is_contact_[link];
            before = own;
        }
    }
    std::array<std::uint32_t, kPathLanes> begin{};  // by lane: where its piece begins
    std::uint32_t before = 0;
    for (auto link = static_cast<std::uint32_t>(first); link <= last; ++link) {
        const std::uint32_t own = link < last ? marks_[link] : 0;
        for (std::uint32_t left = own & ~before; left != 0; left &= left - 1)
            begin[static_cast<std::size_t>(std::countr_zero(left))] = link;
        for (std::uint32_t left = before & ~own; left != 0; left &= left - 1) {
            const auto lane = static_cast<std::uint8_t>(std::countr_zero(left));
            pieces_.push_back({.link = begin[lane],
                               .length = link - begin[lane],
                               .bundle = static_cast<std::uint32_t>(bundle),
                               .own_link = 0,
                               .lane = lane,
                               .own_lane = 0});
        }
        before = own;
    }
}

/// Bundles of the pieces from `first` on, long ones first, so that those of a bundle are about as long as
/// each other.
template <class Real>
void PathPieces<Real>::lay_out(std::size_t first, const PathCut& cut, const Links& links,
                               const Column<std::int32_t>& heads) {
    std::stable_sort(pieces_.begin() + static_cast<std::ptrdiff_t>(first), pieces_.end(),
                     [](const Piece& p, const Piece& q) { return p.length > q.length; });
    for (std::size_t lead = first; lead < pieces_.size(); lead += kPathLanes) {
        const std::size_t begin = first_link_.back(), length = pieces_[lead].length;
        first_link_.push_back(begin + length);
        if (links_.size() < begin + length) links_.resize(begin + length);
        std::fill_n(&links_[begin], length, padding_);
        const std::size_t first_head = heads_.size();
        for (std::size_t lane = 0; lane < kPathLanes; ++lane) heads_.push_back(padding_.body[0]);
        for (std::size_t lane = 0; lane < kPathLanes && lead + lane < pieces_.size(); ++lane) {
            Piece& piece = pieces_[lead + lane];
            piece.own_link = static_cast<std::uint32_t>(begin);
            piece.own_lane = static_cast<std::uint8_t>(lane);
            heads_[first_head + lane] = piece.link == cut.first_link()[piece.bundle]
                                            ? heads[kPathLanes * piece.bundle + piece.lane]
                                            : links[piece.link - 1].body[piece.lane];
            for (std::size_t i = 0; i < piece.length; ++i)
                for_each_column(links[piece.link + i], links_[begin + i],
                                [&](const auto* of, auto* here) { here[lane] = of[piece.lane]; });
        }
    }
}

template <class Real>
bool PathPieces<Real>::gather(const PathCut& cut, const Column<Real>& velocity, std::size_t bodies,
                              Real least, const Links& links, const Column<std::int32_t>& heads,
                              std::int32_t still_row) {
    const bool are_few = mark_restless(cut, velocity, bodies, least);
    remember(velocity);
    if (!are_few) return false;
    pieces_.clear(), first_link_.assign(1, 0), first_bundle_.assign(1, 0), heads_.clear();
    padding_ = {};
    std::fill_n(padding_.body, kPathLanes, still_row);
    std::fill_n(padding_.separation1, kPathLanes, static_cast<Real>(kNoPoint));
    std::fill_n(padding_.separation2, kPathLanes, static_cast<Real>(kNoPoint));
    const auto add_bundles = [&](std::size_t begin, std::size_t end) {
        const std::size_t first = pieces_.size();
        for (std::size_t bundle = begin; bundle < end; ++bundle) list_pieces(cut, bundle);
        lay_out(first, cut, links, heads);
    };
    for (std::size_t colour = 0; colour < cut.colours(); ++colour) {
        add_bundles(cut.first_bundle()[colour], cut.first_bundle()[colour + 1]);
        first_bundle_.push_back(first_link_.size() - 1);
    }
    add_bundles(cut.first_watched(), cut.bundles());
    closing_.resize(first_link_.size() - 1);
    return true;
}

/// As PathSolver does it with those of all paths.
/// @param has_floors  whether they have the floors of the substep
template <class Real>
void PathPieces<Real>::sweep_beside(const SolvePaths<Real>& k, const PathKernels<Real>& kernels, int most,
                                    bool has_floors) const {
    const std::size_t begin = first_bundle_.back(), end = first_link_.size() - 1;
    for (int sweep = 0; sweep < most && begin < end; ++sweep) {
        (has_floors || sweep > 0 ? kernels.watch_again : kernels.watch)(k, begin, end);
        if (kernels.settle(k, begin, end).closing == 0) return;
    }
}

template <class Real>
void PathPieces<Real>::sweep(SolvePaths<Real> k, const PathKernels<Real>& kernels, int most, Links& links) {
    k.links = links_.data(), k.first_link = first_link_.data(), k.heads = heads_.data();
    k.closing = closing_.data(), k.resting_speed = 0;
    sweep_beside(k, kernels, most, false);
    for (std::size_t colour = 0; colour + 1 < first_bundle_.size(); ++colour)
        kernels.sweep(k, first_bundle_[colour], first_bundle_[colour + 1]);
    sweep_beside(k, kernels, most, true);
    write_back(links);
}

template <class Real>
void PathPieces<Real>::write_back(Links& links) const {
    for (const Piece& piece : pieces_)
        for (std::size_t i = 0; i < piece.length; ++i) {
            const PathLink<Real>& from = links_[piece.own_link + i];
            PathLink<Real>& to = links[piece.link + i];
            const auto give = [&](const Real* of, Real* here) { here[piece.lane] = of[piece.own_lane]; };
            give(from.normal1, to.normal1), give(from.normal2, to.normal2), give(from.tangent, to.tangent);
            give(from.floor1, to.floor1), give(from.floor2, to.floor2);
        }
}

template <class Real>
std::size_t PathPieces<Real>::bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return of(first_at_) + of(slot_at_) + of(is_contact_) + of(marks_) + of(restless_) + of(pieces_) +
           of(first_link_) + of(first_bundle_) + of(links_) + remembered_.bytes() + heads_.bytes() +
           closing_.bytes();
}

template class PathPieces<float>;
template class PathPieces<double>;

}  // namespace carom
