#include "solvers/shared/simulation.hpp"

#include <algorithm>
#include <cmath>

namespace carom {

template <class Real>
void Simulation<Real>::remove(std::size_t row) {
    world.remove(row);
    forget_derived_state();
}

template <class Real>
void Simulation<Real>::check_bodies(std::string_view) {}

template <class Real>
void Simulation<Real>::wake_at(Vec2, double) {}

template <class Real>
void Simulation<Real>::wake_all() {}

template <class Real>
std::size_t Simulation<Real>::wake_body(std::size_t row) {
    return row;
}

template <class Real>
void Simulation<Real>::set_iterations(std::optional<int>) {}

template <class Real>
int Simulation<Real>::substeps_for_drag(double dt, int flights) const {
    // So that the series of effects/flight.hpp stay exact.
    const double largest_drag = std::fmax(world.drag.linear, world.drag.angular);
    return std::max((substeps_asked_for + flights - 1) / flights,
                    static_cast<int>(std::ceil(dt * largest_drag / kLargestDragTimesStep)));
}

template <class Real>
bool Simulation<Real>::has_anything_to_move() const {
    const Bodies<Real>& bodies = world.bodies;
    if (world.immovable_rows.size() < bodies.count) return true;
    return std::any_of(world.immovable_rows.begin(), world.immovable_rows.end(), [&](std::int32_t row) {
        return (bodies.flags_of(static_cast<std::size_t>(row)) & kKinematic) != 0;
    });
}

template <class Real>
std::size_t Simulation<Real>::bytes() const {
    return world.bytes() + candidates.bytes() + displaced_rows.bytes() + lost_rows.bytes() +
           (displaced.capacity() + lost.capacity()) * sizeof(std::int32_t) +
           chunk_fastest.capacity() * sizeof(double);
}

template class Simulation<float>;
template class Simulation<double>;

}  // namespace carom
