#include "torture/worlds/shapes.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace carom::torture {
namespace {

constexpr std::array kPieces{ShapeKind::disc, ShapeKind::box, ShapeKind::capsule, ShapeKind::polygon};

/// Longer over shorter side: mostly below 5, at times up to 50.
double random_aspect(Random& random) {
    return random.skewed(1, 50, 2);
}

Polygon random_polygon(double size, Random& random) {
    const int corners = 3 + static_cast<int>(random.below(6));
    const double flatness = random.uniform(0.3, 1);
    Polygon polygon;
    // Corners on an ellipse make a convex polygon, whatever their angles.
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi / corners * (i + random.uniform(-0.3, 0.3));
        polygon.vertices.push_back({size * std::cos(angle), flatness * size * std::sin(angle)});
    }
    const double radius = size * random.uniform(0.01, 0.3);
    if (random.chance(0.3)) polygon.radius = radius;
    return polygon;
}

Compound random_compound(double size, Random& random) {
    const std::size_t pieces = 2 + random.below(4);
    Compound compound;
    Vec2 at{};
    for (std::size_t i = 0; i < pieces; ++i) {
        const double share = random.uniform(0.2, 0.6) * size;
        Piece piece{.position = at, .angle = random.uniform(0, 2 * std::numbers::pi)};
        std::visit(
            [&](auto&& shape) {
                using Kind = std::decay_t<decltype(shape)>;
                if constexpr (std::is_constructible_v<decltype(piece.shape), Kind>) piece.shape = shape;
            },
            random_shape(random.one_of<ShapeKind>(kPieces), share, random));
        compound.pieces.push_back(piece);
        const double angle = random.uniform(0, 2 * std::numbers::pi);
        at = {at.x + 0.7 * share * std::cos(angle), at.y + 0.7 * share * std::sin(angle)};
    }
    return compound;
}

}  // namespace

Shape random_shape(ShapeKind kind, double size, Random& random) {
    switch (kind) {
        case ShapeKind::disc:
            return Disc{size};
        case ShapeKind::box: {
            const double aspect = random_aspect(random), height = 2 * size / std::hypot(1, aspect);
            return Box{aspect * height, height};
        }
        case ShapeKind::capsule: {
            const double radius = size / (random_aspect(random) + 0.2);
            return Capsule{2 * (size - radius), radius};
        }
        case ShapeKind::polygon:
            return random_polygon(size, random);
        case ShapeKind::compound:
            return random_compound(size, random);
    }
    return Disc{size};
}

Shape random_line(double size, Random& random) {
    if (random.chance(0.5)) return Segment{{-size, 0}, {size, 0}};
    const int edges = 2 + static_cast<int>(random.below(5));
    Chain chain;
    for (int i = 0; i <= edges; ++i)
        chain.points.push_back({size * (2. * i / edges - 1), size * random.uniform(-0.4, 0.4)});
    return chain;
}

}  // namespace carom::torture
