#pragma once

#include <carom/world.hpp>

#include <cstdint>
#include <vector>

#include "simulation.hpp"

namespace carom::tool {

/// Contacts and overlaps now and then during a run, so that a report can draw them over time. Measuring them
/// is a pass over all candidate pairs; so there are 200 moments at most, and 20 of a large scene.
class ContactCourse {
  public:
    ContactCourse(std::int64_t steps, std::size_t bodies);

    /// Measures if it is time to.
    void look(const Simulation& simulation, std::int64_t step);

    struct Moment {
        double time = 0;  // s
        OverlapReport overlaps;
    };
    const std::vector<Moment>& moments() const { return moments_; }

  private:
    std::int64_t every_;
    std::vector<Moment> moments_;
};

}  // namespace carom::tool
