#include "support/seed_run.hpp"

namespace carom::test {
namespace {

class NaiveRun final : public SeedRun {
  public:
    explicit NaiveRun(const PairwiseScene& scene) : world_(scene) {}
    void step(double dt) override { world_.step(dt); }
    std::vector<PairwiseBody> bodies() const override {
        return {world_.bodies().begin(), world_.bodies().end()};
    }
    double wall_impulse() const override { return world_.counts().wall_impulse; }

  private:
    Pairwise world_;
};

}  // namespace

std::unique_ptr<SeedRun> start_naive(const PairwiseScene& scene) {
    return std::make_unique<NaiveRun>(scene);
}

}  // namespace carom::test
