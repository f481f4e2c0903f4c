#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "stages/stage_times.hpp"

namespace carom {

/// What the code of a stage was chosen by, for `carom explain`.
enum class KernelChoice : std::uint8_t {
    none,        ///< there is one text
    isa,         ///< the instruction set
    radius,      ///< the instruction set; one radius for all or one a body
    contacts,    ///< the same, and the effects that act in contacts
    scalar_f64,  ///< scalar, in double precision whatever the columns have
};

/// A line of the step: what runs, when a scene calls for it, and what it touches. The step, `explain`, the
/// stopwatch and docs/how-a-step-works.md read the same lists, one a solver: step/*_step.cpp.
template <class Sim>
struct Stage {
    std::string_view name;
    void (*run)(Sim&);
    bool (*is_called_for)(const Sim&);
    KernelChoice kernel;
    std::string_view reads, writes;
};

/// Runs those of `stages` that are called for, in order. `first` is the number of the first among all stages
/// of the solver.
/// @param watch  the stopwatch, or a StageObserver
template <class Sim, class Watch, std::size_t kCount>
void run_stages(const Stage<Sim> (&stages)[kCount], std::size_t first, Sim& sim, Watch& watch) {
    for (std::size_t i = 0; i < kCount; ++i) {
        if (!stages[i].is_called_for(sim)) continue;
        watch.begin(first + i);
        stages[i].run(sim);
        watch.lap(first + i);
    }
}

/// The same, but the step may end before the first and within each of them. @return false if it did
/// Inlined into the step, so that the compiler knows which stages there are: .7 % of a step of 30 discs.
template <class Sim, class Watch, std::size_t kCount>
[[gnu::always_inline]] inline bool run_interruptible(const Stage<Sim> (&stages)[kCount], std::size_t first,
                                                     Sim& sim, Watch& watch) {
    if (sim.interruption.is_due_after(kCount * sim.world.bodies.count)) return false;
    for (std::size_t i = 0; i < kCount; ++i) {
        if (!stages[i].is_called_for(sim)) continue;
        watch.begin(first + i);
        stages[i].run(sim);
        watch.lap(first + i);
        if (sim.interruption.has_stopped()) return false;
    }
    return true;
}

}  // namespace carom
