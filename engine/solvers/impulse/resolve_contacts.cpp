#include "solvers/shared/stages.hpp"

namespace carom {

template <class Real>
void settle_contacts(Simulation<Real>& sim) {
    sim.impulse.settle_contacts(sim.meetings, sim.world.handles);
}

template <class Real>
void resolve_impacts(Simulation<Real>& sim) {
    sim.impulse.resolve_impacts();
}

template void settle_contacts(Simulation<float>&);
template void settle_contacts(Simulation<double>&);
template void resolve_impacts(Simulation<float>&);
template void resolve_impacts(Simulation<double>&);

}  // namespace carom
