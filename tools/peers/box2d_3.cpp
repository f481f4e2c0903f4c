#include <box2d/box2d.h>

#include <cmath>
#include <type_traits>
#include <variant>

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
    Box2d3Peer(const BenchScene& bench, const PeerSettings& settings)
        : substeps_(settings.substeps > 0 ? settings.substeps : kSubsteps), keeps_counts_(settings.counts) {
        b2WorldDef definition = b2DefaultWorldDef();
        definition.gravity = as_b2(bench.scene.gravity);
        definition.enableSleep = false;
        definition.enableContinuous = settings.for_errors;
        definition.restitutionThreshold = 0;  // slow impacts bounce too
        definition.workerCount = 1;
        world_ = b2CreateWorld(&definition);
        if (bench.scene.walls) {
            const b2BodyDef walls = b2DefaultBodyDef();
            walls_ = b2CreateBody(world_, &walls);
            add_blocks(walls_, wall_blocks(bench.scene), bench.scene.walls->material);
        }
        if (bench.container) {
            b2BodyDef container = b2DefaultBodyDef();
            container.type = b2_kinematicBody;
            container.angularVelocity = static_cast<float>(bench.container->angular_velocity);
            add_blocks(b2CreateBody(world_, &container), container_tiles(*bench.container),
                       bench.scene.bodies.at(0).material);
        }
        for (const Body& body : bench.scene.bodies) add_body(body, bench.scene.drag);
        for (const Joint& joint : bench.scene.joints) add_joint(joint, bench.scene);
    }
    ~Box2d3Peer() override { b2DestroyWorld(world_); }
    Box2d3Peer(const Box2d3Peer&) = delete;
    Box2d3Peer& operator=(const Box2d3Peer&) = delete;

    void step(double dt) override {
        b2World_Step(world_, static_cast<float>(dt), substeps_);
        if (keeps_counts_) count();
    }
    PeerCounts counts() const override { return counts_; }

    void read(std::vector<BodyState>& bodies) const override {
        bodies.clear();
        for (const b2BodyId body : bodies_) {
            const auto position = b2Body_GetPosition(body);
            const b2Vec2 velocity = b2Body_GetLinearVelocity(body);
            bodies.push_back({{position.x, position.y},
                              b2Rot_GetAngle(b2Body_GetRotation(body)),
                              {velocity.x, velocity.y},
                              b2Body_GetAngularVelocity(body)});
        }
    }

  private:
    b2ShapeDef shape_of(const Material& material) const {
        b2ShapeDef definition = b2DefaultShapeDef();
        definition.enableContactEvents = keeps_counts_;
        definition.density = static_cast<float>(material.density);
        definition.material.friction = static_cast<float>(material.friction);
        definition.material.restitution = static_cast<float>(material.restitution);
        return definition;
    }
    void add_blocks(b2BodyId body, const std::vector<WallBlock>& blocks, const Material& material) const {
        const b2ShapeDef definition = shape_of(material);
        for (const WallBlock& block : blocks) {
            const b2Polygon polygon =
                b2MakeOffsetBox(static_cast<float>(block.half_extent.x),
                                static_cast<float>(block.half_extent.y), as_b2(block.centre), b2Rot_identity);
            b2CreatePolygonShape(body, &definition, &polygon);
        }
    }
    void add_body(const Body& description, const Drag& drag) {
        b2BodyDef definition = b2DefaultBodyDef();
        definition.type = description.type == BodyType::static_body ? b2_staticBody : b2_dynamicBody;
        definition.position = as_b2(description.position);
        definition.rotation = b2MakeRot(static_cast<float>(description.angle));
        definition.linearVelocity = as_b2(description.velocity);
        definition.angularVelocity = static_cast<float>(description.angular_velocity);
        definition.linearDamping = static_cast<float>(drag.linear);
        definition.angularDamping = static_cast<float>(drag.angular);
        const b2BodyId body = b2CreateBody(world_, &definition);
        b2ShapeDef shape = shape_of(description.material);
        shape.filter.groupIndex = description.group;
        if (const auto* compound = std::get_if<Compound>(&description.shape))
            add_pieces(body, shape, recentred(*compound, description.material));
        else if (const auto* chain = std::get_if<Chain>(&description.shape))
            add_chain(body, description.material, *chain);
        else
            shape.density = static_cast<float>(density_of(description)),
            add_shape(body, shape, description.shape);
        if (description.fixed_rotation) {  // every 3.x has this; how a rotation is locked changed in 3.2
            b2MassData mass = b2Body_GetMassData(body);
            mass.rotationalInertia = 0;
            b2Body_SetMassData(body, mass);
        }
        bodies_.push_back(body);
    }
    /// Its pieces may have their own materials, but are as dense as the body is.
    static void add_pieces(b2BodyId body, const b2ShapeDef& definition, const Compound& compound) {
        for (const Piece& piece : compound.pieces)
            std::visit(
                [&](const auto& shape) {
                    if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, Disc>) {
                        const b2Circle circle{as_b2(piece.position), static_cast<float>(shape.radius)};
                        b2CreateCircleShape(body, &definition, &circle);
                    } else if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, Capsule>) {
                        const Vec2 half{0.5 * shape.length * std::cos(piece.angle),
                                        0.5 * shape.length * std::sin(piece.angle)};
                        const b2Capsule capsule{as_b2({piece.position.x - half.x, piece.position.y - half.y}),
                                                as_b2({piece.position.x + half.x, piece.position.y + half.y}),
                                                static_cast<float>(shape.radius)};
                        b2CreateCapsuleShape(body, &definition, &capsule);
                    } else {
                        const b2Transform place{as_b2(piece.position),
                                                b2MakeRot(static_cast<float>(piece.angle))};
                        const b2Polygon own = polygon_of(Shape{shape});
                        const b2Polygon polygon = b2TransformPolygon(place, &own);
                        b2CreatePolygonShape(body, &definition, &polygon);
                    }
                },
                piece.shape);
    }
    static void add_chain(b2BodyId body, const Material& material, const Chain& chain) {
        std::vector<b2Vec2> points;
        for (const Vec2 point : chain.points) points.push_back(as_b2(point));
        b2SurfaceMaterial surface = b2DefaultSurfaceMaterial();
        surface.friction = static_cast<float>(material.friction);
        surface.restitution = static_cast<float>(material.restitution);
        b2ChainDef definition = b2DefaultChainDef();
        definition.points = points.data(), definition.count = static_cast<int>(points.size());
        definition.isLoop = chain.loop;
        definition.materials = &surface, definition.materialCount = 1;
        b2CreateChain(body, &definition);
    }
    b2BodyId world_body() {
        if (!b2Body_IsValid(ground_)) {
            const b2BodyDef ground = b2DefaultBodyDef();
            ground_ = b2CreateBody(world_, &ground);
        }
        return ground_;
    }
    /// Rods of two bodies, their anchors at the centres, and hinges.
    void add_joint(const Joint& joint, const Scene& scene) {
        const b2BodyId a = joint.a ? bodies_.at(joint.a->index) : world_body(),
                       b = bodies_.at(joint.b->index);
        const Vec2 from = joint.a ? scene.bodies[joint.a->index].position : Vec2{},
                   to = scene.bodies[joint.b->index].position;
        if (std::holds_alternative<DistanceJoint>(joint.kind)) {
            b2DistanceJointDef rod = b2DefaultDistanceJointDef();
            rod.bodyIdA = a, rod.bodyIdB = b;
            rod.length = static_cast<float>(std::hypot(to.x - from.x, to.y - from.y));
            rod.collideConnected = joint.collide;
            b2CreateDistanceJoint(world_, &rod);
            return;
        }
        const auto& hinge = std::get<RevoluteJoint>(joint.kind);
        b2RevoluteJointDef same = b2DefaultRevoluteJointDef();
        same.bodyIdA = a, same.bodyIdB = b;
        const b2Vec2 anchor = as_b2(hinge.anchor.value_or(to));
        same.localAnchorA = b2Body_GetLocalPoint(a, anchor),
        same.localAnchorB = b2Body_GetLocalPoint(b, anchor);
        same.referenceAngle = b2Rot_GetAngle(b2Body_GetRotation(b)) - b2Rot_GetAngle(b2Body_GetRotation(a));
        same.enableLimit = hinge.lower && hinge.upper;
        same.lowerAngle = static_cast<float>(hinge.lower.value_or(0));
        same.upperAngle = static_cast<float>(hinge.upper.value_or(0));
        same.enableMotor = hinge.motor_speed.has_value();
        same.motorSpeed = static_cast<float>(hinge.motor_speed.value_or(0));
        same.maxMotorTorque = static_cast<float>(hinge.max_motor_torque);
        same.collideConnected = joint.collide;
        b2CreateRevoluteJoint(world_, &same);
    }
    static void add_shape(b2BodyId body, const b2ShapeDef& definition, const Shape& shape) {
        if (const auto* disc = std::get_if<Disc>(&shape)) {
            const b2Circle circle{{0, 0}, static_cast<float>(disc->radius)};
            b2CreateCircleShape(body, &definition, &circle);
        } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
            const auto half = static_cast<float>(capsule->length / 2);
            const b2Capsule same{{-half, 0}, {half, 0}, static_cast<float>(capsule->radius)};
            b2CreateCapsuleShape(body, &definition, &same);
        } else {
            const b2Polygon polygon = polygon_of(shape);
            b2CreatePolygonShape(body, &definition, &polygon);
        }
    }
    static b2Polygon polygon_of(const Shape& shape) {
        if (const auto* box = std::get_if<Box>(&shape))
            return b2MakeBox(static_cast<float>(box->width / 2), static_cast<float>(box->height / 2));
        const Polygon polygon = recentred(std::get<Polygon>(shape));
        std::vector<b2Vec2> points;
        for (const Vec2 vertex : polygon.vertices) points.push_back(as_b2(vertex));
        const b2Hull hull = b2ComputeHull(points.data(), static_cast<int>(points.size()));
        return b2MakePolygon(&hull, static_cast<float>(polygon.radius));
    }
    /// Contacts that began in the last step, and what the walls gave in it.
    void count() {
        const b2ContactEvents events = b2World_GetContactEvents(world_);
        for (int i = 0; i < events.beginCount; ++i) {
            ++counts_.impacts;
            counts_.wall_impacts +=
                is_wall(events.beginEvents[i].shapeIdA) || is_wall(events.beginEvents[i].shapeIdB);
        }
        if (!b2Body_IsValid(walls_)) return;
        contacts_.resize(static_cast<std::size_t>(b2Body_GetContactCapacity(walls_)));
        const int count = b2Body_GetContactData(walls_, contacts_.data(), static_cast<int>(contacts_.size()));
        for (int i = 0; i < count; ++i) {
            const b2Manifold& manifold = contacts_[static_cast<std::size_t>(i)].manifold;
            for (int k = 0; k < manifold.pointCount; ++k)
                counts_.wall_impulse +=
                    impulse_of(contacts_[static_cast<std::size_t>(i)], manifold.points[k]);
        }
    }
    /// Its total has the impulse of a substep twice, after the solve and after the relaxing sweep: so half of
    /// it is what a body gives that rests. Of a hit it has .5 to 2.2 times that, by where in the step it
    /// falls, and of what restitution adds nothing: what walls give bodies that bounce cannot be known.
    static double impulse_of(const b2ContactData& contact, const b2ManifoldPoint& point) {
        const bool bounces =
            b2Shape_GetRestitution(contact.shapeIdA) > 0 || b2Shape_GetRestitution(contact.shapeIdB) > 0;
        return bounces ? NAN : double{point.totalNormalImpulse} / 2;
    }
    bool is_wall(b2ShapeId shape) const {
        return b2Shape_IsValid(shape) && B2_ID_EQUALS(b2Shape_GetBody(shape), walls_);
    }

    int substeps_;
    bool keeps_counts_;
    PeerCounts counts_;
    std::vector<b2ContactData> contacts_;
    b2BodyId walls_{}, ground_{};
    b2WorldId world_{};
    std::vector<b2BodyId> bodies_;
};

std::unique_ptr<Peer> make(const BenchScene& scene, const PeerSettings& settings) {
    require_solids_and_plain_joints(scene.scene);
    return std::make_unique<Box2d3Peer>(scene, settings);
}

}  // namespace

PeerEngine box2d_3_engine() {
    const b2Version version = b2GetVersion();
    return {.family = "Box2D 3",
            .name = "Box2D 3",
            .version = measure::format("%d.%d.%d", version.major, version.minor, version.revision),
            .settings = measure::format(
                "%d.%d.%d, single precision, one worker, %d substeps, continuous collision off, no "
                "threshold of restitution",
                version.major, version.minor, version.revision, kSubsteps),
            .most_bodies = 262'140,  // awake, that one worker can hold; beyond, it is wrong without saying so
            .precision = Precision::single_,
            .substeps = {kSubsteps, 1, 2, 8, 16},
            .iterations = {1},
            .make = &make};
}

}  // namespace carom::bench
