#include "torture/restored_run.hpp"

#include <carom/errors.hpp>

#include <stdexcept>

#include "measure/text.hpp"

namespace carom::torture {

RestoredRun::RestoredRun(const Watch& watch)
    : simulation_(tool::make_simulation(watch.scene(), {.isa = "scalar", .threads = 1})) {
    try {
        simulation_->restore_state(watch.simulation().saved_state());
    } catch (const Error& error) {
        throw std::runtime_error(measure::joined("a saved state was refused: ", error.what()));
    }
}

bool RestoredRun::agrees_with(const Watch& watch) const {
    return simulation_->state_hash() == watch.simulation().state_hash();
}

}  // namespace carom::torture
