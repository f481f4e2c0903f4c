#include "step/make_simulation.hpp"

namespace carom {

template <class Real>
std::unique_ptr<Simulation<Real>> make_simulation(Solver solver) {
    if (solver == Solver::soft) return make_soft_simulation<Real>();
    if (solver == Solver::rattle) return make_rattle_simulation<Real>();
    if (solver == Solver::event) return make_event_simulation<Real>();
    return make_impulse_simulation<Real>();
}

template std::unique_ptr<Simulation<float>> make_simulation(Solver);
template std::unique_ptr<Simulation<double>> make_simulation(Solver);

}  // namespace carom
