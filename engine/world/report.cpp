#include "world/report.hpp"

#include <algorithm>

namespace carom {

template <class Real>
Ledger ledger_of(const WorldState<Real>& world) {
    const Books& books = world.books;
    const Sums now = world.sums(), &start = world.initial, &outside = world.outside;
    Ledger ledger;
    ledger.time = world.time;
    ledger.initial = start.energy, ledger.energy = now.energy;
    ledger.initial_momentum = start.momentum, ledger.momentum = now.momentum;
    ledger.initial_angular_momentum = start.angular_momentum, ledger.angular_momentum = now.angular_momentum;
    ledger.wall_impulse = books.wall_impulse;
    if (!world.effects.ledger) return ledger;

    EnergyByCause& energy = ledger.energy_by_cause;
    energy.gravity = start.energy.potential - now.energy.potential;
    energy.drag = books.drag, energy.restitution = books.restitution, energy.friction = books.friction;
    energy.joints = books.joints;
    energy.correction = books.correction, energy.drive = books.drive, energy.sleep = books.sleep;
    energy.outside = outside.energy.total();
    energy.unexplained = (now.energy.kinetic + now.energy.rotational) -
                         (start.energy.kinetic + start.energy.rotational) - energy.sum();
    ledger.energy_excess = world.energy_watch.largest;
    MomentumByCause& momentum = ledger.momentum_by_cause;
    momentum.gravity = books.gravity_momentum, momentum.drag = books.drag_momentum;
    momentum.walls = books.wall_momentum, momentum.immovable = books.immovable_momentum;
    momentum.sleep = books.sleep_momentum, momentum.outside = outside.momentum;
    momentum.unexplained = now.momentum - start.momentum - momentum.gravity - momentum.drag - momentum.walls -
                           momentum.immovable - momentum.sleep - momentum.outside;
    return ledger;
}

template <class Real>
void add_counts(const Simulation<Real>& sim, Profile& profile) {
    sim.report_stages([&](const StageState& stage) {
        if (stage.time.calls == 0) return;
        const auto known = std::find_if(profile.stages.begin(), profile.stages.end(),
                                        [&](const StageTime& time) { return time.name == stage.name; });
        StageTime& time =
            known != profile.stages.end() ? *known : profile.stages.emplace_back(StageTime{stage.name, 0, 0});
        time.calls += stage.time.calls, time.seconds += stage.time.seconds;
    });
    profile.rebuilds += sim.candidates.rebuild_count();
    sim.report(profile);
}

template Ledger ledger_of(const WorldState<float>&);
template Ledger ledger_of(const WorldState<double>&);
template void add_counts(const Simulation<float>&, Profile&);
template void add_counts(const Simulation<double>&, Profile&);

}  // namespace carom
