#pragma once

#include <carom/ledger.hpp>

namespace carom {

/// What the check of energies (solvers/shared/check_energy.hpp) keeps from step to step.
struct EnergyWatch {
    EnergyExcess largest;          ///< of all steps so far
    double allowed = 0;            ///< J, what a passive world may have
    double round_off = 0;          ///< J, above that by rounding: of all steps since `allowed` was set
    bool is_set = false;           ///< false where `allowed` is to be set anew, by what the last step left
    bool was_kept = false;         ///< whether the last step had to keep the rule of passive worlds
    double energy = 0;             ///< J, behind the last step; likewise below
    double outside = 0;            ///< J, that calls had brought in
    double brought = 0;            ///< J, by calls since the last step, all as positive
    double restitution = 0;        ///< J, in the books
    double correction = 0;         ///< J, in the books
    double taken_by_contacts = 0;  ///< J, in the books: by restitution, friction and joints
};

}  // namespace carom
