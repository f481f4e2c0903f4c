#pragma once

#include <carom/carom.hpp>

#include <cmath>
#include <vector>

#include "byte_source.hpp"

// What a script of calls hands to a world: bodies, joints and scenes from bytes. Most of it is sound, so that
// worlds come to be; some of it is beyond every limit.

namespace carom::fuzz {

inline Material material_from(ByteSource& bytes) {
    Material material;
    const std::uint8_t parts = bytes.byte();
    if (parts & 1) material.friction = bytes.size(0.1);
    if (parts & 2) material.restitution = bytes.byte() / 250.0;  // above 1 now and then
    if (parts & 4) material.rolling_resistance = bytes.size(0.05);
    if (parts & 8) material.density = bytes.size(1);
    return material;
}

inline std::vector<Vec2> points_from(ByteSource& bytes, std::size_t most) {
    std::vector<Vec2> points;
    const std::size_t count = bytes.below(most + 1);
    for (std::size_t i = 0; i < count; ++i) points.push_back(bytes.point(0.5));
    return points;
}

/// A regular polygon, or any points.
inline Polygon polygon_from(ByteSource& bytes) {
    constexpr double kTurn = 2 * 3.14159265358979;  // rad
    Polygon polygon;
    const std::size_t corners = bytes.below(12);
    if (corners < 3) {
        polygon.vertices = points_from(bytes, 9);
    } else {
        const double radius = bytes.size(0.2);
        for (std::size_t i = 0; i < corners; ++i) {
            const double angle = kTurn * static_cast<double>(i) / static_cast<double>(corners);
            polygon.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle)});
        }
    }
    if (bytes.once_in(3)) polygon.radius = bytes.size(0.05);
    return polygon;
}

inline Compound compound_from(ByteSource& bytes) {
    Compound compound;
    const std::size_t pieces = bytes.below(5);
    for (std::size_t i = 0; i < pieces; ++i) {
        Piece piece;
        switch (bytes.below(4)) {
            case 0:
                piece.shape = Disc{bytes.size(0.1)};
                break;
            case 1:
                piece.shape = Box{bytes.size(0.2), bytes.size(0.2)};
                break;
            case 2:
                piece.shape = Capsule{bytes.size(0.2), bytes.size(0.1)};
                break;
            default:
                piece.shape = polygon_from(bytes);
        }
        piece.position = bytes.point(0.2);
        piece.angle = bytes.number(1);
        if (bytes.once_in(4)) piece.material = material_from(bytes);
        compound.pieces.push_back(piece);
    }
    return compound;
}

inline Shape shape_from(ByteSource& bytes) {
    switch (bytes.below(12)) {
        case 0:
            return Segment{bytes.point(1), bytes.point(1)};
        case 1: {
            std::vector<Vec2> points = points_from(bytes, 8);
            return Chain{std::move(points), bytes.flag()};
        }
        case 2:
        case 3:
        case 4:
            return Box{bytes.size(0.2), bytes.size(0.2)};
        case 5:
            return Capsule{bytes.size(0.2), bytes.size(0.1)};
        case 6:
            return polygon_from(bytes);
        case 7:
            return compound_from(bytes);
        default:
            return Disc{bytes.size(0.1)};
    }
}

inline Filter filter_from(ByteSource& bytes) {
    Filter filter;
    const std::uint8_t parts = bytes.byte();
    if (parts & 1) filter.group = static_cast<std::int8_t>(bytes.byte());
    if (parts & 2) filter.category = static_cast<std::uint16_t>(bytes.word());
    if (parts & 4) filter.mask = static_cast<std::uint16_t>(bytes.word());
    return filter;
}

inline Body body_from(ByteSource& bytes) {
    Body body;
    body.shape = shape_from(bytes);
    const bool is_line =
        std::holds_alternative<Segment>(body.shape) || std::holds_alternative<Chain>(body.shape);
    const std::size_t type = bytes.below(10);
    if (type == 8 || (is_line && type < 7)) body.type = BodyType::static_body;
    if (type == 9) body.type = BodyType::kinematic_body;
    body.position = bytes.point(1);
    const std::uint8_t parts = bytes.byte();
    if (parts & 1) body.velocity = bytes.point(1);
    if (parts & 2) body.angle = bytes.number(1);
    if (parts & 4) body.angular_velocity = bytes.number(2);
    if (parts & 8) body.mass = bytes.size(0.5);
    if (parts & 16) body.material = material_from(bytes);
    if (parts & 32) {
        const Filter filter = filter_from(bytes);
        body.group = filter.group, body.category = filter.category, body.mask = filter.mask;
    }
    body.fixed_rotation = (parts & 192) == 64;
    body.sensor = (parts & 192) == 192 && bytes.flag();
    return body;
}

inline JointKind joint_kind_from(ByteSource& bytes, const std::vector<JointId>& joints) {
    const auto spring = [&](auto& joint) {
        if (bytes.flag()) joint.frequency = bytes.size(1), joint.damping_ratio = bytes.size(0.2);
    };
    const auto point = [&]() -> std::optional<Vec2> {
        if (bytes.flag()) return std::nullopt;
        return bytes.point(1);
    };
    const auto limits = [&](auto& joint) {
        if (bytes.flag()) joint.lower = bytes.number(0.3), joint.upper = bytes.number(0.3);
    };
    switch (bytes.below(7)) {
        case 0: {
            DistanceJoint joint{.anchor_a = bytes.point(0.2), .anchor_b = bytes.point(0.2)};
            joint.length = bytes.some(0.5), joint.min = bytes.some(0.3), joint.max = bytes.some(0.5);
            spring(joint);
            return joint;
        }
        case 1: {
            RevoluteJoint joint{.anchor = point()};
            limits(joint), spring(joint);
            joint.motor_speed = bytes.some(2);
            if (joint.motor_speed) joint.max_motor_torque = bytes.size(2);
            return joint;
        }
        case 2: {
            PrismaticJoint joint{.axis = bytes.point(1), .anchor = point()};
            limits(joint), spring(joint);
            joint.motor_speed = bytes.some(2);
            if (joint.motor_speed) joint.max_motor_force = bytes.size(2);
            return joint;
        }
        case 3: {
            WeldJoint joint{.anchor = point()};
            spring(joint);
            return joint;
        }
        case 4: {
            WheelJoint joint{.anchor = point(), .axis = bytes.point(1)};
            spring(joint);
            joint.motor_speed = bytes.some(2);
            if (joint.motor_speed) joint.max_motor_torque = bytes.size(2);
            return joint;
        }
        case 5: {
            TargetJoint joint{.anchor = bytes.point(0.2), .target = bytes.point(1)};
            joint.max_force = bytes.size(10);
            spring(joint);
            return joint;
        }
        default: {
            GearJoint joint{.ratio = bytes.number(1)};
            if (!joints.empty() && bytes.flag())
                joint.first = joints[bytes.below(joints.size())],
                joint.second = joints[bytes.below(joints.size())];
            return joint;
        }
    }
}

inline Joint joint_from(ByteSource& bytes, const std::vector<BodyId>& bodies,
                        const std::vector<JointId>& joints) {
    Joint joint;
    const auto body = [&]() -> std::optional<BodyId> {
        if (bodies.empty() || bytes.once_in(4)) return std::nullopt;
        return bodies[bytes.below(bodies.size())];
    };
    joint.a = body(), joint.b = body();
    joint.kind = joint_kind_from(bytes, joints);
    const std::uint8_t parts = bytes.byte();
    joint.collide = (parts & 1) != 0;
    if (parts & 2) joint.break_force = bytes.size(5);
    if (parts & 4) joint.break_torque = bytes.size(5);
    return joint;
}

/// A few bodies of one generator. Counts are small: what many bodies cost is measured elsewhere.
inline void generate_from(ByteSource& bytes, Scene& scene, const std::vector<JointId>& joints) {
    const std::int64_t count = static_cast<std::int64_t>(bytes.below(8)) - 1;  // none and fewer, too
    switch (bytes.below(6)) {
        case 0: {
            Lattice lattice{.count_x = count, .count_y = static_cast<std::int64_t>(bytes.below(4))};
            lattice.origin = bytes.point(1), lattice.spacing = {bytes.size(0.3), bytes.size(0.3)};
            lattice.jitter = bytes.size(0.02), lattice.stagger = bytes.flag();
            if (bytes.flag()) lattice.radius_range = RadiusRange{bytes.size(0.1), bytes.size(0.1)};
            if (bytes.flag()) lattice.velocity_rms = bytes.size(0.5);
            lattice.body = body_from(bytes);
            add_lattice(scene, lattice);
            return;
        }
        case 1: {
            const double gap = bytes.size(0.01);
            add_stack(scene,
                      {.count = count, .origin = bytes.point(1), .gap = gap, .body = body_from(bytes)});
            return;
        }
        case 2: {
            const double gap = bytes.size(0.01);
            add_pyramid(scene,
                        {.base = count % 5, .origin = bytes.point(1), .gap = gap, .body = body_from(bytes)});
            return;
        }
        case 3: {
            Gas gas{.count = count, .radius = {bytes.size(0.1), bytes.size(0.1)}};
            gas.velocity_rms = bytes.size(0.5), gas.seed = bytes.byte(), gas.body = body_from(bytes);
            add_gas(scene, gas);
            return;
        }
        case 4: {
            BodyChain chain{.count = count, .origin = bytes.point(1), .direction = bytes.point(1)};
            chain.spacing = bytes.size(0.2), chain.pinned = bytes.flag();
            chain.link = joint_kind_from(bytes, joints), chain.body = body_from(bytes);
            add_chain(scene, chain);
            return;
        }
        default: {
            Net net{.count_x = count % 4, .count_y = static_cast<std::int64_t>(bytes.below(4))};
            net.origin = bytes.point(1), net.spacing = {bytes.size(0.2), bytes.size(0.2)};
            net.link = joint_kind_from(bytes, joints);
            net.pinned = static_cast<Net::Pinned>(bytes.below(3)), net.body = body_from(bytes);
            add_net(scene, net);
        }
    }
}

inline Solver solver_from(ByteSource& bytes) {
    constexpr Solver kSolvers[] = {Solver::automatic, Solver::soft,     Solver::soft,  Solver::impulse,
                                   Solver::event,     Solver::pairwise, Solver::rigid, Solver::rattle};
    return kSolvers[bytes.below(8)];
}

inline Accuracy accuracy_from(ByteSource& bytes) {
    Accuracy accuracy;
    const std::uint8_t parts = bytes.byte();
    if (parts & 1) accuracy.solver = solver_from(bytes);
    if ((parts & 6) == 6) accuracy.substeps = static_cast<int>(bytes.below(12));
    if ((parts & 24) == 24) accuracy.iterations = static_cast<int>(bytes.below(6));
    return accuracy;
}

inline EffectOverrides effects_from(ByteSource& bytes) {
    EffectOverrides effects;
    for (std::optional<bool>* effect : {&effects.sleep, &effects.ledger, &effects.rotation})
        *effect = bytes.choice();
    if (bytes.once_in(8))
        for (std::optional<bool>* effect :
             {&effects.continuous, &effects.gravity, &effects.drag, &effects.restitution, &effects.friction,
              &effects.rolling_resistance})
            *effect = bytes.choice();
    return effects;
}

inline Scene scene_from(ByteSource& bytes) {
    Scene scene;
    scene.accuracy = accuracy_from(bytes);
    scene.effects = effects_from(bytes);
    const std::uint8_t parts = bytes.byte();
    if (parts & 1) scene.gravity = {0, -10};
    if ((parts & 6) == 6) scene.gravity = bytes.point(2);
    if (parts & 8) {
        scene.walls = Walls{.min = {-4, -4}, .max = {4, 4}};
        const std::uint8_t sides = bytes.byte();
        scene.walls->left = (sides & 1) == 0, scene.walls->right = (sides & 2) == 0;
        scene.walls->bottom = (sides & 4) == 0, scene.walls->top = (sides & 8) == 0;
        if (sides & 16) scene.walls->material = material_from(bytes);
        if ((sides & 96) == 96) scene.walls->min = bytes.point(1), scene.walls->max = bytes.point(1);
    }
    if (parts & 16) scene.drag = {bytes.size(0.1), bytes.size(0.1)};
    if ((parts & 224) == 224) scene.events.sensor = bytes.flag();
    return scene;
}

}  // namespace carom::fuzz
