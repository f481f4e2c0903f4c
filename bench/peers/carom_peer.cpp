#include <carom/build_info.hpp>
#include <carom/carom.hpp>

#include <cmath>
#include <utility>

#include "measure/text.hpp"
#include "peers/peer.hpp"

namespace carom::bench {
namespace {

/// The inner faces of the tiles as a chain, with a point wherever a tile ends.
Body container_of(const Container& container, const Material& material) {
    const double half = container.side / 2, count = std::ceil(container.side / container.tile_length);
    Chain chain{.points = {}, .loop = true};
    Vec2 corner{-half, -half}, along{1, 0};
    for (int side = 0; side < 4; ++side) {
        for (double i = 0; i < count; ++i) {
            const double way = container.side * i / count;
            chain.points.push_back({corner.x + way * along.x, corner.y + way * along.y});
        }
        corner = {corner.x + container.side * along.x, corner.y + container.side * along.y};
        along = {-along.y, along.x};
    }
    return {.type = BodyType::kinematic_body,
            .shape = std::move(chain),
            .angular_velocity = container.angular_velocity,
            .material = material};
}

/// The bodies of the scene first, then the container.
Scene with_container(const BenchScene& bench) {
    Scene scene = bench.scene;
    if (bench.container) scene.add(container_of(*bench.container, bench.scene.bodies.at(0).material));
    return scene;
}

class CaromPeer : public Peer {
  public:
    CaromPeer(const BenchScene& bench, int threads)
        : world_(with_container(bench), {.threads = threads}), bodies_(bench.scene.bodies.size()) {}

    void step(double dt) override { world_.step(dt); }

    void read(std::vector<BodyState>& bodies) const override {
        bodies.resize(bodies_);
        for (std::uint32_t i = 0; i < bodies_; ++i) bodies[i] = world_.state({i, 0});
    }

  private:
    World world_;
    std::size_t bodies_;
};

template <int kThreads>
std::unique_ptr<Peer> make(const BenchScene& scene, const PeerSettings&) {
    return std::make_unique<CaromPeer>(scene, kThreads);
}

}  // namespace

PeerEngine carom_engine(bool on_two_threads) {
    const BuildInfo build = build_info();
    return {.family = "Carom",
            .name = on_two_threads ? "Carom, two threads" : "Carom",
            .version = std::string(build.version),
            .settings = measure::joined(build.version, on_two_threads ? ", two threads" : ", one thread",
                                        ", single precision, ", build.chosen,
                                        ", the solver and the settings that the scene calls for"),
            .most_bodies = 100'000'000,
            .precision = Precision::single_,
            .substeps = {1},
            .iterations = {1},
            .threads = on_two_threads ? 2 : 1,
            .make = on_two_threads ? &make<2> : &make<1>};
}

}  // namespace carom::bench
