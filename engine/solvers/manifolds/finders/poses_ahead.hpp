#pragma once

#include <optional>
#include <span>
#include <vector>

#include "parallel/executor.hpp"
#include "solvers/manifolds/list/manifold_list.hpp"
#include "solvers/manifolds/meetings/held_flights.hpp"
#include "solvers/manifolds/poses/piece_items.hpp"
#include "solvers/manifolds/poses/pose_watch.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/columns/column.hpp"
#include "state/world_state.hpp"

namespace carom {

/// How far ahead of the start of a step a contact is looked for: not at all, half of the step, all of it.
enum class Lead : std::uint8_t { none, half, whole };

/// Where bodies will be in the middle and at the end of the step if they go on as they fly: there contacts
/// that press are found.
///
/// A contact keeps its normal and its arms over a step. Were they those of its start, forces would lag behind
/// what bodies do by half a step, and whatever swings about a place where it could rest would gain energy
/// from nothing: its swing grows as exp(w² dt t / 4), at w = 6 / s and 60 steps a second by 4.5 times in ten
/// seconds. With those of the middle swings keep their energy, with those of the end they fade as fast.
/// - A contact with friction of something round, on which bodies roll, rock and swing (a roly-poly, a plank
///   on a disc), is found in the middle.
/// - A contact without friction is found at the end: a smooth box that hangs in a gap by two of its sides
///   would swing for ever, and a heap of them never rest.
/// - Other contacts with friction are found where they are: their friction holds what would swing.
/// docs/decisions/0057-contacts-ahead.md, 0066-what-rolls-keeps-its-energy.md.
///
/// Cost: about 15 ns a body and its contacts, where some surface has no friction or some shape is round.
template <class Real>
class PosesAhead {
  public:
    // These columns hold the items of PieceItems as they are now, then in the middle, then at the end.
    Column<Real> pose;           ///< [3 items()][4]: x, y [m], cosine, sine of the angle
    Column<Real> come;           ///< [3 items()][4]: m in x and y, rad from now on; s, how far ahead that is
    Column<std::int32_t> shape;  ///< [3 items()], number in the ShapeStore
    Column<std::int32_t> a, b;   ///< by contact of two bodies that place() has placed: where to find them

    /// Must be told when shapes have changed.
    void note_shapes(const ShapeStore<Real>& shapes);
    bool is_round(std::int32_t shape_number) const {
        return is_round_[static_cast<std::size_t>(shape_number)] != 0;
    }
    /// Reads the poses at the start of a step, unless every contact is found where it is.
    /// @param dt  s, of the step
    /// @param rows  whose places are asked for in this step; none: of all. Places of others mean nothing
    void look(const WorldState<Real>& world, double dt, const PoseWatch<Real>& now,
              const HeldFlights<Real>& flights, const PieceItems<Real>& pieces,
              std::optional<std::span<const std::int32_t>> rows, const Executor& executor);
    /// Whether every contact is found where it is in this step.
    bool empty() const { return items_ == 0; }

    /// Chooses how far ahead each body is looked for at walls and edges, from what pressed there.
    /// @param surfaces  contacts of the step before
    void look_at_surfaces(const WorldState<Real>& world, const SubstepTerms& terms,
                          const ManifoldList<Real>& surfaces);
    /// s, by row: how far ahead a body is looked for at walls and edges.
    std::span<const double> on_surfaces() const { return on_surfaces_; }

    /// Makes room for the places of so many contacts.
    void resize_places(std::size_t contacts);
    /// Chooses how far ahead each contact of a block of two bodies is looked for, and notes its places.
    /// @param first       of the block, a multiple of kRowPadding
    /// @param may_press   of its contacts, a bit each: those that could touch when they were found last, or
    /// all
    /// @return whether some are looked for ahead; if not, nothing is noted
    bool place(const WorldState<Real>& world, const SubstepTerms& terms, const ManifoldList<Real>& contacts,
               std::uint32_t may_press, std::size_t first);

    std::size_t bytes() const;

  private:
    /// Whether contacts may be found so far ahead in this step; if not, no poses are made.
    bool is_used(Lead lead) const {
        return lead == Lead::none || (lead == Lead::half ? some_are_round_ : some_are_smooth_);
    }
    void look_at(const Bodies<Real>& bodies, Real dt, const PoseWatch<Real>& now, std::size_t first,
                 std::size_t last);
    void move(const Bodies<Real>& bodies, std::size_t row, Lead lead, Real ahead);
    void hold(std::size_t row, Vec2 velocity);
    /// Friction so small that its mean is none has no poses at the end.
    Lead used_or_none(Lead lead) const { return is_used(lead) ? lead : Lead::none; }
    std::size_t place_of(std::size_t item, Lead lead) const {
        return item + static_cast<std::size_t>(lead) * items_;
    }

    std::vector<std::uint8_t> is_round_;  // by shape
    bool some_are_round_ = false, some_are_smooth_ = false;
    std::size_t items_ = 0;
    struct Layout {
        std::size_t rows = 0, items = 0;
        bool has_middle = false, has_end = false;
        friend bool operator==(const Layout&, const Layout&) = default;
    };
    Layout written_;  // of the columns, as they are
    std::vector<double> on_surfaces_;
};

extern template class PosesAhead<float>;
extern template class PosesAhead<double>;

}  // namespace carom
