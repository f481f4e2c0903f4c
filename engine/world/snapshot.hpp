#pragma once

#include <carom/scene.hpp>

#include <cstddef>
#include <optional>
#include <span>

#include "scene/call_effects.hpp"
#include "scene/choose_solver.hpp"
#include "solvers/shared/simulation.hpp"

namespace carom {

/// What a world was asked for, and what it answered: it bears on what calls between steps do.
struct WorldSettings {
    CalledEffects called;
    EffectOverrides overrides;  ///< of the scene and of the options
    double angular_drag = 0;    ///< 1/s, of the scene; in force once something turns
    Solver asked_for = Solver::automatic;
    SolverFacts facts;                        ///< of all bodies there ever were
    std::optional<int> substeps, iterations;  ///< that were asked for
};

// A snapshot is a header and the state as archives list it (state/columns/archive.hpp), for programs of the
// same build.

/// Its bytes. Cost: O(columns).
template <class Real>
std::size_t snapshot_bytes(const Simulation<Real>& sim, const WorldSettings& settings);

/// @throws Error (out_of_range) if there is not room for it; nothing is written then
template <class Real>
void save_snapshot(const Simulation<Real>& sim, const WorldSettings& settings, std::span<std::byte> out);

/// The solver of the world that was saved.
/// @throws Error (malformed, inconsistent) if the bytes are no snapshot, are damaged, or are of another
/// precision or version
template <class Real>
Solver solver_of_snapshot(std::span<const std::byte> state);

/// @param state  that solver_of_snapshot has accepted, of the solver that `sim` has
template <class Real>
void restore_snapshot(Simulation<Real>& sim, WorldSettings& settings, std::span<const std::byte> state);

extern template std::size_t snapshot_bytes(const Simulation<float>&, const WorldSettings&);
extern template std::size_t snapshot_bytes(const Simulation<double>&, const WorldSettings&);
extern template void save_snapshot(const Simulation<float>&, const WorldSettings&, std::span<std::byte>);
extern template void save_snapshot(const Simulation<double>&, const WorldSettings&, std::span<std::byte>);
extern template Solver solver_of_snapshot<float>(std::span<const std::byte>);
extern template Solver solver_of_snapshot<double>(std::span<const std::byte>);
extern template void restore_snapshot(Simulation<float>&, WorldSettings&, std::span<const std::byte>);
extern template void restore_snapshot(Simulation<double>&, WorldSettings&, std::span<const std::byte>);

}  // namespace carom
