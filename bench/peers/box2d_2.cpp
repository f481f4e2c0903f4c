#include <box2d/box2d.h>

#include "measure/text.hpp"
#include "peers/peer.hpp"

namespace carom::bench {
namespace {

constexpr int kVelocityIterations = 8, kPositionIterations = 3;

b2Vec2 as_b2(Vec2 v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y)};
}

class Box2d2Peer : public Peer {
  public:
    explicit Box2d2Peer(const BenchScene& bench) : world_(as_b2(bench.scene.gravity)) {
        world_.SetAllowSleeping(false);
        world_.SetContinuousPhysics(false);
        if (bench.scene.walls) {
            b2BodyDef definition;
            add_blocks(*world_.CreateBody(&definition), wall_blocks(*bench.scene.walls),
                       bench.scene.walls->material);
        }
        if (bench.container) {
            b2BodyDef definition;
            definition.type = b2_kinematicBody;
            definition.angularVelocity = static_cast<float>(bench.container->angular_velocity);
            add_blocks(*world_.CreateBody(&definition), container_tiles(*bench.container),
                       bench.scene.bodies.at(0).material);
        }
        for (const Body& body : bench.scene.bodies) add_disc(body);
    }

    void step(double dt) override {
        world_.Step(static_cast<float>(dt), kVelocityIterations, kPositionIterations);
    }

    void read(std::vector<BodyState>& bodies) const override {
        bodies.clear();
        for (const b2Body* body : discs_) {
            const b2Vec2 position = body->GetPosition(), velocity = body->GetLinearVelocity();
            bodies.push_back({{position.x, position.y},
                              body->GetAngle(),
                              {velocity.x, velocity.y},
                              body->GetAngularVelocity()});
        }
    }

  private:
    static b2FixtureDef fixture(const b2Shape& shape, const Material& material) {
        b2FixtureDef definition;
        definition.shape = &shape;
        definition.density = static_cast<float>(material.density);
        definition.friction = static_cast<float>(material.friction);
        definition.restitution = static_cast<float>(material.restitution);
        definition.restitutionThreshold = 0;  // slow impacts bounce too
        return definition;
    }
    static void add_blocks(b2Body& body, const std::vector<WallBlock>& blocks, const Material& material) {
        for (const WallBlock& block : blocks) {
            b2PolygonShape shape;
            shape.SetAsBox(static_cast<float>(block.half_extent.x), static_cast<float>(block.half_extent.y),
                           as_b2(block.centre), 0);
            const b2FixtureDef definition = fixture(shape, material);
            body.CreateFixture(&definition);
        }
    }
    void add_disc(const Body& description) {
        b2BodyDef definition;
        definition.type = b2_dynamicBody;
        definition.position = as_b2(description.position);
        definition.linearVelocity = as_b2(description.velocity);
        b2Body* const body = world_.CreateBody(&definition);
        b2CircleShape shape;
        shape.m_radius = static_cast<float>(radius_of(description));
        const b2FixtureDef disc = fixture(shape, description.material);
        body->CreateFixture(&disc);
        discs_.push_back(body);
    }

    b2World world_;
    std::vector<b2Body*> discs_;
};

std::unique_ptr<Peer> make(const BenchScene& scene) {
    return std::make_unique<Box2d2Peer>(scene);
}

}  // namespace

PeerEngine box2d_2_engine() {
    return {"Box2D 2",
            measure::format("%d.%d.%d, single precision, %d and %d iterations, continuous collision off, no "
                            "threshold of restitution",
                            b2_version.major, b2_version.minor, b2_version.revision, kVelocityIterations,
                            kPositionIterations),
            200'000, &make};
}

}  // namespace carom::bench
