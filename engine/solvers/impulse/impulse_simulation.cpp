#include "solvers/impulse/impulse_simulation.hpp"

#include <algorithm>
#include <utility>

namespace carom {

template <class Real>
void ImpulseSimulation<Real>::forget_derived_state() {
    this->candidates.invalidate();
    impulse.forget_contacts();
    impulse.columns.accelerations.clear();
    knows_standing = false;
}

template <class Real>
void ImpulseSimulation<Real>::keep_start_of_substep() {
    if (!this->interruption.question()) return;
    start_.books = this->world.books, has_start_ = true;
    const Bodies<Real>& bodies = this->world.bodies;
    if (!bodies.has_rotation) return;
    start_.angle.assign(bodies.angle.begin(), bodies.angle.begin() + bodies.moving());
    start_.spin.assign(bodies.angular_velocity.begin(), bodies.angular_velocity.begin() + bodies.moving());
}

template <class Real>
void ImpulseSimulation<Real>::take_back_substep() {
    if (!std::exchange(has_start_, false)) return;
    this->world.books = start_.books;
    Bodies<Real>& bodies = this->world.bodies;
    std::copy(start_.angle.begin(), start_.angle.end(), bodies.angle.begin());
    std::copy(start_.spin.begin(), start_.spin.end(), bodies.angular_velocity.begin());
    forget_derived_state();
}

template <class Real>
void ImpulseSimulation<Real>::report(Profile& profile) const {
    const ImpulseCounters& counters = impulse.counters;
    profile.impacts += counters.impacts, profile.wall_impacts += counters.wall_impacts;
    profile.simultaneous_impacts += counters.simultaneous_impacts;
    profile.resting_contacts = profile.touching = counters.resting_contacts;
    profile.overlaps_corrected += counters.overlaps_corrected;
    profile.unresolved_impacts += counters.unresolved_impacts;
}

template <class Real>
std::size_t ImpulseSimulation<Real>::bytes() const {
    std::size_t bytes = Simulation<Real>::bytes() + sizeof(*this) + impulse.bytes() + wall_rows.bytes() +
                        immovable_turns.capacity() * sizeof(Turn) +
                        (start_.angle.capacity() + start_.spin.capacity()) * sizeof(Real);
    for (const auto& of_chunk : meetings.lists) bytes += of_chunk.capacity() * sizeof(FoundMeeting);
    return bytes;
}

template class ImpulseSimulation<float>;
template class ImpulseSimulation<double>;

}  // namespace carom
