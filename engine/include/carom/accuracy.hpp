#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace carom {

/// How contacts are solved; docs/how-a-step-works.md says what each is for.
enum class Solver : std::uint8_t {
    automatic,  ///< what suits the scene; `World::plan()` says which and why
    pairwise,   ///< the naive loop over all pairs: `carom::Pairwise`, not a solver of `World`
    impulse,    ///< time of impact inside the step: bouncy, gas-like scenes
    soft,       ///< contacts at rest, friction, rotation, shapes, joints: piles and mechanisms
    rigid,      ///< not built yet
    event,      ///< from impact to impact at exact times: discs and walls, nothing at rest, no drag
    rattle,     ///< joints alone: mechanisms that touch nothing, solved to round-off
};

enum class Precision : std::uint8_t { single_, double_ };

/// What a scene asks for in accuracy. What is left out takes the solver's own default.
struct Accuracy {
    Solver solver = Solver::automatic;
    /// Parts a step is cut into, 1 ... 1024. By default `impulse` and `event` take 1, `rattle` 4, `soft` 4,
    /// 6 where joints are swept as a net, and more where bodies fall far for their size in a step.
    std::optional<int> substeps{};
    /// 1 ... 1024 sweeps over the contacts a substep, where the solver does sweeps: `soft`, 2 by default. The
    /// others do none and take nothing but 1; `auto` takes `soft` if more are asked for.
    std::optional<int> iterations{};
    Precision precision = Precision::single_;
};

/// The name a solver has in scene files and on the command line ("auto", "impulse", ...).
std::string_view name_of(Solver solver) noexcept;

/// The solver of that name, if there is one.
std::optional<Solver> solver_named(std::string_view name) noexcept;

}  // namespace carom
