#include <box2d/box2d.h>

#include "measure/text.hpp"
#include "peers/peer.hpp"

namespace carom::bench {
namespace {

constexpr int kVelocityIterations = 8, kPositionIterations = 3;

/// In the proportion that its manual has.
int position_iterations_of(int velocity_iterations) {
    return (kPositionIterations * velocity_iterations + kVelocityIterations - 1) / kVelocityIterations;
}

b2Vec2 as_b2(Vec2 v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y)};
}

/// Counts contacts with walls and others.
class Counter : public b2ContactListener {
  public:
    void BeginContact(b2Contact* contact) override {
        ++counts.impacts;
        counts.wall_impacts += is_with_wall(*contact);
    }
    void PostSolve(b2Contact* contact, const b2ContactImpulse* impulse) override {
        if (!is_with_wall(*contact)) return;
        for (int i = 0; i < impulse->count; ++i) counts.wall_impulse += double{impulse->normalImpulses[i]};
    }
    PeerCounts counts;

  private:
    static bool is_with_wall(b2Contact& contact) {
        return contact.GetFixtureA()->GetBody()->GetType() == b2_staticBody ||
               contact.GetFixtureB()->GetBody()->GetType() == b2_staticBody;
    }
};

class Box2d2Peer : public Peer {
  public:
    Box2d2Peer(const BenchScene& bench, const PeerSettings& settings)
        : has_no_skin_(settings.for_errors), world_(as_b2(bench.scene.gravity)) {
        if (settings.iterations > 0) {
            velocity_iterations_ = settings.iterations;
            position_iterations_ = position_iterations_of(settings.iterations);
        }
        world_.SetAllowSleeping(false);
        world_.SetContinuousPhysics(settings.for_errors);
        if (settings.counts) world_.SetContactListener(&counter_);
        if (bench.scene.walls) {
            b2BodyDef definition;
            add_blocks(*world_.CreateBody(&definition), wall_blocks(bench.scene),
                       bench.scene.walls->material);
        }
        if (bench.container) {
            b2BodyDef definition;
            definition.type = b2_kinematicBody;
            definition.angularVelocity = static_cast<float>(bench.container->angular_velocity);
            add_blocks(*world_.CreateBody(&definition), container_tiles(*bench.container),
                       bench.scene.bodies.at(0).material);
        }
        for (const Body& body : bench.scene.bodies) add_disc(body, bench.scene.drag);
    }

    void step(double dt) override {
        world_.Step(static_cast<float>(dt), velocity_iterations_, position_iterations_);
    }
    PeerCounts counts() const override { return counter_.counts; }

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
    void add_blocks(b2Body& body, const std::vector<WallBlock>& blocks, const Material& material) const {
        for (const WallBlock& block : blocks) {
            b2PolygonShape shape;
            shape.SetAsBox(static_cast<float>(block.half_extent.x), static_cast<float>(block.half_extent.y),
                           as_b2(block.centre), 0);
            if (has_no_skin_) shape.m_radius = 0;  // its polygons are a centimetre thicker than they say
            const b2FixtureDef definition = fixture(shape, material);
            body.CreateFixture(&definition);
        }
    }
    void add_disc(const Body& description, const Drag& drag) {
        b2BodyDef definition;
        definition.type = b2_dynamicBody;
        definition.position = as_b2(description.position);
        definition.angle = static_cast<float>(description.angle);
        definition.linearVelocity = as_b2(description.velocity);
        definition.angularVelocity = static_cast<float>(description.angular_velocity);
        definition.linearDamping = static_cast<float>(drag.linear);
        definition.angularDamping = static_cast<float>(drag.angular);
        definition.fixedRotation = description.fixed_rotation;
        b2Body* const body = world_.CreateBody(&definition);
        b2CircleShape shape;
        shape.m_radius = static_cast<float>(radius_of(description));
        b2FixtureDef disc = fixture(shape, description.material);
        disc.density = static_cast<float>(density_of(description));
        body->CreateFixture(&disc);
        discs_.push_back(body);
    }

    bool has_no_skin_;
    int velocity_iterations_ = kVelocityIterations, position_iterations_ = kPositionIterations;
    Counter counter_;
    b2World world_;
    std::vector<b2Body*> discs_;
};

std::unique_ptr<Peer> make(const BenchScene& scene, const PeerSettings& settings) {
    require_dynamic_discs(scene.scene);
    return std::make_unique<Box2d2Peer>(scene, settings);
}

}  // namespace

PeerEngine box2d_2_engine() {
    return {.family = "Box2D 2",
            .name = "Box2D 2",
            .version = measure::format("%d.%d.%d", b2_version.major, b2_version.minor, b2_version.revision),
            .settings = measure::format(
                "%d.%d.%d, single precision, %d and %d iterations, continuous collision off, no "
                "threshold of restitution",
                b2_version.major, b2_version.minor, b2_version.revision, kVelocityIterations,
                kPositionIterations),
            .most_bodies = 200'000,
            .precision = Precision::single_,
            .substeps = {1},
            .iterations = {kVelocityIterations, 2, 32},
            .make = &make};
}

}  // namespace carom::bench
