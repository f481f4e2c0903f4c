#pragma once

#include "kernels/manifolds/manifold_arguments.hpp"
#include "narrowphase/box_box.hpp"
#include "narrowphase/convex.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// The shapes of as many bodies as there are lanes: where they begin, in records of some Reals.
template <std::size_t kLanes>
struct ShapeRows {
    alignas(64) std::int32_t row[kLanes];
    int most_vertices;
};

template <std::size_t kRecord, class Real, std::size_t kLanes>
[[gnu::always_inline]] inline ShapeRows<kLanes> shape_rows(const FindManifolds<Real>& k,
                                                           const std::int32_t* bodies) {
    constexpr auto kRecords = static_cast<std::int32_t>(sizeof(ConvexShape<Real>) / (kRecord * sizeof(Real)));
    ShapeRows<kLanes> rows{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::int32_t shape = k.shape[bodies[lane]], count = k.shapes[shape].count;
        rows.row[lane] = shape * kRecords;
        rows.most_vertices = rows.most_vertices < count ? count : rows.most_vertices;
    }
    return rows;
}

/// Vertices and normals in the frame of their body.
/// @param last  3 or 7: the place that has every lane's last vertex
template <class Real, class Lanes>
[[gnu::always_inline]] inline void load_polygons(const ConvexShape<Real>* shapes,
                                                 const ShapeRows<Lanes::size>& rows, int last,
                                                 Polygons<typename Lanes::Batch>& polygons) {
    const auto load = [&](const Real* column, typename Lanes::Batch* to) {
        const auto records = Lanes::load_rows4(column, rows.row);
        to[0] = records[0], to[1] = records[1], to[2] = records[2], to[3] = records[3];
    };
    polygons.count = rows.most_vertices, polygons.last = last;
    for (int first = 0; first < last; first += 4) {
        load(shapes->x + first, polygons.x + first), load(shapes->y + first, polygons.y + first);
        load(shapes->normal_x + first, polygons.normal_x + first);
        load(shapes->normal_y + first, polygons.normal_y + first);
    }
}

/// The last four Reals of a shape: its last normal's y, radius, extent and inradius.
template <class Real, class Lanes>
[[gnu::always_inline]] inline typename Lanes::Batch4 load_sizes(const ConvexShape<Real>* shapes,
                                                                const ShapeRows<Lanes::size>& rows) {
    static_assert(offsetof(ConvexShape<Real>, inradius) ==
                  offsetof(ConvexShape<Real>, normal_y) + (kMostVertices + 2) * sizeof(Real));
    return Lanes::load_rows4(shapes->normal_y + kMostVertices - 1, rows.row);
}

/// The cosine and sine of the angle from a to b, and b's centre in the frame of a.
template <class F>
struct RelativePose {
    F cosine, sine, x, y;
};

template <class F, class Pose>
[[gnu::always_inline]] inline RelativePose<F> relative_pose(const Pose& a, const Pose& b) {
    const F dx = b[0] - a[0], dy = b[1] - a[1];
    return {a[2] * b[2] + a[3] * b[3], a[2] * b[3] - a[3] * b[2], a[2] * dx + a[3] * dy,
            a[2] * dy - a[3] * dx};
}

/// Separations of where bodies were before, along the rows that have been found.
template <class Real, class Lanes, class F>
[[gnu::always_inline]] inline void move_back(const FindManifolds<Real>& k, std::size_t p, Manifold<F>& m) {
    const auto a = Lanes::load_rows4(k.come, k.a + p), b = Lanes::load_rows4(k.come, k.b + p);
    const F along = (b[0] - a[0]) * m.normal_x + (b[1] - a[1]) * m.normal_y;
    m.separation1 -= along + b[2] * m.lever_b1 - a[2] * m.lever_a1;
    m.separation2 -=
        along + b[2] * m.lever_b2 - a[2] * m.lever_a2;  // a point that there is not stays at 1e30
}

/// @return how many are live.
template <class Real, class Lanes, class F>
[[gnu::always_inline]] inline std::size_t store_manifolds(const FindManifolds<Real>& k, std::size_t p,
                                                          const Manifold<F>& m) {
    const ManifoldColumns<Real>& out = k.out;
    const auto is_live = simd::min(m.separation1, m.separation2) <= Lanes::load(k.margin + p);
    const F none(static_cast<Real>(kNoPoint));
    Lanes::store(out.normal_x + p, m.normal_x), Lanes::store(out.normal_y + p, m.normal_y);
    Lanes::store(out.lever_a1 + p, m.lever_a1), Lanes::store(out.lever_a2 + p, m.lever_a2);
    Lanes::store(out.lever_b1 + p, m.lever_b1), Lanes::store(out.lever_b2 + p, m.lever_b2);
    Lanes::store(out.lever_a_t + p, m.lever_a_t), Lanes::store(out.lever_b_t + p, m.lever_b_t);
    Lanes::store(out.separation1 + p, simd::select(is_live, m.separation1, none));
    Lanes::store(out.separation2 + p, simd::select(is_live, m.separation2, none));
    return static_cast<std::size_t>(__builtin_popcount(simd::bitmask(is_live)));
}

/// Finds the faces of some pairs, then their points: two chains of operations that wait for each other are
/// too long for a processor to look beyond one batch.
/// @param load  load(p, pose, pair): shapes of pairs p ... in the frame of a
/// @return how many pairs are nearer than their margin.
template <bool kRounded, class Pair, class Real, class Lanes, class Load>
[[gnu::always_inline]] inline std::size_t find_by_faces(const FindManifolds<Real>& k, std::size_t first,
                                                        std::size_t last, const Load& load) {
    using F = typename Lanes::Batch;
    constexpr std::size_t kPairs = 64;  // their faces stay in the first cache
    FacedPair<F> faced[kPairs / Lanes::size];
    std::size_t live = 0;
    for (std::size_t begin = first; begin < last; begin += kPairs) {
        const std::size_t end = last - begin < kPairs ? last : begin + kPairs;
        FacedPair<F>* face = faced;
        for (std::size_t p = begin; p < end; p += Lanes::size, ++face) {
            const auto a = Lanes::load_rows4(k.pose, k.a + p), b = Lanes::load_rows4(k.pose, k.b + p);
            Pair pair;
            load(p, relative_pose<F>(a, b), pair);
            find_face<Real>(pair, *face);
            const F x = face->normal_x, y = face->normal_y;
            face->normal_x = a[2] * x - a[3] * y, face->normal_y = a[3] * x + a[2] * y;
        }
        face = faced;
        for (std::size_t p = begin; p < end; p += Lanes::size, ++face) {
            Manifold<F> m = manifold_of<kRounded, Real>(*face);
            if (k.come) move_back<Real, Lanes>(k, p, m);
            live += store_manifolds<Real, Lanes>(k, p, m);
        }
    }
    return live;
}

/// Manifolds of pairs of convex shapes.
/// @return how many pairs are nearer than their margin.
template <class Real, class Isa>
std::size_t find_manifolds(const FindManifolds<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using Pair = ConvexPair<typename Lanes::Batch>;
    const auto load = [&](std::size_t p, const auto& pose, Pair& pair) {
        const auto of_a = shape_rows<4, Real, Lanes::size>(k, k.a + p);
        const auto of_b = shape_rows<4, Real, Lanes::size>(k, k.b + p);
        const int last_vertex = of_a.most_vertices > 4 || of_b.most_vertices > 4 ? 7 : 3;
        load_polygons<Real, Lanes>(k.shapes, of_a, last_vertex, pair.a);
        load_polygons<Real, Lanes>(k.shapes, of_b, last_vertex, pair.b);
        place(pair.b, pose.cosine, pose.sine, pose.x, pose.y);
        pair.b_x = pose.x, pair.b_y = pose.y;
        const auto sizes_a = load_sizes<Real, Lanes>(k.shapes, of_a);
        const auto sizes_b = load_sizes<Real, Lanes>(k.shapes, of_b);
        pair.radius_a = sizes_a[1], pair.radius_b = sizes_b[1];
        pair.size = simd::min(sizes_a[3], sizes_b[3]);
    };
    return find_by_faces<true, Pair, Real, Lanes>(k, first, last, load);
}

/// Half the sides of boxes: a record of two has the last x and the first y of a corner.
template <class Real, class Lanes>
[[gnu::always_inline]] inline typename Lanes::Batch2 load_half_sides(const FindManifolds<Real>& k,
                                                                     const std::int32_t* bodies) {
    static_assert(offsetof(ConvexShape<Real>, y) == kMostVertices * sizeof(Real));
    const auto rows = shape_rows<2, Real, Lanes::size>(k, bodies);
    const auto corner = Lanes::load_rows2(k.shapes->x + kMostVertices - 1, rows.row);
    return {{simd::abs(corner[0]), simd::abs(corner[1])}};
}

/// The same as find_manifolds() for pairs of which both are boxes: is_box(shape).
template <class Real, class Isa>
std::size_t find_box_manifolds(const FindManifolds<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using Pair = BoxPair<typename Lanes::Batch>;
    const auto load = [&](std::size_t p, const auto& pose, Pair& pair) {
        const auto half_a = load_half_sides<Real, Lanes>(k, k.a + p);
        const auto half_b = load_half_sides<Real, Lanes>(k, k.b + p);
        pair = {pose.cosine, pose.sine, pose.x, pose.y, half_a[0], half_a[1], half_b[0], half_b[1]};
    };
    return find_by_faces<false, Pair, Real, Lanes>(k, first, last, load);
}

}  // namespace
}  // namespace carom
