// Normals, separations and live blocks of pairs against the flights of two discs in long double.
#include "isa/select_isa.hpp"
#include "state/columns/column.hpp"
#include "support/disc_contact.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace test_find_contacts {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kDt = 1.0 / 64, kNear = 0.02, kDeep = -0.05;

/// Pairs of discs, each pair on its own; a block of sentinels before and behind, and padding of one row
/// behind the last pair.
template <class Real>
struct Pairs {
    static constexpr std::size_t kFirst = kContactBlock;
    static constexpr Real kSentinel = Real(-77);
    std::size_t count, last;
    Column<Real> motion, reach, normal_impulse, friction_impulse, rolling_impulse, normal_x, normal_y,
        separation, approach;
    Column<std::int32_t> a, b;
    Column<std::uint8_t> is_live;

    explicit Pairs(std::size_t pairs) : count(pairs), last(kFirst + padded(pairs)) {
        const std::size_t length = last + kContactBlock;
        const auto dummy = static_cast<std::int32_t>(2 * count);
        motion.resize(4 * (2 * count + 1));
        a.resize(length), b.resize(length), is_live.resize(length / kContactBlock);
        std::fill(a.begin(), a.end(), dummy), std::fill(b.begin(), b.end(), dummy);
        std::fill(is_live.begin(), is_live.end(), std::uint8_t{9});
        for (Column<Real>* column : columns()) {
            column->resize(length);
            std::fill(column->begin(), column->end(), kSentinel);
        }
        for (std::size_t p = kFirst; p < last; ++p) {
            reach[p] = normal_impulse[p] = friction_impulse[p] = rolling_impulse[p] = 0;
        }
    }

    /// Pair number i: b is at `d` from a and flies at `v` relative to it.
    void set(std::size_t i, Vector d, Vector v, double radii, Vector place_of_a = {},
             Vector velocity_of_a = {}) {
        const std::size_t at = kFirst + i, row = 2 * i;
        a[at] = static_cast<std::int32_t>(row), b[at] = static_cast<std::int32_t>(row + 1);
        reach[at] = static_cast<Real>(radii);
        const auto store = [&](std::size_t of, Vector x, Vector u) {
            Real* m = motion.data() + 4 * of;
            m[0] = static_cast<Real>(x.x), m[1] = static_cast<Real>(x.y);
            m[2] = static_cast<Real>(u.x), m[3] = static_cast<Real>(u.y);
        };
        store(row, place_of_a, velocity_of_a);
        store(row + 1, place_of_a + d, velocity_of_a + v);
        normal_impulse[at] = 3, friction_impulse[at] = -2, rolling_impulse[at] = 1;
    }

    FindContacts<Real> arguments() {
        FindContacts<Real> k{};
        k.motion = motion.data(), k.a = a.data(), k.b = b.data(), k.reach = reach.data();
        k.normal_impulse = normal_impulse.data(), k.friction_impulse = friction_impulse.data();
        k.rolling_impulse = rolling_impulse.data();
        k.normal_x = normal_x.data(), k.normal_y = normal_y.data(), k.separation = separation.data();
        k.approach = approach.data();
        k.dt = static_cast<Real>(kDt), k.near = static_cast<Real>(kNear);
        k.deep = static_cast<Real>(kDeep), k.is_live = is_live.data();
        return k;
    }

    Vector place(std::size_t row) const { return {motion[4 * row], motion[4 * row + 1]}; }
    Vector velocity(std::size_t row) const { return {motion[4 * row + 2], motion[4 * row + 3]}; }
    Vector d(std::size_t i) const { return place(2 * i + 1) - place(2 * i); }
    Vector v(std::size_t i) const { return velocity(2 * i + 1) - velocity(2 * i); }
    Vector normal(std::size_t i) const { return {normal_x[kFirst + i], normal_y[kFirst + i]}; }

    bool is_rest_untouched() {
        for (const Column<Real>* column : columns())
            for (std::size_t p = 0; p < column->size(); ++p)
                if ((p < kFirst || p >= last) && (*column)[p] != kSentinel) return false;
        return is_live[0] == 9 && is_live[last / kContactBlock] == 9;
    }

  private:
    std::vector<Column<Real>*> columns() {
        return {&reach,    &normal_impulse, &friction_impulse, &rolling_impulse,
                &normal_x, &normal_y,       &separation,       &approach};
    }
};

/// Clearance of two discs at time t.
long double clearance(Vector d, Vector v, long double reach, long double t) {
    const Vector there = d + t * v;
    return std::sqrt(dot(there, there)) - reach;
}

/// When the discs touch within kDt, by bisection between the start and when they are nearest; that time, or
/// the end, if they do not; 0 if they touch already or part.
long double time_of_meeting(Vector d, Vector v, long double reach) {
    if (dot(d, v) >= 0 || clearance(d, v, reach, 0) <= 0) return 0;
    long double low = 0, high = std::min<long double>(-dot(d, v) / dot(v, v), kDt);
    if (clearance(d, v, reach, high) > 0) return high;
    for (int i = 0; i < 80; ++i) {
        const long double middle = 0.5L * (low + high);
        (clearance(d, v, reach, middle) > 0 ? low : high) = middle;
    }
    return high;
}

/// Pairs at rest, flying together, approaching, parting, grazing, deep in each other and far apart.
template <class Real>
void draw_all(Pairs<Real>& pairs, unsigned seed, double offset) {
    std::mt19937 random(seed);
    const auto draw = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random() % 100001) * 1e-5;
    };
    for (std::size_t i = 0; i < pairs.count; ++i) {
        const double angle = draw(-3.14, 3.14), radii = draw(0.2, 2);
        const double gap = i % 5 == 0 ? draw(-0.2, 0) * radii : i % 5 == 1 ? draw(0, 3) : draw(0, 0.3);
        const double speed = i % 4 == 0 ? 0 : i % 4 == 1 ? draw(0, 200) : draw(0, 10);
        const double heading = i % 3 == 0 ? draw(-3.14, 3.14) : angle + 3.14159265 + draw(-0.3, 0.3);
        pairs.set(i, {(radii + gap) * std::cos(angle), (radii + gap) * std::sin(angle)},
                  {speed * std::cos(heading), speed * std::sin(heading)}, radii,
                  {offset * draw(-1, 1), offset * draw(-1, 1)}, {draw(-1, 1), draw(-1, 1)});
    }
}

}  // namespace

TEST_SUITE("kernels/find contacts") {
    TEST_CASE_TEMPLATE("normal and separation are those of the moment at which two discs meet", Real, float,
                       double) {
        constexpr long double kEpsilon = std::numeric_limits<Real>::epsilon();
        for (const KernelTables* tables : runnable_kernel_tables())
            for (const std::size_t count : {1u, 7u, 16u, 17u, 3000u}) {
                CAPTURE(tables->of<Real>().isa);
                CAPTURE(count);
                Pairs<Real> pairs(count);
                draw_all(pairs, static_cast<unsigned>(count), 0);
                tables->of<Real>().find_contacts(pairs.arguments(), pairs.kFirst, pairs.last);
                CHECK(pairs.is_rest_untouched());
                long double worst_normal = 0, worst_separation = 0, worst_approach = 0, worst_path = 0;
                for (std::size_t i = 0; i < count; ++i) {
                    const Vector d = pairs.d(i), v = pairs.v(i), n = pairs.normal(i);
                    const long double reach = pairs.reach[pairs.kFirst + i];
                    const long double t = time_of_meeting(d, v, reach), way = std::sqrt(dot(v, v)) * kDt;
                    const Vector there = d + t * v;
                    const Vector exact = 1 / std::sqrt(dot(there, there)) * there;
                    // Where the path only grazes, round-off decides when it touches: the clearance there is
                    // that of the nearest point but for round-off.
                    const long double nearest = std::fabs(cross(v, d)) / std::sqrt(dot(v, v) + 1e-30L);
                    const long double depth = reach - nearest;
                    const bool grazes = way > 0 && std::fabs(depth) < 0.02L * reach;
                    if (!grazes)
                        worst_normal =
                            std::max({worst_normal, std::fabs(n.x - exact.x), std::fabs(n.y - exact.y)});
                    worst_separation = std::max(
                        worst_separation, std::fabs(pairs.separation[pairs.kFirst + i] - dot(d, n) + reach));
                    worst_approach =
                        std::max(worst_approach, std::fabs(pairs.approach[pairs.kFirst + i] - dot(v, n)) /
                                                     (1 + std::sqrt(dot(v, v))));
                    // Along the normal they do not overlap before they touch.
                    if (clearance(d, v, reach, 0) > 0)
                        for (const long double at : {0.0L, 0.5L * t, t})
                            worst_path = std::max(worst_path, reach - dot(d + at * v, n));
                }
                CHECK(worst_normal <= 2000 * kEpsilon);  // radii of 0.2 m at the end of ways of 3 m
                CHECK(worst_separation <= 20 * kEpsilon);
                CHECK(worst_approach <= 20 * kEpsilon);
                CHECK(worst_path <= 200 * kEpsilon);
            }
    }

    TEST_CASE_TEMPLATE("a pair is live if what both fly in the step could bring them together", Real, float,
                       double) {
        for (const KernelTables* tables : runnable_kernel_tables())
            for (const std::size_t count : {1u, 7u, 16u, 17u, 3000u}) {
                CAPTURE(tables->of<Real>().isa);
                CAPTURE(count);
                Pairs<Real> pairs(count);
                draw_all(pairs, 100 + static_cast<unsigned>(count), 10);
                const std::size_t found =
                    tables->of<Real>().find_contacts(pairs.arguments(), pairs.kFirst, pairs.last);
                std::size_t live = 0, unclear = 0, wrong = 0;
                for (std::size_t block = pairs.kFirst; block < pairs.last; block += kContactBlock) {
                    bool any = false, is_deep = false, is_clear = true;
                    for (std::size_t p = block; p < block + kContactBlock; ++p) {
                        const std::size_t i = p - pairs.kFirst;
                        if (i >= count) continue;
                        const Vector va = pairs.velocity(2 * i), vb = pairs.velocity(2 * i + 1);
                        const auto way = [](Vector v) {  // at least the length
                            return (std::fabs(v.x) + std::fabs(v.y)) * kDt;
                        };
                        const long double gap = clearance(pairs.d(i), {}, pairs.reach[p], 0);
                        const long double margin = gap - static_cast<Real>(kNear) - way(va) - way(vb);
                        const bool is_near = margin < 0, has_impulses = pairs.normal_impulse[p] != 0;
                        if (std::fabs(margin) < 1e-4L) {
                            ++unclear, is_clear = false;
                            continue;
                        }
                        live += is_near, any |= is_near;
                        wrong += has_impulses != is_near;
                        wrong += pairs.normal_impulse[p] != (is_near ? 3 : 0);
                        wrong += pairs.friction_impulse[p] != (is_near ? -2 : 0);
                        wrong += pairs.rolling_impulse[p] != (is_near ? 1 : 0);
                        const long double separation = pairs.separation[p];
                        if (std::fabs(separation - kDeep) < 1e-4L) is_clear = false;
                        is_deep |= separation < kDeep;
                    }
                    const std::uint8_t expected = is_deep ? kDeepBlock : any ? 1 : 0;
                    if (is_clear) wrong += pairs.is_live[block / kContactBlock] != expected;
                }
                CHECK(wrong == 0);
                CHECK(found >= live);
                CHECK(found <= live + unclear);
                if (count > 1000) CHECK(live < count);
            }
    }

    TEST_CASE_TEMPLATE("of the gap of a pair that presses as much counts as the pace says, and all of others",
                       Real, float, double) {
        constexpr std::size_t kCount = 1000;
        for (const KernelTables* tables : runnable_kernel_tables()) {
            CAPTURE(tables->of<Real>().isa);
            Pairs<Real> whole(kCount), paced(kCount);
            for (Pairs<Real>* pairs : {&whole, &paced}) {
                draw_all(*pairs, 7, 0);
                for (std::size_t i = 0; i < kCount; i += 3) pairs->normal_impulse[pairs->kFirst + i] = 0;
            }
            tables->of<Real>().find_contacts(whole.arguments(), whole.kFirst, whole.last);
            FindContacts<Real> k = paced.arguments();
            k.pace = Real(0.125);
            tables->of<Real>().find_contacts(k, paced.kFirst, paced.last);
            std::size_t wrong = 0, closed = 0;
            for (std::size_t i = 0; i < kCount; ++i) {
                const std::size_t at = whole.kFirst + i;
                const bool is_paced = whole.normal_impulse[at] > 0 && whole.separation[at] > 0;
                closed += is_paced;
                wrong += paced.separation[at] != (is_paced ? Real(0.125) : Real(1)) * whole.separation[at];
                wrong += paced.normal_impulse[at] != whole.normal_impulse[at];
            }
            CHECK(wrong == 0);
            CHECK(closed > 100);
            CHECK(closed < 900);
        }
    }

    TEST_CASE_TEMPLATE("a block is deep if a pair in any of its places is", Real, float, double) {
        for (const KernelTables* tables : runnable_kernel_tables())
            for (std::size_t place = 0; place < kContactBlock; ++place) {
                Pairs<Real> pairs(kContactBlock);
                for (std::size_t i = 0; i < kContactBlock; ++i)
                    pairs.set(i, {i == place ? 0.9 : 100.0, 0}, {}, 1);
                CHECK(tables->of<Real>().find_contacts(pairs.arguments(), pairs.kFirst, pairs.last) == 1);
                CHECK(static_cast<int>(pairs.is_live[1]) == static_cast<int>(kDeepBlock));
                for (std::size_t i = 0; i < kContactBlock; ++i)
                    CHECK(pairs.normal_impulse[pairs.kFirst + i] == (i == place ? 3 : 0));
            }
    }

    TEST_CASE_TEMPLATE("coincident centres have a unit normal that no instruction set changes", Real, float,
                       double) {
        constexpr std::size_t kCount = 100;
        std::vector<Vector> first;
        for (const KernelTables* tables : runnable_kernel_tables()) {
            CAPTURE(tables->of<Real>().isa);
            Pairs<Real> pairs(kCount);
            for (std::size_t i = 0; i < kCount; ++i)  // every third coincides, at rest or flying
                pairs.set(i, i % 3 == 0 ? Vector{} : Vector{0.5L, 0.25L},
                          i % 2 == 0 ? Vector{} : Vector{1, -2}, 1, {3, static_cast<long double>(i)});
            tables->of<Real>().find_contacts(pairs.arguments(), pairs.kFirst, pairs.last);
            std::vector<Vector> normals;
            for (std::size_t i = 0; i < kCount; ++i) {
                normals.push_back(pairs.normal(i));
                CHECK(std::fabs(dot(normals[i], normals[i]) - 1) <=
                      4 * static_cast<long double>(std::numeric_limits<Real>::epsilon()));
                if (i % 3 != 0) continue;
                CHECK(pairs.separation[pairs.kFirst + i] == -1);
                if (!first.empty()) CHECK(cross(first[i], normals[i]) == 0);
                if (!first.empty()) CHECK(dot(first[i], normals[i]) > 0);
            }
            if (first.empty()) first = normals;
        }
    }

    TEST_CASE_TEMPLATE("bodies in one point are not all pushed along one line", Real, float, double) {
        constexpr std::int32_t kCrowd = 12;
        for (const KernelTables* tables : runnable_kernel_tables()) {
            Pairs<Real> pairs(kCrowd * (kCrowd - 1) / 2);
            std::size_t at = pairs.kFirst;
            for (std::int32_t b = 0; b < kCrowd; ++b)
                for (std::int32_t a = 0; a < b; ++a, ++at)
                    pairs.a[at] = a, pairs.b[at] = b, pairs.reach[at] = 1;
            tables->of<Real>().find_contacts(pairs.arguments(), pairs.kFirst, pairs.last);
            Vector spread;  // of the squares of the normals, which have sum one
            for (std::size_t i = 0; i < pairs.count; ++i) {
                const Vector n = pairs.normal(i);
                spread = spread + 1.0L / static_cast<long double>(pairs.count) * Vector{n.x * n.x, n.y * n.y};
            }
            CHECK(spread.x > 0.3);
            CHECK(spread.y > 0.3);
        }
    }
}

}  // namespace test_find_contacts
