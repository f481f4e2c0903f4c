#include "peers/peer.hpp"

#include <carom/errors.hpp>

#include <algorithm>
#include <cmath>
#include <variant>

namespace carom::bench {
namespace {

constexpr double kBlockThickness = 2;   // m: more than any disc moves in a step
constexpr double kBeyondBodies = 1000;  // m: as far as anything comes

/// Walls whose open sides are near enough for engines whose shapes have a few digits.
Walls within_reach(const Scene& scene) {
    Walls walls = *scene.walls;
    Vec2 low = scene.bodies.empty() ? walls.min : scene.bodies.front().position, high = low;
    for (const Body& body : scene.bodies) {
        low = {std::min(low.x, body.position.x), std::min(low.y, body.position.y)};
        high = {std::max(high.x, body.position.x), std::max(high.y, body.position.y)};
    }
    if (!walls.left) walls.min.x = std::max(walls.min.x, low.x - kBeyondBodies);
    if (!walls.right) walls.max.x = std::min(walls.max.x, high.x + kBeyondBodies);
    if (!walls.bottom) walls.min.y = std::max(walls.min.y, low.y - kBeyondBodies);
    if (!walls.top) walls.max.y = std::min(walls.max.y, high.y + kBeyondBodies);
    return walls;
}

}  // namespace

std::vector<PeerEngine> other_engines() {
    std::vector<PeerEngine> engines;
#ifdef CAROM_PEERS_BOX2D_3
    engines.push_back(box2d_3_engine());
#endif
#ifdef CAROM_PEERS_BOX2D_2
    engines.push_back(box2d_2_engine());
#endif
#ifdef CAROM_PEERS_CHIPMUNK
    for (PeerEngine& engine : chipmunk_engines()) engines.push_back(std::move(engine));
#endif
    return engines;
}

std::vector<MissingEngine> missing_engines() {
    std::vector<MissingEngine> missing;
#ifndef CAROM_PEERS_BOX2D_3
    missing.push_back({"Box2D 3", "CMake found no package box2d 3 (-Dbox2d_DIR=... says where it is)"});
#endif
#ifndef CAROM_PEERS_BOX2D_2
    missing.push_back({"Box2D 2", "CMake found no box2d/b2_world.h and libbox2d.so"});
#endif
#ifndef CAROM_PEERS_CHIPMUNK
    missing.push_back({"Chipmunk", "CMake found no chipmunk/chipmunk.h and libchipmunk"});
#endif
    return missing;
}

std::vector<WallBlock> wall_blocks(const Scene& scene) {
    const Walls walls = within_reach(scene);
    const Vec2 middle{(walls.min.x + walls.max.x) / 2, (walls.min.y + walls.max.y) / 2};
    const double half_width = (walls.max.x - walls.min.x) / 2, half_height = (walls.max.y - walls.min.y) / 2;
    constexpr double kHalf = kBlockThickness / 2;
    std::vector<WallBlock> blocks;
    if (walls.left)
        blocks.push_back({{walls.min.x - kHalf, middle.y}, {kHalf, half_height + kBlockThickness}});
    if (walls.right)
        blocks.push_back({{walls.max.x + kHalf, middle.y}, {kHalf, half_height + kBlockThickness}});
    if (walls.bottom)
        blocks.push_back({{middle.x, walls.min.y - kHalf}, {half_width + kBlockThickness, kHalf}});
    if (walls.top) blocks.push_back({{middle.x, walls.max.y + kHalf}, {half_width + kBlockThickness, kHalf}});
    return blocks;
}

std::vector<WallBlock> container_tiles(const Container& container) {
    const double outer = container.side + 2 * container.tile_thickness;
    const auto count = std::max(1.0, std::ceil(outer / container.tile_length));
    const double length = outer / count, away = (container.side + container.tile_thickness) / 2;
    std::vector<WallBlock> tiles;
    for (double i = 0; i < count; ++i) {
        const double along = (i + 0.5) * length - outer / 2;
        const Vec2 lying{length / 2, container.tile_thickness / 2},
            standing{container.tile_thickness / 2, length / 2};
        tiles.push_back({{along, -away}, lying});
        tiles.push_back({{along, away}, lying});
        tiles.push_back({{-away, along}, standing});
        tiles.push_back({{away, along}, standing});
    }
    return tiles;
}

double radius_of(const Body& body) {
    return std::get<Disc>(body.shape).radius;
}

double mass_of(const Body& body) {
    return body.mass.value_or(body.material.density * mass_properties_of(body.shape).area);
}

double inertia_of(const Body& body) {
    const MassProperties shape = mass_properties_of(body.shape);
    return mass_of(body) * shape.second_moment / shape.area;
}

double density_of(const Body& body) {
    return mass_of(body) / mass_properties_of(body.shape).area;
}

bool is_disc(const Body& body) {
    return std::holds_alternative<Disc>(body.shape);
}

void require_dynamic_discs(const Scene& scene) {
    if (!scene.joints.empty())
        throw Error(ErrorCode::not_built_yet, "the adapter of this engine makes no joints");
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        if (scene.bodies[i].type != BodyType::dynamic_body || !is_disc(scene.bodies[i]))
            throw Error(ErrorCode::not_built_yet, "the adapter of this engine makes moving discs; body " +
                                                      std::to_string(i) + " is none");
}

void require_solids_and_plain_joints(const Scene& scene) {
    for (const Body& body : scene.bodies) {
        const bool is_chain = std::holds_alternative<Chain>(body.shape) && body.type == BodyType::static_body;
        if (body.type == BodyType::kinematic_body || (mass_properties_of(body.shape).area == 0 && !is_chain))
            throw Error(
                ErrorCode::not_built_yet,
                "the adapter of this engine makes solids, moving or still, and chains that stand still");
    }
    for (const Joint& joint : scene.joints) {
        const auto* rod = std::get_if<DistanceJoint>(&joint.kind);
        const auto* hinge = std::get_if<RevoluteJoint>(&joint.kind);
        const bool is_plain_rod =
            rod && joint.a && joint.b && !rod->length && !rod->min && !rod->max && !(rod->frequency > 0);
        if (!is_plain_rod && !(hinge && joint.b))
            throw Error(ErrorCode::not_built_yet,
                        "the adapter of this engine makes rigid rods of two bodies and hinges");
    }
}

}  // namespace carom::bench
