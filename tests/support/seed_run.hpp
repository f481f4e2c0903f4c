#pragma once

#include <carom/pairwise.hpp>

#include <memory>
#include <vector>

namespace carom::test {

/// A scene being stepped by the naive engine or by the engine itself, so that one piece of code measures
/// both.
class SeedRun {
  public:
    virtual ~SeedRun() = default;
    virtual void step(double dt) = 0;
    virtual std::vector<PairwiseBody> bodies() const = 0;
    virtual double wall_impulse() const = 0;  // N s, sum of |impulse| on all walls
};

using StartRun = std::unique_ptr<SeedRun> (*)(const PairwiseScene&);

std::unique_ptr<SeedRun> start_naive(const PairwiseScene& scene);

/// The engine in double precision with its defaults. It has no factor a step: `keep_per_step` is ignored.
std::unique_ptr<SeedRun> start_engine(const PairwiseScene& scene);

}  // namespace carom::test
