#include "solvers/impulse/impulse_simulation.hpp"

namespace carom {

template <class Real>
void ImpulseSimulation<Real>::forget_derived_state() {
    this->candidates.invalidate();
    impulse.forget_contacts();
    impulse.flights.accelerations.clear();
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
                        meetings.capacity() * sizeof(FoundMeeting) +
                        immovable_turns.capacity() * sizeof(Turn);
    for (const auto& of_chunk : chunk_meetings) bytes += of_chunk.capacity() * sizeof(FoundMeeting);
    return bytes;
}

template class ImpulseSimulation<float>;
template class ImpulseSimulation<double>;

}  // namespace carom
