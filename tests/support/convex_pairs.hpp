#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "isa/select_isa.hpp"
#include "state/columns/column.hpp"
#include "support/convex_oracle.hpp"
#include "support/draw.hpp"

// Pairs of convex shapes for kernels that find manifolds, each pair with two bodies of its own, and random
// ones of every class.

namespace carom::test {

/// What a kernel has found for one pair.
struct FoundManifold {
    Vec2 normal;
    double lever_a[2], lever_b[2], lever_a_t, lever_b_t, separation[2];

    bool is_live() const { return separation[0] < 1e29; }
    bool has_two() const { return separation[1] < 1e29; }
    int lowest() const { return separation[1] < separation[0] ? 1 : 0; }
};

/// Pairs with a block of sentinels behind the last.
template <class Real>
class ConvexPairs {
  public:
    static constexpr Real kSentinel = Real(-77);

    explicit ConvexPairs(std::size_t count)
        : count_(count),
          pose_(4 * (2 * count + 1)),
          a_(padded(count) + 16),
          b_(a_.size()),
          margin_(a_.size()) {
        shapes_.resize(2 * count + 1), shape_.resize(2 * count + 1);
        for (std::size_t row = 0; row < shape_.size(); ++row) shape_[row] = static_cast<std::int32_t>(row);
        shapes_[2 * count] = make_convex_shape<Real>({{0, 0}}, 1);
        pose_[4 * 2 * count + 2] = 1;
        for (std::size_t p = 0; p < a_.size(); ++p)
            a_[p] = b_[p] = static_cast<std::int32_t>(2 * count), margin_[p] = 0;
        for (Column<Real>& column : out_) {
            column.resize(a_.size());
            std::fill(column.begin(), column.end(), kSentinel);
        }
    }

    std::size_t count() const { return count_; }

    void set(std::size_t i, const ConvexShape<Real>& a, const ConvexShape<Real>& b, double margin) {
        shapes_[2 * i] = a, shapes_[2 * i + 1] = b;
        a_[i] = static_cast<std::int32_t>(2 * i), b_[i] = a_[i] + 1;
        margin_[i] = static_cast<Real>(margin);
    }
    void swap(std::size_t i) { std::swap(a_[i], b_[i]); }
    void put(std::size_t row, Vec2 centre, double angle) {
        Real* pose = pose_.data() + 4 * row;
        pose[0] = static_cast<Real>(centre.x), pose[1] = static_cast<Real>(centre.y);
        pose[2] = static_cast<Real>(std::cos(angle)), pose[3] = static_cast<Real>(std::sin(angle));
    }

    Real* pose() { return pose_.data(); }
    ConvexShape<Real>& shape(std::size_t row) { return shapes_[row]; }
    double margin(std::size_t i) const { return margin_[i]; }
    PlacedShape placed(std::size_t row) const { return place(shapes_[row], pose_.data() + 4 * row); }
    PlacedShape placed_a(std::size_t i) const { return placed(static_cast<std::size_t>(a_[i])); }
    PlacedShape placed_b(std::size_t i) const { return placed(static_cast<std::size_t>(b_[i])); }

    FindManifolds<Real> arguments() {
        const auto at = [&](std::size_t i) { return out_[i].data(); };
        return {pose_.data(),   nullptr,
                shape_.data(),  shapes_.data(),
                a_.data(),      b_.data(),
                margin_.data(), {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), at(9)}};
    }
    FoundManifold found(std::size_t i) const {
        const auto at = [&](std::size_t column) { return static_cast<double>(out_[column][i]); };
        const double none = at(9) > 1e29 ? 1e30 : at(9);
        return {{at(0), at(1)}, {at(2), at(3)}, {at(4), at(5)}, at(6), at(7), {at(8), none}};
    }
    bool is_rest_untouched() const {
        for (const Column<Real>& column : out_)
            for (std::size_t p = padded(count_); p < column.size(); ++p)
                if (column[p] != kSentinel) return false;
        return true;
    }
    /// Whether all that a kernel has written has the same bits.
    bool equals(const ConvexPairs& other) const {
        for (std::size_t column = 0; column < 10; ++column)
            if (std::memcmp(out_[column].data(), other.out_[column].data(), padded(count_) * sizeof(Real)) !=
                0)
                return false;
        return true;
    }

  private:
    std::size_t count_;
    std::vector<ConvexShape<Real>> shapes_;
    std::vector<std::int32_t> shape_;
    Column<Real> pose_;
    Column<std::int32_t> a_, b_;
    Column<Real> margin_;
    Column<Real> out_[10];
};

enum class ShapeKind { disc, capsule, box, rounded_box, triangle, polygon, octagon, thin };

/// Vertices about the centre of mass of the polygon.
inline std::vector<Vec2> centred(std::vector<Vec2> vertices) {
    double area = 0;
    Vec2 moment;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec2 v = vertices[i], w = vertices[(i + 1) % vertices.size()];
        area += cross(v, w) / 2, moment += cross(v, w) / 6 * (v + w);
    }
    for (Vec2& v : vertices) v -= 1 / area * moment;
    return vertices;
}

template <class Real>
ConvexShape<Real> draw_shape(ShapeKind kind, Draw& draw, double size) {
    const auto box = [](double w, double h) { return std::vector<Vec2>{{-w, -h}, {w, -h}, {w, h}, {-w, h}}; };
    const auto polygon = [&](std::size_t count, double spread) {
        std::vector<Vec2> vertices;
        for (std::size_t i = 0; i < count; ++i) {
            const double angle =
                6.283185307 / static_cast<double>(count) * (static_cast<double>(i) + draw(0, spread));
            vertices.push_back({size * std::cos(angle), size * std::sin(angle)});
        }
        return centred(vertices);
    };
    switch (kind) {
        case ShapeKind::disc:
            return make_convex_shape<Real>({{0, 0}}, size);
        case ShapeKind::capsule: {
            const double half = size * draw(0.3, 3);
            return make_convex_shape<Real>({{-half, 0}, {half, 0}}, size * draw(0.2, 1));
        }
        case ShapeKind::box:
            return make_convex_shape<Real>(box(size, size * draw(0.2, 1)), 0);
        case ShapeKind::rounded_box:
            return make_convex_shape<Real>(box(size, size * draw(0.2, 1)), size * draw(0.02, 0.5));
        case ShapeKind::triangle:
            return make_convex_shape<Real>(polygon(3, 0.6), 0);
        case ShapeKind::polygon:
            return make_convex_shape<Real>(polygon(3 + draw.below(6), 0.5), 0);
        case ShapeKind::octagon:
            return make_convex_shape<Real>(polygon(8, 0), size * draw(0, 0.2));
        case ShapeKind::thin:
            return make_convex_shape<Real>(box(size, 0.01 * size), 0);
    }
    return {};
}

/// Random pairs of two kinds: near each other, overlapping or apart, with as many degenerate ones: parallel
/// faces, shared vertices, coincident centres, equal shapes.
template <class Real>
void draw_pairs(ConvexPairs<Real>& pairs, ShapeKind of_a, ShapeKind of_b, double greatest_ratio,
                unsigned seed) {
    Draw draw(seed);
    for (std::size_t i = 0; i < pairs.count(); ++i) {
        const ConvexShape<Real> a = draw_shape<Real>(of_a, draw, 1);
        const ConvexShape<Real> b =
            draw_shape<Real>(of_b, draw, draw.size(1 / greatest_ratio, greatest_ratio));
        const double smaller = std::min(a.inradius, b.inradius);
        const bool as_drawn = i % 8 != 7;
        pairs.set(i, a, as_drawn ? b : a, smaller * draw(0, 2));
        const double turn_a = i % 4 == 0 ? 0 : draw(-3.2, 3.2);
        const double turn_b =
            i % 4 == 0 ? 1.5707963 * static_cast<double>(draw.below(4)) + (i % 3 == 0 ? draw(-1e-3, 1e-3) : 0)
                       : draw(-3.2, 3.2);
        pairs.put(2 * i, {draw(-3, 3), draw(-3, 3)}, turn_a);
        pairs.put(2 * i + 1, {0, 0}, turn_b);
        // In a random direction, at such a distance that the gap of the shapes is near the one that is
        // wanted.
        const double wanted = i % 5 == 0 ? 0 : smaller * (i % 5 == 1 ? draw(-2, 0) : draw(-0.3, 1.5));
        const double heading = i % 7 == 0 ? 1.5707963 * static_cast<double>(draw.below(4)) : draw(-3.2, 3.2);
        const PlacedShape placed = pairs.placed(2 * i);
        const Vec2 way{std::cos(heading), std::sin(heading)};
        double near = 0, far = 3 * static_cast<double>(a.extent + pairs.shape(2 * i + 1).extent);
        for (int k = 0; k < 8; ++k) {
            const double middle = 0.5 * (near + far);
            pairs.put(2 * i + 1, placed.centre + middle * way, turn_b);
            (signed_distance(placed, pairs.placed(2 * i + 1), wanted) < wanted ? near : far) = middle;
        }
        if (i % 16 == 15) pairs.put(2 * i + 1, placed.centre, turn_b);
        if (i % 16 == 3) {  // a vertex of both at the same place
            const PlacedShape b_there = pairs.placed(2 * i + 1);
            const Vec2 vertex = placed.vertices[draw.below(placed.vertices.size())];
            const Vec2 other = b_there.vertices[draw.below(b_there.vertices.size())];
            pairs.put(2 * i + 1, b_there.centre + (vertex - other), turn_b);
        }
    }
}

}  // namespace carom::test
