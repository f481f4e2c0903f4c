#pragma once

#include "parallel/executor.hpp"
#include "solvers/manifolds/manifold_list.hpp"
#include "solvers/manifolds/piece_items.hpp"
#include "solvers/manifolds/pose_watch.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/column.hpp"
#include "state/world_state.hpp"

namespace carom {

/// A contact whose load alone would move the lighter body by more than this in a step, in thicknesses, is not
/// looked for ahead: what swings so fast the steps cannot follow, and its velocity is noise.
inline constexpr double kLargestWayOfLoad = 0.25;

/// Whether a contact is looked for ahead: if it has no friction, which would hold what swings, and presses,
/// but not so hard. What does not press may be an impact.
/// @param friction  coefficient of the contact
/// @param mass      kg, of the lighter body
template <class Real>
bool looks_ahead(const ManifoldMemory<Real>& memory, Real friction, Real thickness, Real mass,
                 const SubstepTerms& terms) {
    if (friction > 0) return false;
    const Real load = memory.normal1 + memory.normal2;
    const auto way = static_cast<Real>(terms.dt * terms.dt / terms.substep_dt) * load;  // kg m
    return load > 0 && way < static_cast<Real>(kLargestWayOfLoad) * thickness * mass;
}

/// Where bodies will be at the end of the step if they go on as they fly: there contacts are found.
///
/// A contact keeps its normal and its arms over a step. Were they those of its start, forces would lag behind
/// what bodies do by half a step, and whatever swings about a place where it could rest, like a smooth box
/// that hangs in a gap by two of its sides, would gain energy from nothing: its swing grows as
/// exp(w² dt t / 4), at w = 6 / s and 60 steps a second by 4.5 times in ten seconds. With those of the end
/// swings fade as fast. docs/decisions/0057-contacts-ahead.md.
///
/// Cost: about 15 ns a body, where some surface has no friction.
template <class Real>
class PosesAhead {
  public:
    // These columns hold the items of PieceItems as they are now, then the same items ahead.
    Column<Real> pose;           ///< [2 items()][4]: x, y [m], cosine, sine of the angle
    Column<Real> come;           ///< [2 items()][4]: m in x and y, rad from now on; s, how far ahead that is
    Column<std::int32_t> shape;  ///< [2 items()], number in the ShapeStore

    /// Reads the poses at the start of a step, unless every contact has friction.
    /// @param dt  s, of the step
    void look(const WorldState<Real>& world, double dt, const PoseWatch<Real>& now,
              const PieceItems<Real>& pieces, const Executor& executor);
    /// Whether every contact has friction, so that nothing is looked for ahead in this step.
    bool empty() const { return items_ == 0; }
    std::int32_t items() const { return items_; }
    /// How far ahead a row is [s].
    double time(std::size_t row) const {
        return static_cast<double>(come[4 * (static_cast<std::size_t>(items_) + row) + 3]);
    }

    std::size_t bytes() const { return pose.bytes() + come.bytes() + shape.bytes(); }

  private:
    void look_at(const Bodies<Real>& bodies, Real dt, const PoseWatch<Real>& now, std::size_t row);

    std::int32_t items_ = 0;
};

extern template class PosesAhead<float>;
extern template class PosesAhead<double>;

}  // namespace carom
