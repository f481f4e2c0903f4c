#pragma once

#include <carom/accuracy.hpp>
#include <carom/profile.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "broadphase/candidates.hpp"
#include "isa/kernel_table.hpp"
#include "parallel/executor.hpp"
#include "parallel/interruption.hpp"
#include "stages/stage.hpp"
#include "stages/stage_observer.hpp"
#include "state/columns/archive.hpp"
#include "state/columns/chunked_list.hpp"
#include "state/world_state.hpp"

namespace carom {

/// What is told of a stage: its line of the step, whether the next step runs it, how often it ran and how
/// long it took since the world was made.
struct StageState {
    std::string_view name, reads, writes;
    KernelChoice kernel;
    bool is_called_for;
    StageTimes::Entry time;
};
using StageVisitor = const std::function<void(const StageState&)>&;

/// A running world: its state, its candidate pairs, and the solver that steps it. Each solver adds what it
/// alone needs; nothing of one solver is in another. The stages of a solver work on its simulation, in the
/// order of step/impulse_step.cpp, step/soft_step.cpp or step/event_step.cpp.
template <class Real>
class Simulation {
  public:
    virtual ~Simulation() = default;
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    virtual Solver solver() const = 0;
    /// Advances by dt [s], > 0 and within the limits, or by less if `interruption` says so: then the state is
    /// that of the new time, or of the old one, whole.
    virtual void step(double dt) = 0;
    /// The same step, which `observer` looks at stage by stage.
    virtual void step_observed(double dt, StageObserver& observer) = 0;
    /// Whether a step has loops that are worth several threads.
    virtual bool has_long_loops() const = 0;

    // Between steps.

    /// To be called when rows, masses or laws have changed outside of a step.
    virtual void forget_derived_state() = 0;
    /// To be called when a row came.
    virtual void note_added(std::size_t) { forget_derived_state(); }
    /// To be called when the velocity of a row was changed.
    virtual void note_velocity(std::size_t) { forget_derived_state(); }
    /// To be called before a row is put elsewhere, and after.
    virtual void note_place_before(std::size_t) {}
    virtual void note_place(std::size_t) { forget_derived_state(); }
    /// Takes a row out of the world.
    virtual void remove(std::size_t row);
    /// What the bodies are now, the solver cannot do. @throws Error, which `where` opens
    virtual void check_bodies(std::string_view where);
    /// Wakes the islands of all sleepers that something within `reach` [m] of `place` touches.
    virtual void wake_at(Vec2 place, double reach);
    /// Wakes all sleepers: segments and chains may touch anything.
    virtual void wake_all();
    /// Wakes the island of a row, if it sleeps. @return the row it has then
    virtual std::size_t wake_body(std::size_t row);

    /// Sweeps over the contacts a substep, where the solver does any. @param wanted  >= 1; none: its own
    virtual void set_iterations(std::optional<int> wanted);

    // Reports.

    /// Substeps of a step that joints call for, and how they are solved, in words; empty without joints.
    virtual int substeps_for_joints() const { return 1; }
    virtual std::string describe_joints() const { return {}; }
    /// Those sweeps; 1 for a solver that does none.
    virtual int iterations() const { return 1; }
    /// Adds what the solver has counted.
    virtual void report(Profile& profile) const = 0;
    /// Calls visit for each of its stages, in the order of the step.
    virtual void report_stages(StageVisitor visit) const = 0;
    /// Memory that it holds now.
    virtual std::size_t bytes() const;

    // Its state as bytes (state/columns/archive.hpp).

    virtual void visit_state(StateSize& archive) const = 0;
    virtual void visit_state(StateWriter& archive) const = 0;
    virtual void visit_state(StateReader& archive) = 0;

    WorldState<Real> world;
    Candidates<Real> candidates;
    Executor executor;
    Interruption interruption;
    const KernelTable<Real>* kernels = nullptr;
    int substeps_asked_for = 1;           ///< strong drag can make a step take more
    bool has_asked_for_substeps = false;  ///< else they are the solver's own number
    StageTimes times;
    std::int64_t step_count = 0;

    // The present flight is what the broadphase looks ahead. Solver `impulse` takes one a substep, `soft`
    // one a step.
    double flight_dt = 0;               ///< s
    double fastest = 0;                 ///< m/s, at its start, of all bodies
    std::vector<double> chunk_fastest;  ///< m²/s², by chunk
    std::vector<std::int32_t> displaced, lost;
    ChunkedList displaced_rows, lost_rows;
    std::vector<std::int32_t> row_order;   ///< while rows are sorted
    std::size_t immovable_when_asked = 0;  ///< when it was asked how many bodies stand

    /// Parts that strong drag needs a flight of dt [s] to be cut into, or that were asked for, if those are
    /// more.
    /// @param flights  of equal length in a step
    int substeps_for_drag(double dt, int flights = 1) const;
    /// Whether anything can move, on its own or because something else does.
    bool has_anything_to_move() const;
    /// Whether two things are there that can touch.
    bool can_meet() const {
        return (world.bodies.rows() > 1 && !(world.bodies.common_group < 0)) || world.effects.walls;
    }

  protected:
    /// What is of every solver.
    template <class Self, class Archive>
    static void visit_common(Self& self, Archive& archive) {
        archive(self.world, self.candidates, self.step_count);
        if constexpr (!std::is_const_v<Self>) self.candidates.use(*self.kernels);
    }
    explicit Simulation(MarginRule rule) : candidates(rule) {}
};

extern template class Simulation<float>;
extern template class Simulation<double>;

}  // namespace carom
