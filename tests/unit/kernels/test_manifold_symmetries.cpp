// Manifolds of the same pairs named the other way round, seen in a mirror and turned as a whole.
#include "support/convex_pairs.hpp"
#include "support/effort.hpp"

#include <doctest/doctest.h>

namespace test_manifold_symmetries {

using namespace carom;
using namespace carom::test;

namespace {

using enum ShapeKind;

constexpr ShapeKind kKinds[] = {disc, capsule, box, rounded_box, polygon, octagon};
const std::size_t kCount = scaled<std::size_t>(1500, 500);

void find(ConvexPairs<double>& pairs) {
    runnable_kernel_tables().back()->of<double>().convex->find_manifolds(pairs.arguments(), 0,
                                                                         padded(pairs.count()));
}

ConvexShape<double> mirrored(const ConvexShape<double>& shape) {
    std::vector<Vec2> vertices;
    for (std::int32_t i = shape.count - 1; i >= 0; --i) vertices.push_back({-shape.x[i], shape.y[i]});
    return make_convex_shape<double>(vertices, shape.radius);
}

/// What is found where the points change places, as they do along a tangent that is turned round.
FoundManifold with_points_exchanged(FoundManifold m) {
    if (!m.has_two()) return m;
    std::swap(m.lever_a[0], m.lever_a[1]), std::swap(m.lever_b[0], m.lever_b[1]);
    std::swap(m.separation[0], m.separation[1]);
    return m;
}

/// Whether both are the same but for round-off, which is amplified where a steep edge is cut, and but for
/// quarters of a turn that are given to eight digits: of parallel faces the one of a has the reference.
bool is_same(const FoundManifold& m, const FoundManifold& n) {
    double worst = std::sqrt(length_squared(m.normal - n.normal));
    for (int i = 0; i < 2; ++i)
        worst = std::fmax(
            worst, std::fmax(std::fabs(m.lever_a[i] - n.lever_a[i]), std::fabs(m.lever_b[i] - n.lever_b[i])));
    worst = std::fmax(worst, std::fabs(m.lever_a_t - n.lever_a_t));
    worst = std::fmax(worst, std::fabs(m.lever_b_t - n.lever_b_t));
    for (int i = 0; i < 2; ++i) worst = std::fmax(worst, std::fabs(m.separation[i] - n.separation[i]));
    return worst < 1e-6;
}

/// Compares what is found of all pairs with what is expected of the pairs as they were.
/// @param expected  expected(m) of a manifold m of the pairs as they were
template <class Change, class Expected>
void check_symmetry(const Change& change, const Expected& expected) {
    for (const ShapeKind of_a : kKinds)
        for (const ShapeKind of_b : kKinds) {
            CAPTURE(static_cast<int>(of_a));
            CAPTURE(static_cast<int>(of_b));
            ConvexPairs<double> pairs(kCount), changed(kCount);
            draw_pairs(pairs, of_a, of_b, 2, 3), draw_pairs(changed, of_a, of_b, 2, 3);
            change(changed);
            find(pairs), find(changed);
            std::size_t live = 0, others = 0, bad = 0;
            for (std::size_t i = 0; i < kCount; ++i) {
                const FoundManifold found = changed.found(i), was = pairs.found(i);
                if (!found.is_live() || !was.is_live()) continue;
                ++live;
                if (is_same(found, expected(was))) continue;
                // Where faces or corners are as far away as each other either may be taken.
                ++others;
                const double size = std::fmin(pairs.placed_a(i).inradius, pairs.placed_b(i).inradius);
                bad +=
                    std::fabs(found.separation[found.lowest()] - was.separation[was.lowest()]) > 2e-3 * size;
            }
            CHECK(live > kCount / 3);
            CHECK(bad == 0);
            CHECK(others < live / 6);  // of every 16th the centres coincide, many are turned by quarters
        }
}

}  // namespace

TEST_SUITE("kernels/find manifolds") {
    TEST_CASE("a pair named the other way round has the same manifold with the opposite normal") {
        check_symmetry(
            [](ConvexPairs<double>& pairs) {
                for (std::size_t i = 0; i < kCount; ++i) pairs.swap(i);
            },
            [](const FoundManifold& m) {
                FoundManifold n = m;
                n.normal = -m.normal;
                for (int i = 0; i < 2; ++i) n.lever_a[i] = -m.lever_b[i], n.lever_b[i] = -m.lever_a[i];
                n.lever_a_t = -m.lever_b_t, n.lever_b_t = -m.lever_a_t;
                return with_points_exchanged(n);
            });
    }

    TEST_CASE("a pair in a mirror has the manifold in that mirror") {
        check_symmetry(
            [](ConvexPairs<double>& pairs) {
                double* pose = pairs.pose();
                for (std::size_t row = 0; row < 2 * kCount; ++row) {
                    pairs.shape(row) = mirrored(pairs.shape(row));
                    pose[4 * row] *= -1, pose[4 * row + 3] *= -1;
                }
            },
            [](const FoundManifold& m) {
                FoundManifold n = m;
                n.normal.x = -m.normal.x;
                for (int i = 0; i < 2; ++i) n.lever_a[i] = -m.lever_a[i], n.lever_b[i] = -m.lever_b[i];
                return with_points_exchanged(n);
            });
    }

    TEST_CASE("a pair that is turned and moved as a whole keeps its levers and separations") {
        constexpr double kCosine = 0.28, kSine = 0.96;
        check_symmetry(
            [](ConvexPairs<double>& pairs) {
                double* pose = pairs.pose();
                const auto turn = [](double& x, double& y) {
                    const double turned = kCosine * x - kSine * y;
                    y = kSine * x + kCosine * y, x = turned;
                };
                for (std::size_t row = 0; row < 2 * kCount; ++row) {
                    turn(pose[4 * row], pose[4 * row + 1]), turn(pose[4 * row + 2], pose[4 * row + 3]);
                    pose[4 * row] += 7;
                }
            },
            [](const FoundManifold& m) {
                FoundManifold n = m;
                n.normal = {kCosine * m.normal.x - kSine * m.normal.y,
                            kSine * m.normal.x + kCosine * m.normal.y};
                return n;
            });
    }
}

}  // namespace test_manifold_symmetries
