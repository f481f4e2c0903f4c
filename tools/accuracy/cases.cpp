#include "accuracy/cases.hpp"

#include <vector>

namespace carom::accuracy {

std::span<const Case> all_cases() {
    static const std::vector<Case> cases{
        projectile(),      projectile_with_drag(), springs(),         springs_on_springs(),
        bouncing_ball(),   bouncing_discs(),       resting_lattice(), bouncing_lattice(),
        pulled_box(),      sticking_disc(),        sliding_disc(),    sloping_boxes(),
        tipping_boxes(),   rolling_disc(),         slipping_disc(),   launched_disc(),
        stopping_disc(),   stopping_box(),         oblique_impacts(), rough_impacts(),
        shock_chain(),     galperin_billiard(),    newtons_cradle(),  cradle_on_rods(),
        galilean_cannon(), elastic_gas(),          gas_pressure(),    cooling_gas(),
        pendulums(),       double_pendulum(),      dumbbell(),        wedge(),
        stack(),           harmonic_overhang(),    leaning_ladder(),  arch(),
        dominoes(),        hanging_chain(),        free_spin()};
    return cases;
}

}  // namespace carom::accuracy
