#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/candidates.hpp"
#include "solver/flights.hpp"
#include "state/bodies.hpp"

namespace carom {

/// Possible contacts of one kind, sorted by colour: no body that moves is in two contacts of a colour, so all
/// of a colour can be solved at once, by lanes or by threads, in any order, with the same bits. Each keeps
/// its impulses from step to step while its pair lives.
template <class Real>
struct ContactCandidates {
    Column<std::int32_t> a, b;      // rows; b < 0 is a wall (WallSide). Padding: the row after the last body
    Column<Real> normal_impulse;    // N s, of a substep
    Column<Real> friction_impulse;  // N s
    Column<Real> rolling_impulse;   // N s; empty without rolling resistance
    /// Colour c is [begin[c], begin[c] + count[c]); begin[c] is a multiple of kRowPadding.
    std::vector<std::size_t> begin, count;
    /// The last colour takes what found no other: its contacts may share bodies and are solved one by one.
    bool has_overflow = false;

    std::size_t colours() const { return begin.size(); }
    std::size_t bytes() const {
        return a.bytes() + b.bytes() + normal_impulse.bytes() + friction_impulse.bytes() +
               rolling_impulse.bytes();
    }
};

/// Which bodies can touch which, coloured, until the candidate pairs change.
///
/// Colouring is greedy in the order of the pairs, which depends on the input alone: 2 ns a pair. It is done
/// anew with the candidate pairs, because then the pairs change throughout; between rebuilds nothing is done.
template <class Real>
class ContactGraph {
  public:
    static constexpr std::size_t kColours = 64;  // one bit each of a word a body

    /// Takes the candidate pairs over. Contacts that were there before keep their impulses.
    void renew(const Candidates<Real>& candidates, const Bodies<Real>& bodies, const Walls* walls);

    // Rows have changed since `renew`, which must be called before the contacts are used again.

    /// Rows were sorted: new row i is the old row order[i].
    void follow_sorted_rows(const std::int32_t* order, std::size_t count);
    /// A body was removed; the last row took its place. Cost: O(rows) the first time since `renew`, then
    /// O(1).
    void follow_removed_row(std::size_t row, std::size_t last);

    ContactCandidates<Real> pairs;  ///< of two bodies that move, a < b
    ContactCandidates<Real>
        supports;  ///< of a body that moves and what nothing moves: walls, immovable bodies

    bool keeps_rolling = false;  ///< rolling impulses, too

    std::size_t bytes() const;

  private:
    struct Found {
        std::int32_t a, b;
        std::uint32_t colour;
        Real normal_impulse, friction_impulse;
    };
    struct Remembered {
        std::int32_t b;
        Real normal_impulse, friction_impulse;
    };

    std::size_t kept_rows();
    void rename_rows();
    void remember(std::size_t rows);
    void remember(const ContactCandidates<Real>& contacts);
    void recall(Found& found, std::vector<Real>& rolling) const;
    void list_walls(const Candidates<Real>& candidates, const Bodies<Real>& bodies, const Walls& walls);
    void sort_by_colour(std::vector<Found>& found, const std::vector<Real>& rolling,
                        ContactCandidates<Real>& sorted, std::int32_t dummy);

    std::vector<Found> found_pairs_, found_supports_;
    std::vector<std::uint64_t> colours_of_;  // a row, bit a colour
    std::vector<std::uint32_t> first_of_;    // place of a row's remembered contacts
    std::vector<Remembered> remembered_;
    // Rolling impulses beside the three lists above; empty unless they are kept.
    std::vector<Real> rolling_of_pairs_, rolling_of_supports_, remembered_rolling_;
    std::size_t rows_ = 0;               // at the last renewal
    std::vector<std::int32_t> old_row_;  // of each present row, or kGone; empty if nothing has moved
    std::vector<std::int32_t> spare_rows_;
};

extern template class ContactGraph<float>;
extern template class ContactGraph<double>;

}  // namespace carom
