#include <algorithm>
#include <type_traits>

#include "simulation/simulation.hpp"

namespace carom::tool {
namespace {

/// A World behind the interface. No body is added or removed during a run, so a handle's index is the
/// body's place in the scene.
template <class Real>
class WorldSimulation final : public Simulation {
  public:
    WorldSimulation(const Scene& scene, const WorldOptions& options) : world_(scene, options) {
        const Plan plan = world_.plan();
        keeps_ledger_ = std::any_of(plan.effects.begin(), plan.effects.end(), [](const EffectReport& effect) {
            return effect.name == "ledger" && effect.on;
        });
    }

    void step(double dt) override { world_.step(dt); }

    std::size_t body_count() const override { return world_.body_count(); }
    Precision precision() const override {
        return std::is_same_v<Real, float> ? Precision::single_ : Precision::double_;
    }
    double time() const override { return world_.time(); }
    BodyState state(std::size_t body) const override {
        return world_.state(BodyId{.index = static_cast<std::uint32_t>(body), .generation = 0});
    }

    void copy_frame(const FrameTarget& frame) const override {
        auto* position = reinterpret_cast<Real*>(frame.position);
        auto* velocity = reinterpret_cast<Real*>(frame.velocity);
        auto* angle = reinterpret_cast<Real*>(frame.angle);
        const BodyView<Real> view = world_.bodies();
        // Rows are in the order of cells. Reading the columns out of order is cheap, they are in this core's
        // cache; the frame is in that of the core which writes it to the file, and better written from end to
        // end.
        row_of_.resize(view.count);
        for (std::size_t i = 0; i < view.count; ++i)
            row_of_[view.id[i].index] = static_cast<std::uint32_t>(i);
        for (std::size_t body = 0; body < view.count; ++body) {
            const std::size_t i = row_of_[body];
            position[2 * body] = view.position_x[i];
            position[2 * body + 1] = view.position_y[i];
            velocity[2 * body] = view.velocity_x[i];
            velocity[2 * body + 1] = view.velocity_y[i];
        }
        if (view.angle.empty()) return;  // where nothing turns the frame keeps its zeros
        for (std::size_t body = 0; body < view.count; ++body) angle[body] = view.angle[row_of_[body]];
    }

    bool keeps_ledger() const override { return keeps_ledger_; }
    Ledger ledger() const override { return world_.ledger(); }
    Profile profile() const override { return world_.profile(); }
    Plan plan() const override { return world_.plan(); }
    OverlapReport overlaps() const override { return world_.overlaps(); }
    std::vector<std::size_t> quarantined() const override {
        std::vector<std::size_t> bodies;
        for (const BodyId id : world_.quarantined()) bodies.push_back(id.index);
        return bodies;
    }
    std::uint64_t state_hash() const override { return world_.state_hash(); }

  private:
    BasicWorld<Real> world_;
    bool keeps_ledger_ = false;
    mutable std::vector<std::uint32_t> row_of_;  // of each body, while a frame is copied
};

}  // namespace

std::unique_ptr<Simulation> make_world_simulation(const Scene& scene, const MachineSettings& machine) {
    WorldOptions options;
    options.isa = machine.isa;
    options.threads = machine.threads;
    if (scene.accuracy.precision == Precision::double_)
        return std::make_unique<WorldSimulation<double>>(scene, options);
    return std::make_unique<WorldSimulation<float>>(scene, options);
}

}  // namespace carom::tool
