#include "accuracy/cases.hpp"

#include <vector>

namespace carom::accuracy {

std::span<const Case> all_cases() {
    static const std::vector<Case> cases{projectile(),      projectile_with_drag(),
                                         bouncing_ball(),   bouncing_discs(),
                                         resting_lattice(), bouncing_lattice(),
                                         sticking_disc(),   sliding_disc(),
                                         rolling_disc(),    slipping_disc(),
                                         launched_disc(),   stopping_disc(),
                                         oblique_impacts(), rough_impacts(),
                                         shock_chain(),     galperin_billiard(),
                                         newtons_cradle(),  galilean_cannon(),
                                         elastic_gas(),     gas_pressure(),
                                         cooling_gas(),     stack()};
    return cases;
}

}  // namespace carom::accuracy
