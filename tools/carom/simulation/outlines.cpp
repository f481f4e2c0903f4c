#include "simulation/outlines.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace carom::tool {

namespace {

ShapeOutline outline_of(const Shape& shape) {
    if (const auto* box = std::get_if<Box>(&shape)) {
        const double x = box->width / 2, y = box->height / 2;
        return {{{-x, -y}, {x, -y}, {x, y}, {-x, y}}, 0, {}};
    }
    if (const auto* capsule = std::get_if<Capsule>(&shape))
        return {{{-capsule->length / 2, 0}, {capsule->length / 2, 0}}, capsule->radius, {}};
    if (const auto* polygon = std::get_if<Polygon>(&shape)) {
        Polygon centred = recentred(*polygon);
        return {std::move(centred.vertices), centred.radius, {}};
    }
    return {};
}

/// A piece in the frame of its body; a disc is one vertex.
ShapeOutline outline_of(const Piece& piece) {
    ShapeOutline outline =
        std::visit([](const auto& shape) { return outline_of(Shape(shape)); }, piece.shape);
    if (const auto* disc = std::get_if<Disc>(&piece.shape)) outline = {{{}}, disc->radius, {}};
    const double cos = std::cos(piece.angle), sin = std::sin(piece.angle);
    for (Vec2& v : outline.vertices)
        v = {piece.position.x + cos * v.x - sin * v.y, piece.position.y + sin * v.x + cos * v.y};
    return outline;
}

void add_numbers(const ShapeOutline& outline, std::vector<double>& numbers) {
    numbers.push_back(outline.radius), numbers.push_back(static_cast<double>(outline.vertices.size()));
    for (const Vec2 vertex : outline.vertices) numbers.insert(numbers.end(), {vertex.x, vertex.y});
    for (const ShapeOutline& piece : outline.pieces) add_numbers(piece, numbers);
}

double extent_of(const ShapeOutline& outline) {
    double extent = 0;
    for (const Vec2 vertex : outline.vertices) extent = std::max(extent, std::hypot(vertex.x, vertex.y));
    extent += outline.radius;
    for (const ShapeOutline& piece : outline.pieces) extent = std::max(extent, extent_of(piece));
    return extent;
}

}  // namespace

ShapeOutline outline_of(const Body& body) {
    const auto* compound = std::get_if<Compound>(&body.shape);
    if (!compound) return outline_of(body.shape);
    ShapeOutline outline;
    for (const Piece& piece : recentred(*compound, body.material).pieces)
        outline.pieces.push_back(outline_of(piece));
    return outline;
}

double extent_of(const Body& body) {
    if (const auto* disc = std::get_if<Disc>(&body.shape)) return disc->radius;
    return extent_of(outline_of(body));
}

Outlines outlines_of(const std::vector<Body>& bodies) {
    Outlines outlines;
    std::map<std::vector<double>, double> known;  // by all numbers of an outline
    for (std::size_t body = 0; body < bodies.size(); ++body) {
        ShapeOutline outline = outline_of(bodies[body]);
        if (outline.vertices.empty() && outline.pieces.empty()) continue;
        std::vector<double> numbers;
        add_numbers(outline, numbers);
        const auto [found, is_new] = known.try_emplace(numbers, static_cast<double>(outlines.shapes.size()));
        if (is_new) outlines.shapes.push_back(std::move(outline));
        if (outlines.of_body.empty()) outlines.of_body.assign(bodies.size(), -1);
        outlines.of_body[body] = found->second;
    }
    return outlines;
}

}  // namespace carom::tool
