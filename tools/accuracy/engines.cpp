#include "accuracy/engines.hpp"

#include <carom/errors.hpp>

#include <algorithm>

#include "simulation/body_mass.hpp"

namespace carom::accuracy {
namespace {

/// States are read when they are asked for, so that looking costs no step anything.
class EngineSimulation final : public tool::Simulation {
  public:
    EngineSimulation(const Scene& scene, std::unique_ptr<bench::Peer> peer, Precision precision)
        : count_(scene.bodies.size()), peer_(std::move(peer)), precision_(precision) {}

    void step(double dt) override {
        peer_->step(dt);
        time_ += dt;
        is_read_ = false;
    }
    std::size_t body_count() const override { return count_; }
    Precision precision() const override { return precision_; }
    double time() const override { return time_; }
    BodyState state(std::size_t body) const override {
        if (!is_read_) peer_->read(states_);
        is_read_ = true;
        return states_[body];
    }
    void copy_frame(const tool::FrameTarget&) const override {}
    bool keeps_ledger() const override { return false; }
    Ledger ledger() const override {
        Ledger ledger;
        ledger.wall_impulse = peer_->counts().wall_impulse;
        return ledger;
    }
    Profile profile() const override {
        Profile profile;
        profile.impacts = peer_->counts().impacts;
        profile.wall_impacts = peer_->counts().wall_impacts;
        return profile;
    }
    Plan plan() const override { return {}; }
    OverlapReport overlaps() const override { return {}; }
    std::vector<std::size_t> quarantined() const override { return {}; }
    std::uint64_t state_hash() const override { return 0; }

  private:
    std::size_t count_;
    std::unique_ptr<bench::Peer> peer_;
    Precision precision_;
    double time_ = 0;  // s
    mutable std::vector<BodyState> states_;
    mutable bool is_read_ = false;
};

std::vector<bench::PeerEngine> one_of_each_family() {
    std::vector<bench::PeerEngine> found;
    for (bench::PeerEngine& engine : bench::other_engines())
        if (std::none_of(found.begin(), found.end(),
                         [&](const bench::PeerEngine& other) { return other.family == engine.family; }))
            found.push_back(std::move(engine));
    return found;
}

}  // namespace

std::span<const bench::PeerEngine> engines() {
    static const std::vector<bench::PeerEngine> found = one_of_each_family();
    return found;
}

std::unique_ptr<tool::Simulation> make_engine_simulation(const Scene& scene, const Setting& setting,
                                                         bool counts) {
    for (const bench::PeerEngine& engine : engines()) {
        if (engine.family != setting.engine) continue;
        const bench::PeerSettings settings{.substeps = setting.substeps,
                                           .iterations = setting.iterations,
                                           .for_errors = true,
                                           .counts = counts};
        const bench::BenchScene bench_scene{.name = scene.name, .scene = scene};
        return std::make_unique<EngineSimulation>(scene, engine.make(bench_scene, settings),
                                                  engine.precision);
    }
    throw Error(ErrorCode::unknown_name, "this program was built without " + setting.engine);
}

std::string why_left_out(const Case& asked, const bench::PeerEngine& engine) {
    const Scene scene = asked.scene(0);
    if (engine.difference)
        if (std::string why = engine.difference(scene); !why.empty()) return why;
    try {
        engine.make({.name = {}, .scene = scene}, {});
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

}  // namespace carom::accuracy
