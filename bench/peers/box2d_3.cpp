#include <box2d/box2d.h>

#include "measure/text.hpp"
#include "peers/peer.hpp"

namespace carom::bench {
namespace {

constexpr int kSubsteps = 4;

b2Vec2 as_b2(Vec2 v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y)};
}

class Box2d3Peer : public Peer {
  public:
    explicit Box2d3Peer(const BenchScene& bench) {
        b2WorldDef definition = b2DefaultWorldDef();
        definition.gravity = as_b2(bench.scene.gravity);
        definition.enableSleep = false;
        definition.enableContinuous = false;
        definition.restitutionThreshold = 0;  // slow impacts bounce too
        definition.workerCount = 1;
        world_ = b2CreateWorld(&definition);
        if (bench.scene.walls) {
            const b2BodyDef walls = b2DefaultBodyDef();
            add_blocks(b2CreateBody(world_, &walls), wall_blocks(*bench.scene.walls),
                       bench.scene.walls->material);
        }
        if (bench.container) {
            b2BodyDef container = b2DefaultBodyDef();
            container.type = b2_kinematicBody;
            container.angularVelocity = static_cast<float>(bench.container->angular_velocity);
            add_blocks(b2CreateBody(world_, &container), container_tiles(*bench.container),
                       bench.scene.bodies.at(0).material);
        }
        for (const Body& body : bench.scene.bodies) add_disc(body);
    }
    ~Box2d3Peer() override { b2DestroyWorld(world_); }
    Box2d3Peer(const Box2d3Peer&) = delete;
    Box2d3Peer& operator=(const Box2d3Peer&) = delete;

    void step(double dt) override { b2World_Step(world_, static_cast<float>(dt), kSubsteps); }

    void read(std::vector<BodyState>& bodies) const override {
        bodies.clear();
        for (const b2BodyId body : discs_) {
            const auto position = b2Body_GetPosition(body);
            const b2Vec2 velocity = b2Body_GetLinearVelocity(body);
            bodies.push_back({{position.x, position.y},
                              b2Rot_GetAngle(b2Body_GetRotation(body)),
                              {velocity.x, velocity.y},
                              b2Body_GetAngularVelocity(body)});
        }
    }

  private:
    static b2ShapeDef shape_of(const Material& material) {
        b2ShapeDef definition = b2DefaultShapeDef();
        definition.density = static_cast<float>(material.density);
        definition.material.friction = static_cast<float>(material.friction);
        definition.material.restitution = static_cast<float>(material.restitution);
        return definition;
    }
    static void add_blocks(b2BodyId body, const std::vector<WallBlock>& blocks, const Material& material) {
        const b2ShapeDef definition = shape_of(material);
        for (const WallBlock& block : blocks) {
            const b2Polygon polygon =
                b2MakeOffsetBox(static_cast<float>(block.half_extent.x),
                                static_cast<float>(block.half_extent.y), as_b2(block.centre), b2Rot_identity);
            b2CreatePolygonShape(body, &definition, &polygon);
        }
    }
    void add_disc(const Body& description) {
        b2BodyDef definition = b2DefaultBodyDef();
        definition.type = b2_dynamicBody;
        definition.position = as_b2(description.position);
        definition.linearVelocity = as_b2(description.velocity);
        const b2BodyId body = b2CreateBody(world_, &definition);
        const b2ShapeDef shape = shape_of(description.material);
        const b2Circle circle{{0, 0}, static_cast<float>(radius_of(description))};
        b2CreateCircleShape(body, &shape, &circle);
        discs_.push_back(body);
    }

    b2WorldId world_{};
    std::vector<b2BodyId> discs_;
};

std::unique_ptr<Peer> make(const BenchScene& scene) {
    return std::make_unique<Box2d3Peer>(scene);
}

}  // namespace

PeerEngine box2d_3_engine() {
    const b2Version version = b2GetVersion();
    return {
        "Box2D 3",
        measure::format("%d.%d.%d, single precision, one worker, %d substeps, continuous collision off, no "
                        "threshold of restitution",
                        version.major, version.minor, version.revision, kSubsteps),
        262'140,  // awake bodies one worker can hold; beyond, it is wrong without saying so
        &make};
}

}  // namespace carom::bench
