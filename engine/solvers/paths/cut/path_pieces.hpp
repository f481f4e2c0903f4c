#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "isa/convex_kernels.hpp"
#include "kernels/paths/path_arguments.hpp"
#include "solvers/paths/cut/path_cut.hpp"
#include "state/columns/column.hpp"

namespace carom {

/// Pieces of paths around restless bodies, copied into bundles of their own: where a few of many contacts
/// have anything left to do, a turn sweeps these alone. Pieces of one colour share no body, so the kernels
/// sweep them as they sweep paths. docs/decisions/0098-turns-around-what-is-restless.md.
template <class Real>
class PathPieces {
  public:
    using Links = Column<PathLink<Real>>;
    /// Rows of both bodies of a contact.
    using Ends = std::array<std::int32_t, 2>;

    /// Contacts have become others, or their places.
    void forget() { first_at_.clear(); }
    /// Whether the contacts of each body are listed.
    bool knows_contacts() const { return !first_at_.empty(); }
    /// Lists them. Cost: about 5 ns a contact.
    /// @param ends  of each contact, in the order of `cut.places()`
    void list_contacts(const PathCut& cut, std::span<const Ends> ends, std::size_t rows);
    /// Velocities of now: what changes from now on is restless.
    void remember(const Column<Real>& velocity);

    /// Copies the pieces around bodies that have changed by more than `least` [m/s] since `remember`, and
    /// remembers velocities.
    /// @param heads  rows where paths begin
    /// @param still_row  a row that nothing moves
    /// @return whether these are so few that sweeping them alone is worth it; if not, there are none.
    /// Cost: 1 ns a body, about 20 ns a contact of a piece.
    bool gather(const PathCut& cut, const Column<Real>& velocity, std::size_t bodies, Real least,
                const Links& links, const Column<std::int32_t>& heads, std::int32_t still_row);
    /// Sweeps over all pieces once, contacts beside the paths before and behind, and writes impulses back.
    /// @param most  sweeps over contacts beside the paths, each time
    void sweep(SolvePaths<Real> arguments, const PathKernels<Real>& kernels, int most, Links& links);

    std::size_t bytes() const;

  private:
    /// Contacts that follow each other along a path.
    struct Piece {
        std::uint32_t link, length, bundle;  // in the cut
        std::uint32_t own_link;              // in the bundles of pieces
        std::uint8_t lane, own_lane;
    };

    bool mark_restless(const PathCut& cut, const Column<Real>& velocity, std::size_t bodies, Real least);
    void list_pieces(const PathCut& cut, std::size_t bundle);
    void lay_out(std::size_t first, const PathCut& cut, const Links& links,
                 const Column<std::int32_t>& heads);
    void sweep_beside(const SolvePaths<Real>& arguments, const PathKernels<Real>& kernels, int most,
                      bool has_floors) const;
    void write_back(Links& links) const;

    std::vector<std::uint32_t> first_at_;    // by row: its contacts, in slot_at_
    std::vector<std::uint32_t> slot_at_;     // kPathLanes times the link, plus the lane
    std::vector<std::uint32_t> is_contact_;  // by link: a bit for each lane that has a contact
    std::vector<std::uint32_t> marks_;       // likewise, that is in a piece
    std::vector<std::int32_t> restless_;     // rows
    Column<Real> remembered_;                // velocity records
    std::vector<Piece> pieces_;
    std::vector<std::size_t> first_link_{0}, first_bundle_{0};  // as PathCut has them
    std::vector<PathLink<Real>> links_;  // memory only grows: first_link_ has their number
    Column<std::int32_t> heads_;
    Column<std::uint32_t> closing_;
    PathLink<Real> padding_;  // a link without a contact
};

extern template class PathPieces<float>;
extern template class PathPieces<double>;

}  // namespace carom
