#include <algorithm>
#include <type_traits>

#include "simulation/simulation.hpp"

namespace carom::tool {
namespace {

/// A World behind the interface. No body is added or removed during a run, so a handle's index is the
/// body's place in the scene.
template <class Real>
class WorldSimulation final : public Simulation {
    struct Moving {
        Real x, y, vx, vy;
    };

  public:
    WorldSimulation(const Scene& scene, const WorldOptions& options) : world_(scene, options) {
        const Plan plan = world_.plan();
        keeps_ledger_ = std::any_of(plan.effects.begin(), plan.effects.end(), [](const EffectReport& effect) {
            return effect.name == "ledger" && effect.on;
        });
    }

    void step(double dt) override { world_.step(dt); }
    void set_velocity(std::size_t body, Vec2 velocity) override {
        world_.set_velocity(id_of(body), velocity);
    }

    std::size_t body_count() const override { return world_.body_count(); }
    Precision precision() const override {
        return std::is_same_v<Real, float> ? Precision::single_ : Precision::double_;
    }
    double time() const override { return world_.time(); }
    BodyState state(std::size_t body) const override { return world_.state(id_of(body)); }

    void copy_frame(const FrameTarget& frame) const override {
        auto* position = reinterpret_cast<Real*>(frame.position);
        auto* velocity = reinterpret_cast<Real*>(frame.velocity);
        auto* angle = reinterpret_cast<Real*>(frame.angle);
        const BodyView<Real> view = world_.bodies();
        // Rows are in the order of cells. Each body is one random access here, to memory of this core; the
        // frame goes to another one and is written from end to end.
        by_body_.resize(view.count);
        for (std::size_t i = 0; i < view.count; ++i)
            by_body_[view.id[i].index] = {view.position_x[i], view.position_y[i], view.velocity_x[i],
                                          view.velocity_y[i]};
        for (std::size_t body = 0; body < view.count; ++body) {
            position[2 * body] = by_body_[body].x;
            position[2 * body + 1] = by_body_[body].y;
            velocity[2 * body] = by_body_[body].vx;
            velocity[2 * body + 1] = by_body_[body].vy;
        }
        if (view.angle.empty()) return;  // where nothing turns the frame keeps its zeros
        for (std::size_t i = 0; i < view.count; ++i) angle[view.id[i].index] = view.angle[i];
    }

    bool keeps_ledger() const override { return keeps_ledger_; }
    Ledger ledger() const override { return world_.ledger(); }
    Profile profile() const override { return world_.profile(); }
    Plan plan() const override { return world_.plan(); }
    OverlapReport overlaps() const override { return world_.overlaps(); }
    JointErrors joint_errors() const override { return world_.joint_errors(); }
    Vec2 joint_force(std::size_t joint) const override {
        return world_.joint_force(JointId::of(static_cast<std::uint32_t>(joint)));
    }
    Events events() const override { return world_.events(); }
    std::vector<std::size_t> quarantined() const override {
        std::vector<std::size_t> bodies;
        for (const BodyId id : world_.quarantined()) bodies.push_back(id.index);
        return bodies;
    }
    std::uint64_t state_hash() const override { return world_.state_hash(); }
    std::vector<std::byte> saved_state() const override {
        std::vector<std::byte> bytes(world_.state_bytes());
        world_.save_state(bytes);
        return bytes;
    }
    void restore_state(std::span<const std::byte> state) override { world_.restore_state(state); }

  private:
    static BodyId id_of(std::size_t body) {
        return {.index = static_cast<std::uint32_t>(body), .generation = 0};
    }

    BasicWorld<Real> world_;
    bool keeps_ledger_ = false;
    mutable std::vector<Moving> by_body_;  // while a frame is copied
};

}  // namespace

std::unique_ptr<Simulation> make_world_simulation(const Scene& scene, const MachineSettings& machine) {
    WorldOptions options;
    options.isa = machine.isa;
    options.threads = machine.threads;
    options.should_stop = machine.should_stop;
    options.parallel_for = machine.parallel_for;
    if (scene.accuracy.precision == Precision::double_)
        return std::make_unique<WorldSimulation<double>>(scene, options);
    return std::make_unique<WorldSimulation<float>>(scene, options);
}

}  // namespace carom::tool
