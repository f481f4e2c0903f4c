#include "simulation/outlines.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace carom::tool {

ShapeOutline outline_of(const Shape& shape) {
    if (const auto* box = std::get_if<Box>(&shape)) {
        const double x = box->width / 2, y = box->height / 2;
        return {{{-x, -y}, {x, -y}, {x, y}, {-x, y}}, 0};
    }
    if (const auto* capsule = std::get_if<Capsule>(&shape))
        return {{{-capsule->length / 2, 0}, {capsule->length / 2, 0}}, capsule->radius};
    if (const auto* polygon = std::get_if<Polygon>(&shape)) {
        Polygon centred = recentred(*polygon);
        return {std::move(centred.vertices), centred.radius};
    }
    return {};
}

double extent_of(const Shape& shape) {
    if (const auto* disc = std::get_if<Disc>(&shape)) return disc->radius;
    const ShapeOutline outline = outline_of(shape);
    double extent = 0;
    for (const Vec2 vertex : outline.vertices) extent = std::max(extent, std::hypot(vertex.x, vertex.y));
    return extent + outline.radius;
}

Outlines outlines_of(const std::vector<Body>& bodies) {
    Outlines outlines;
    std::map<std::vector<double>, double> known;  // by all numbers of an outline
    for (std::size_t body = 0; body < bodies.size(); ++body) {
        ShapeOutline outline = outline_of(bodies[body].shape);
        if (outline.vertices.empty()) continue;
        std::vector<double> numbers{outline.radius};
        for (const Vec2 vertex : outline.vertices) numbers.insert(numbers.end(), {vertex.x, vertex.y});
        const auto [found, is_new] = known.try_emplace(numbers, static_cast<double>(outlines.shapes.size()));
        if (is_new) outlines.shapes.push_back(std::move(outline));
        if (outlines.of_body.empty()) outlines.of_body.assign(bodies.size(), -1);
        outlines.of_body[body] = found->second;
    }
    return outlines;
}

}  // namespace carom::tool
