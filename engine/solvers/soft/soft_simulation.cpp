#include "solvers/soft/soft_simulation.hpp"

#include "solvers/soft/stages.hpp"

namespace carom {

template <class Real>
void SoftSimulation<Real>::forget_derived_state() {
    this->candidates.invalidate();
    soft.forget_rows();
}

template <class Real>
void SoftSimulation<Real>::take_back_step() {
    this->world.books = start_books_;
    soft.drop_books();
    forget_derived_state();
}

template <class Real>
void SoftSimulation<Real>::remove(std::size_t row) {
    soft.graph.trail.follow_removed(row, this->world.bodies.count - 1);
    const EdgeStore::Removed edges = this->world.remove(row);
    soft.graph.follow_removed_edges(edges);
    if (edges.count > 0) sleepers.forget_woken();
    forget_derived_state();
}

template <class Real>
void SoftSimulation<Real>::wake_at(Vec2 place, double reach) {
    if (sleepers.mark_near(this->world, place, reach, *this->kernels, this->executor)) wake_marked(*this);
}

template <class Real>
void SoftSimulation<Real>::wake_all() {
    if (sleepers.mark_all(this->world)) wake_marked(*this);
}

template <class Real>
std::size_t SoftSimulation<Real>::wake_body(std::size_t row) {
    Bodies<Real>& bodies = this->world.bodies;
    if (row < bodies.count) return row;
    const BodyId id = bodies.id[row];
    sleepers.mark(bodies.island[row]);
    wake_marked(*this);
    return this->world.handles.row_of_slot(id.index);
}

template <class Real>
void SoftSimulation<Real>::report(Profile& profile) const {
    const SoftCounters& counters = soft.counters;
    profile.contacts = counters.contacts, profile.colours = counters.colours;
    profile.overflow = counters.overflow;
    const ImpactCounters& impacts = soft.impacts.counters;
    profile.impacts += soft.paths.counters.impacts;
    profile.impacts += impacts.impacts, profile.wall_impacts += impacts.of_walls;
    profile.bounces += impacts.impacts - impacts.inelastic;
    const SolveQuality solve = soft.quality();
    profile.touching = solve.touching;
    profile.residual = solve.residual, profile.residual_max = solve.residual_max;
    profile.islands_asleep = sleepers.island_count();
    profile.islands_woken += sleepers.woken_count();
}

template <class Real>
std::size_t SoftSimulation<Real>::bytes() const {
    return Simulation<Real>::bytes() + sizeof(*this) + edge_candidates.bytes() + soft.bytes() +
           tunnelling.bytes() + sleepers.bytes() + motion.bytes();
}

template class SoftSimulation<float>;
template class SoftSimulation<double>;

}  // namespace carom
