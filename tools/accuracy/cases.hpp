#pragma once

#include <span>

#include "accuracy/case.hpp"

namespace carom::accuracy {

// One function a file of cases/.
Case projectile();
Case projectile_with_drag();
Case springs();
Case springs_on_springs();
Case bouncing_ball();
Case bouncing_discs();
Case resting_lattice();
Case bouncing_lattice();
Case pulled_box();
Case sticking_disc();
Case sliding_disc();
Case sloping_boxes();
Case tipping_boxes();
Case rolling_disc();
Case slipping_disc();
Case launched_disc();
Case stopping_disc();
Case stopping_box();
Case oblique_impacts();
Case rough_impacts();
Case shock_chain();
Case galperin_billiard();
Case newtons_cradle();
Case cradle_on_rods();
Case galilean_cannon();
Case elastic_gas();
Case gas_pressure();
Case cooling_gas();
Case pendulums();
Case double_pendulum();
Case dumbbell();
Case wedge();
Case stack();
Case harmonic_overhang();
Case leaning_ladder();
Case arch();
Case dominoes();
Case hanging_chain();
Case free_spin();

/// All of them, in order. A new case is a file and a line in cases.cpp.
std::span<const Case> all_cases();

}  // namespace carom::accuracy
