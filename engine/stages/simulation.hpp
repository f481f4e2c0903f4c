#pragma once

#include <carom/accuracy.hpp>

#include <cstdint>
#include <vector>

#include "broadphase/candidates.hpp"
#include "isa/kernel_table.hpp"
#include "parallel/executor.hpp"
#include "solver/event/event_dynamics.hpp"
#include "solver/impulse.hpp"
#include "world/world_state.hpp"

namespace carom {

/// Lists that chunks of a kernel write side by side, each into its own part, and that are then joined in
/// order.
class ChunkedList {
  public:
    /// Room for `rows` in chunks of `rows_per_chunk`, and a batch more for each.
    void prepare(std::size_t rows, std::size_t rows_per_chunk) {
        const std::size_t chunks = (rows + rows_per_chunk - 1) / rows_per_chunk;
        stride_ = padded(rows_per_chunk) + kRowPadding;
        numbers_.resize_for_overwrite(chunks * stride_);
        counts_.assign(chunks, 0);
    }
    std::int32_t* part(std::size_t chunk) { return numbers_.data() + chunk * stride_; }
    void set_count(std::size_t chunk, std::size_t count) { counts_[chunk] = count; }

    /// Calls fn(number) for everything listed, below `limit`: padding rows may be listed too.
    template <class Fn>
    void for_each_below(std::size_t limit, const Fn& fn) const {
        for (std::size_t c = 0; c < counts_.size(); ++c)
            for (std::size_t n = 0; n < counts_[c]; ++n)
                if (const auto number = numbers_[c * stride_ + n]; static_cast<std::size_t>(number) < limit)
                    fn(number);
    }

    std::size_t bytes() const { return numbers_.bytes() + counts_.capacity() * sizeof(std::size_t); }

  private:
    Column<std::int32_t> numbers_;
    std::vector<std::size_t> counts_;
    std::size_t stride_ = 0;
};

/// All a running world consists of. The stages of this folder work on it, in the order that step.cpp states.
template <class Real>
struct Simulation {
    WorldState<Real> world;
    Candidates<Real> candidates;
    ImpulseSolver<Real> solver;
    Executor executor;
    const KernelTable<Real>* kernels = nullptr;
    Solver method = Solver::impulse;       ///< never `automatic`
    EventDynamics events;                  ///< of solver `event`
    std::vector<std::int32_t> event_rows;  ///< the world's rows it has; empty: they have changed
    int substeps = 1;                      ///< what was asked for; strong drag can make a step take more

    // Of the present substep.
    double h = 0;                       ///< s
    double fastest = 0;                 ///< m/s, at the start, of all bodies
    std::vector<double> chunk_fastest;  ///< m²/s², by chunk
    std::vector<std::int32_t> displaced;
    ChunkedList wall_rows, displaced_rows, lost_rows;
    std::vector<FoundMeeting> meetings;                     ///< that the solver has to look at
    std::vector<std::vector<FoundMeeting>> chunk_meetings;  ///< where chunks run on several threads
    std::vector<Real> immovable_spins;                      ///< rad/s, kept over the turn

    std::int64_t step_count = 0;

    /// To be called when rows, masses or laws have changed outside of a step.
    void forget_derived_state() {
        candidates.invalidate();
        solver.forget_contacts();
        solver.flights.accelerations.clear();
        event_rows.clear();
    }
};

}  // namespace carom
