#pragma once

#include <carom/events.hpp>

#include <cstdint>
#include <vector>

#include "narrowphase/convex_impact_time.hpp"
#include "state/sensing.hpp"
#include "state/world_state.hpp"

namespace carom {

/// What overlaps sensors at the end of a step, and what has passed through them in it.
///
/// A body passes where it is faster than half of its thickness a step: then the two are looked at along
/// their ways, from the first place to the last.
template <class Real>
class SensorFinder {
  public:
    /// @param dt  s, of the step that ends
    SensorFinder(const WorldState<Real>& world, double dt) : world_(world), dt_(dt) {}

    /// Looks at a body that may be in a sensor; what does not meet it by its filters is not.
    void look(std::size_t sensor, std::size_t body);
    /// Looks at all segments and chains.
    void look_at_edges(std::size_t sensor);
    /// How far a sensor and what is in it may be apart at the end of the step if they met in it [m].
    double way_of(std::size_t row) const;

    std::vector<SensedPair> inside, passed;  ///< as found; passed: not inside at the end

  private:
    bool is_apart(std::size_t sensor, std::size_t body) const;
    template <class Fn>
    void for_each_piece(std::size_t row, const Fn& fn) const;
    bool look_at_pieces(const MovingConvex& a, const MovingConvex& b, const SensedPair& pair);
    Vec2 velocity(std::size_t row) const;
    double spin(std::size_t row) const;
    bool moves(std::size_t row) const;

    const WorldState<Real>& world_;
    double dt_;
};

extern template class SensorFinder<float>;
extern template class SensorFinder<double>;

}  // namespace carom
