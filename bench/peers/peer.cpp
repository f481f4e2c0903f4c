#include "peers/peer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

namespace carom::bench {
namespace {

constexpr double kBlockThickness = 2;  // m: more than any disc moves in a step

}  // namespace

std::vector<PeerEngine> peer_engines() {
    std::vector<PeerEngine> engines{carom_engine()};
#ifdef CAROM_BENCH_BOX2D_3
    engines.push_back(box2d_3_engine());
#endif
#ifdef CAROM_BENCH_BOX2D_2
    engines.push_back(box2d_2_engine());
#endif
#ifdef CAROM_BENCH_CHIPMUNK
    for (PeerEngine& engine : chipmunk_engines()) engines.push_back(std::move(engine));
#endif
    return engines;
}

std::vector<WallBlock> wall_blocks(const Walls& walls) {
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
    const double radius = radius_of(body);
    return body.mass.value_or(body.material.density * std::numbers::pi * radius * radius);
}

}  // namespace carom::bench
