#include "simulation/simulation.hpp"

#include <carom/errors.hpp>

namespace carom::tool {
namespace {

[[noreturn]] void refuse_states() {
    throw Error(ErrorCode::not_built_yet,
                "This engine saves and restores no states; the solvers of a World do. Take one of these.");
}

}  // namespace

void Simulation::set_velocity(std::size_t, Vec2) {
    throw Error(
        ErrorCode::not_built_yet,
        "This engine's bodies are not touched while it runs; the solvers of a World are. Take one of these.");
}

std::vector<std::byte> Simulation::saved_state() const {
    refuse_states();
}

void Simulation::restore_state(std::span<const std::byte>) {
    refuse_states();
}

}  // namespace carom::tool
