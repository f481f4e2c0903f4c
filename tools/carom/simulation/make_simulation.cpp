#include "simulation/simulation.hpp"

namespace carom::tool {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const MachineSettings& machine) {
    scene.validate();
    return scene.accuracy.solver == Solver::pairwise ? make_pairwise_simulation(scene, machine)
                                                     : make_world_simulation(scene, machine);
}

}  // namespace carom::tool
