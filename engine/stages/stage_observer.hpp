#pragma once

#include <cstddef>

namespace carom {

/// Looks at a world before and after each stage of a step, in place of the stopwatch: so tests hold what
/// stages say that they read and write against what they do.
class StageObserver {
  public:
    virtual ~StageObserver() = default;
    /// @param stage  number of the stage, in the order of Simulation::report_stages
    virtual void before(std::size_t stage) = 0;
    virtual void after(std::size_t stage) = 0;

    // What the loops over stages call: stages/stage.hpp.
    void start() {}
    void begin(std::size_t stage) { before(stage); }
    void lap(std::size_t stage) { after(stage); }
    void finish() {}
};

}  // namespace carom
