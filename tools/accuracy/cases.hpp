#pragma once

#include <span>

#include "accuracy/case.hpp"

namespace carom::accuracy {

// One function a file of cases/.
Case projectile();
Case projectile_with_drag();
Case bouncing_ball();
Case bouncing_discs();
Case resting_lattice();
Case bouncing_lattice();
Case sticking_disc();
Case sliding_disc();
Case rolling_disc();
Case slipping_disc();
Case launched_disc();
Case stopping_disc();
Case oblique_impacts();
Case rough_impacts();
Case shock_chain();
Case galperin_billiard();
Case newtons_cradle();
Case galilean_cannon();
Case elastic_gas();
Case gas_pressure();
Case cooling_gas();
Case stack();

/// All of them, in order. A new case is a file and a line in cases.cpp.
std::span<const Case> all_cases();

}  // namespace carom::accuracy
