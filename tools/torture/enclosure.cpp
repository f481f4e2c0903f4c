#include "torture/enclosure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace carom::torture {
namespace {

Vec2 minus(Vec2 a, Vec2 b) {
    return {a.x - b.x, a.y - b.y};
}

double cross(Vec2 a, Vec2 b) {
    return a.x * b.y - a.y * b.x;
}

Vec2 unit(Vec2 a) {
    const double length = std::hypot(a.x, a.y);
    return {a.x / length, a.y / length};
}

}  // namespace

double Enclosure::clearance(Vec2 point) const {
    double nearest = 1e300;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Vec2 a = corners_[i], along = unit(minus(corners_[(i + 1) % corners_.size()], a));
        nearest = std::fmin(nearest, cross(along, minus(point, a)));
    }
    return nearest;
}

double Enclosure::lowest_centre(double radius) const {
    // The corners of the polygon whose edges are moved inwards by the radius.
    double lowest = 1e300;
    const std::size_t count = corners_.size();
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2 in = unit(minus(corners_[i], corners_[(i + count - 1) % count])),
                   out = unit(minus(corners_[(i + 1) % count], corners_[i]));
        const double turn = cross(in, out);  // sine of the angle between the edges
        lowest = std::fmin(lowest, corners_[i].y + radius * (out.y - in.y) / turn);
    }
    return lowest;
}

double Enclosure::area() const {
    double twice = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i)
        twice += cross(corners_[i], corners_[(i + 1) % corners_.size()]);
    return 0.5 * twice;
}

Vec2 Enclosure::low() const {
    Vec2 low{1e300, 1e300};
    for (const Vec2 p : corners_) low = {std::fmin(low.x, p.x), std::fmin(low.y, p.y)};
    return low;
}

Vec2 Enclosure::high() const {
    Vec2 high{-1e300, -1e300};
    for (const Vec2 p : corners_) high = {std::fmax(high.x, p.x), std::fmax(high.y, p.y)};
    return high;
}

void Enclosure::add_to(Scene& scene, const Material& material) const {
    if (fence_ == Fence::walls) {
        scene.walls = Walls{.min = low(), .max = high(), .material = material};
        return;
    }
    Body edge;
    edge.type = BodyType::static_body, edge.material = material;
    if (fence_ == Fence::chain) {
        edge.shape = Chain{corners_, true};
        scene.add(edge);
        return;
    }
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        edge.shape = Segment{corners_[i], corners_[(i + 1) % corners_.size()]};
        scene.add(edge);
    }
}

Enclosure box_of(Fence fence, double width, double height) {
    return {fence, {{0, 0}, {width, 0}, {width, height}, {0, height}}};
}

Enclosure polygon_of(Fence fence, int sides, double area, double angle) {
    const double each = 2 * std::numbers::pi / sides;
    const double circumradius = std::sqrt(2 * area / (sides * std::sin(each)));
    std::vector<Vec2> corners;
    for (int i = 0; i < sides; ++i)
        corners.push_back(
            {circumradius * std::cos(angle + each * i), circumradius * std::sin(angle + each * i)});
    return {fence, corners};
}

}  // namespace carom::torture
