#pragma once

#include <carom/ledger.hpp>

#include <array>
#include <cstdint>
#include <vector>

#include "kernels/contacts/contact_arguments.hpp"
#include "solvers/substeps/body_masses.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/columns/chunked_list.hpp"
#include "state/world_state.hpp"

namespace carom {

/// What is asked of impulses: by how much velocities have more energy, or the work done while gravity acted.
enum class GainOf { velocities, work };

/// The bodies as contacts see them over the substeps of a step: velocities and displacements, one record a
/// body, and what free flight does to them between substeps. Rows beyond the bodies are for the padding of
/// contact groups: they stay at rest.
template <class Real>
class BodyRecords {
  public:
    Column<Real> velocity;      ///< [rows][4], kernels/contacts/contact_arguments.hpp
    Column<Real> displacement;  ///< [rows][2], m, since the start of the step

    /// Records at the start of a step, with the velocities that the first substep foresees.
    /// @param rows  to be written from the first on: all, or all but those of standing bodies if these are as
    /// they were in the last step
    /// @param padding_rows  rows beyond the bodies
    void begin(const WorldState<Real>& world, const Column<Real>& motion, const BodyMasses<Real>& masses,
               std::size_t rows, std::size_t padding_rows, const SubstepTerms& terms,
               const StepLoops<Real>& loops);
    /// What the impulses of this substep have added to the kinetic energy of all bodies, or the work that
    /// they did while gravity acted with them.
    EnergyGain gain(const SubstepTerms& terms, const StepLoops<Real>& loops, GainOf of = GainOf::velocities);
    /// Moves the bodies through the substep that was solved; foresees the next, unless it was the last.
    /// @param joined  [rows], above zero for bodies that have joints; null where there are none
    void advance(bool is_last, const SubstepTerms& terms, const StepLoops<Real>& loops, const Real* joined);
    /// Columns of bodies from records.
    /// @param lost_rows  room for `lost` by chunk
    /// @param lost  out: rows whose state left the limits; they stand still where they were
    void end(Bodies<Real>& bodies, ChunkedList& lost_rows, std::vector<std::int32_t>& lost,
             const StepLoops<Real>& loops);
    StartColumns<Real> start_columns();
    /// m, by row: rim displacement since the start of the step; null in worlds of discs without rotation.
    Real* turn() { return turn_.empty() ? nullptr : turn_.data(); }
    const Real* turn() const { return turn_.empty() ? nullptr : turn_.data(); }
    /// Rows behind all others, of bodies that nothing moves: at rest until the next `begin`.
    void add_still_rows(std::size_t rows);
    /// Changes the velocity of a body by dv [m/s] and du [m/s] of its rim at once: at the start of the
    /// substep, and at its end by what drag leaves of it, so that the next one does not foresee it.
    void add_velocity(std::int32_t row, Vec2 dv, double du, const SubstepTerms& terms);
    /// Such a change comes later in the substep: what it moves the body by until then is taken back.
    /// @param time  s, from the start of the substep
    void delay(std::int32_t row, Vec2 dv, double du, double time);
    /// Puts what was taken back off to `advance`: contacts see the bodies where the substep began.
    void put_off_delays();
    /// All rows, padding and such still ones included.
    std::size_t rows() const { return displacement.size() / 2; }
    /// Nothing of the last step is known any more.
    void forget() { count_ = 0; }

    /// Bodies, without padding; 0 before the first step.
    std::size_t count() const { return count_; }
    /// The first of these: those that may move.
    std::size_t moving() const { return moving_; }
    /// Where the body is at the end of the step, by its displacement [m].
    Vec2 end_of(std::size_t row, const StepFlight<Real>& flight) const {
        return flight.start_of(row) + Vec2{displacement[2 * row], displacement[2 * row + 1]};
    }
    /// Velocity at the start of the substep [m/s]: vx, vy, rim speed.
    std::array<double, 3> start_of_substep(std::int32_t row) const {
        const auto value = [i = static_cast<std::size_t>(row)](const Column<Real>& column) {
            return column.empty() ? 0 : static_cast<double>(column[i]);
        };
        return {value(start_x_), value(start_y_), value(start_rim_)};
    }
    /// Velocity after a substep of free flight [m/s]: vx, vy, rim speed.
    std::array<double, 3> free_flight(std::int32_t row, const SubstepTerms& terms) const {
        const auto [x, y, rim] = start_of_substep(row);
        return {terms.decay * x + terms.gravity_change.x, terms.decay * y + terms.gravity_change.y,
                terms.spin_decay * rim};
    }
    /// What a row that `end` lists as lost had by the books: the velocity that the impulses gave it, at the
    /// place where it stays.
    Sums sums_of_lost(const WorldState<Real>& world, std::size_t row) const;

    std::size_t bytes() const;

  private:
    bool has_rotation_ = false, comes_to_rest_ = false;
    std::size_t count_ = 0, moving_ = 0;
    Column<Real> turn_;                           // m, rim displacement since the start of the step
    Column<Real> start_x_, start_y_, start_rim_;  // m/s, velocities at the start of the substep
    std::vector<EnergyGain> gains_;               // by chunk of rows
    struct Delay {
        std::size_t row;
        std::array<Real, 3> by, before;  // m, displacement and that of the rim: what is taken, what was there
    };
    std::vector<Delay> delays_;  // of this substep
    std::array<Real*, 3> places_of(std::size_t row) {
        Real* const to = &displacement[2 * row];
        return {to, to + 1, has_rotation_ ? &turn_[row] : nullptr};
    }
};

extern template class BodyRecords<float>;
extern template class BodyRecords<double>;

}  // namespace carom
