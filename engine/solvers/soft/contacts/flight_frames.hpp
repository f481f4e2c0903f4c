#pragma once

#include "constraints/contact_graph.hpp"
#include "sleeping/islands.hpp"
#include "state/bodies.hpp"

namespace carom {

/// Velocities from which to see how far bodies fly in a step. Bodies that can touch each other, and nothing
/// that stands or is driven, fall as one: how far each of them may get, and so which of them may meet if a
/// third one stops one of them, does not depend on how fast they fall together.
///
/// docs/decisions/0033-costs-of-strangers.md has the measurements.
template <class Real>
class FlightFrames {
  public:
    /// Finds the groups that fly freely, and the mean velocity of each. To be called in steps in which bodies
    /// fly together.
    /// @param motion  [rows][4] at the start of the step
    /// Cost: O(bodies + pairs + supports), about 5 ns each.
    void find(const ContactGraph<Real>& graph, const Bodies<Real>& bodies, const Column<Real>& motion);
    /// In steps in which they do not.
    void clear() { velocity_.clear(); }
    bool empty() const { return velocity_.empty(); }

    /// x and y of the velocity for a row [m/s]; zero if its group may touch what stands or is driven.
    const Real* of(std::int32_t row) const { return velocity_.data() + 2 * static_cast<std::size_t>(row); }
    std::size_t bytes() const {
        return velocity_.bytes() + islands_.bytes() + group_.capacity() * sizeof(Group);
    }

  private:
    struct Group {                       // at the place of its first row
        double x = 0, y = 0, count = 0;  // m/s, sums; bodies
        bool is_held = false;
    };
    Islands islands_;
    std::vector<Group> group_;
    Column<Real> velocity_;  // [rows][2]
};

extern template class FlightFrames<float>;
extern template class FlightFrames<double>;

}  // namespace carom
