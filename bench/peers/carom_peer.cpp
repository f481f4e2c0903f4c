#include <carom/build_info.hpp>
#include <carom/carom.hpp>

#include "measure/text.hpp"
#include "peers/peer.hpp"

namespace carom::bench {
namespace {

class CaromPeer : public Peer {
  public:
    explicit CaromPeer(const Scene& scene) : world_(scene, {.threads = 1}) {}

    void step(double dt) override { world_.step(dt); }

    void read(std::vector<BodyState>& bodies) const override {
        const auto view = world_.bodies();
        bodies.resize(view.count);
        for (const BodyId id : view.id) bodies[id.index] = world_.state(id);
    }

  private:
    World world_;
};

std::unique_ptr<Peer> make(const BenchScene& scene, const PeerSettings&) {
    if (scene.container)
        throw Error(ErrorCode::not_built_yet,
                    "a container of boxes that turns needs boxes, which are not built yet");
    return std::make_unique<CaromPeer>(scene.scene);
}

}  // namespace

PeerEngine carom_engine() {
    const BuildInfo build = build_info();
    return {.family = "Carom",
            .name = "Carom",
            .version = std::string(build.version),
            .settings = measure::joined(build.version, ", one thread, single precision, ", build.chosen,
                                        ", the solver and the settings that the scene calls for"),
            .most_bodies = 100'000'000,
            .precision = Precision::single_,
            .substeps = {1},
            .iterations = {1},
            .make = &make};
}

}  // namespace carom::bench
