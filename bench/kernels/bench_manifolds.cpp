#include "kernels/kernel_benchmark.hpp"
#include "shapes/convex_shape.hpp"
#include "state/columns/column.hpp"

#include <cmath>
#include <random>
#include <vector>

// The kernels that find where convex shapes touch. Items are pairs; each body is in about two of them, in a
// row of bodies of which neighbours nearly touch, turned at random or by quarters.

namespace carom::bench {
namespace {

/// A regular polygon with a vertex at distance 1 m from its centre; of four vertices a box of 1 m by 1.5 m.
template <class Real>
ConvexShape<Real> make_shape(int count, double radius) {
    ConvexShape<Real> shape{};
    double x[kMostVertices], y[kMostVertices];
    for (int i = 0; i < kMostVertices; ++i) {
        const double angle = 2 * 3.14159265358979 * ((i < count ? i : count - 1) + 0.5) / count;
        x[i] = std::cos(angle) * (count == 4 ? std::sqrt(0.5) : 1);
        y[i] = std::sin(angle) * (count == 4 ? 1.5 * std::sqrt(0.5) : 1);
    }
    double inradius = 1e9;
    for (int i = 0; i < kMostVertices; ++i) {
        const int at = i < count ? i : count - 1, next = (at + 1) % count;
        const double along_x = x[next] - x[at], along_y = y[next] - y[at],
                     length = std::hypot(along_x, along_y);
        shape.x[i] = static_cast<Real>(x[i]), shape.y[i] = static_cast<Real>(y[i]);
        shape.normal_x[i] = static_cast<Real>(along_y / length);
        shape.normal_y[i] = static_cast<Real>(-along_x / length);
        inradius = std::fmin(inradius, (along_y * x[at] - along_x * y[at]) / length);
    }
    shape.radius = static_cast<Real>(radius), shape.inradius = static_cast<Real>(inradius + radius);
    shape.extent = static_cast<Real>(1.1 + radius), shape.count = count;
    return shape;
}

/// Pairs of neighbours of a row of bodies.
template <class Real>
struct ConvexRow {
    ConvexRow(std::size_t pairs, int vertices, double radius)
        : shape_of(pairs + 1), pose(4 * (pairs + 1)), margin(pairs), a(pairs), b(pairs) {
        shapes.push_back(make_shape<Real>(vertices, radius));
        std::mt19937 random(31);
        std::uniform_real_distribution<double> unit(-1, 1);
        for (std::size_t row = 0; row <= pairs; ++row) {
            const double turn = row % 2 == 0 ? 0.01 * unit(random) : 3.14 * unit(random);
            Real* at = pose.data() + 4 * row;
            at[0] = static_cast<Real>(1.5 * static_cast<double>(row % 1024) + 0.2 * unit(random));
            at[1] = static_cast<Real>(0.2 * unit(random));
            at[2] = static_cast<Real>(std::cos(turn)), at[3] = static_cast<Real>(std::sin(turn));
        }
        for (std::size_t p = 0; p < pairs; ++p) {
            a[p] = static_cast<std::int32_t>(p), b[p] = static_cast<std::int32_t>(p + 1);
            margin[p] = Real(0.05);
        }
        for (Column<Real>& column : out) column.resize(pairs);
    }

    FindManifolds<Real> arguments() {
        const auto at = [&](std::size_t i) { return out[i].data(); };
        return {.pose = pose.data(),
                .come = nullptr,
                .shape = shape_of.data(),
                .shapes = shapes.data(),
                .a = a.data(),
                .b = b.data(),
                .margin = margin.data(),
                .out = {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), at(9)}};
    }

    std::vector<ConvexShape<Real>> shapes;
    Column<std::int32_t> shape_of;
    Column<Real> pose, margin;
    Column<std::int32_t> a, b;
    Column<Real> out[10];
};

/// @param operations  of a pair
template <class Real, class Pick>
void find(benchmark::State& state, const KernelTable<Real>& table, int vertices, double radius,
          double operations, const Pick& pick) {
    const auto items = static_cast<std::size_t>(state.range(0));
    ConvexRow<Real> row(items, vertices, radius);
    const FindManifolds<Real> arguments = row.arguments();
    const auto kernel = pick(*table.convex);
    const double hits = static_cast<double>(kernel(arguments, 0, items)) / static_cast<double>(items);
    // rows; two poses, margin, ten columns
    const measure::Work work{.bytes = 8 + 19 * sizeof(Real), .operations = operations};
    const std::size_t held = 12 + 15 * sizeof(Real);
    time_kernel(state, {work, items, held * items, hits},
                [&] { benchmark::DoNotOptimize(kernel(arguments, 0, items)); });
}

/// Operations of a pair of polygons: both project all vertices on all normals, place b and look for the
/// incident edge; then there is the face.
constexpr double operations_of(int vertices) {
    return 2 * 4 * vertices * vertices + (14 + 2 * 5 + 3) * vertices + 130;
}

const bool kAdded = [] {
    const auto add = [](const char* name, int vertices, double radius) {
        add_kernel(name, false, [=](auto& state, const auto& table) {
            find(state, table, vertices, radius, operations_of(vertices),
                 [](const auto& kernels) { return kernels.find_manifolds; });
        });
    };
    add_kernel("find_box_manifolds", false, [](auto& state, const auto& table) {
        find(state, table, 4, 0, 200, [](const auto& kernels) { return kernels.find_box_manifolds; });
    });
    add("find_manifolds_of_boxes", 4, 0);
    add("find_manifolds_of_capsules", 2, 0.3);
    add("find_manifolds_of_octagons", 8, 0.1);
    return true;
}();

}  // namespace
}  // namespace carom::bench
