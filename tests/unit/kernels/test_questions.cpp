// Kernels that tell which contacts have to be looked at one by one: of every instruction set, against the
// definitions in double precision. They may tell of too many, never of too few.
#include "effects/restitution.hpp"
#include "isa/select_isa.hpp"
#include "state/columns/column.hpp"
#include "support/draw.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace test_questions {

using namespace carom;
using carom::test::Draw;

namespace {

constexpr std::size_t kRows = 500, kContacts = 800;
constexpr double kStep = 1.0 / 64;

std::int32_t row_of(Draw& draw) {
    return static_cast<std::int32_t>(draw(0, kRows));
}

/// Contacts with gaps of all sizes, of bodies that fly past each other at all speeds.
template <class Real>
struct Gaps {
    Column<std::int32_t> a, b;
    Column<Real> velocity_x, velocity_y, spin, radius, thickness, restitution, normal_x, normal_y, lever_a1,
        lever_a2, lever_b1, lever_b2, separation1, separation2;

    Gaps() {
        Draw draw(5);
        const auto real = [](double value) { return static_cast<Real>(value); };
        for (Column<Real>* column : {&velocity_x, &velocity_y, &spin, &radius}) column->resize(kRows);
        for (auto* rows : {&a, &b}) rows->resize(kContacts);
        for (Column<Real>* column : {&thickness, &restitution, &normal_x, &normal_y, &lever_a1, &lever_a2,
                                     &lever_b1, &lever_b2, &separation1, &separation2})
            column->resize(kContacts);
        for (std::size_t row = 0; row < kRows; ++row) {
            const double speed = draw.chance(0.3) ? 20 : 0.2;
            velocity_x[row] = real(draw(-speed, speed));
            velocity_y[row] = real(draw(-speed, speed));
            spin[row] = real(draw(-speed, speed)), radius[row] = real(draw(0.2, 1));
        }
        for (std::size_t i = 0; i < kContacts; ++i) {
            a[i] = row_of(draw), b[i] = row_of(draw);
            const double angle = draw(-3, 3);
            normal_x[i] = real(std::cos(angle)), normal_y[i] = real(std::sin(angle));
            thickness[i] = real(draw(0.1, 0.5)), restitution[i] = real(draw.chance(0.5) ? 0.0 : 0.5);
            for (Column<Real>* lever : {&lever_a1, &lever_a2, &lever_b1, &lever_b2})
                (*lever)[i] = real(draw(-0.5, 0.5));
            const double far = draw.chance(0.5) ? 0.5 : 0.02;
            separation1[i] = real(draw.chance(0.2) ? kNoPoint : draw(-0.1 * far, far));
            separation2[i] = real(draw.chance(0.5) ? kNoPoint : draw(-0.1 * far, far));
            if (draw.chance(0.05)) separation1[i] = real(draw(-2e-4, 2e-4)), separation2[i] = real(kNoPoint);
        }
    }
};

}  // namespace

TEST_SUITE("kernels/questions") {
    TEST_CASE_TEMPLATE("gaps that close and that nothing passes are no question, all others are", Real, float,
                       double) {
        Gaps<Real> g;
        const auto real = [](double value) { return static_cast<Real>(value); };
        constexpr double kShare = 0.04, kFall = 0.004, kBeside = 1e-3, kSwift = 0.5, kPassing = 5e-4,
                         kFar = 0.3;
        for (const bool turns : {false, true}) {
            CAPTURE(turns);
            const QuestionGaps<Real> k{g.a.data(),
                                       g.b.data(),
                                       g.velocity_x.data(),
                                       g.velocity_y.data(),
                                       turns ? g.spin.data() : nullptr,
                                       turns ? g.radius.data() : nullptr,
                                       real(0.5),
                                       g.thickness.data(),
                                       g.restitution.data(),
                                       {g.normal_x.data(), g.normal_y.data(), g.lever_a1.data(),
                                        g.lever_a2.data(), g.lever_b1.data(), g.lever_b2.data(), nullptr,
                                        nullptr, g.separation1.data(), g.separation2.data()},
                                       real(kStep),
                                       real(kShare),
                                       real(kFall),
                                       real(kBeside),
                                       real(kSwift),
                                       real(kPassing),
                                       real(kFar)};
            std::vector<std::uint32_t> found;
            for (const KernelTables* tables : runnable_kernel_tables()) {
                std::vector<std::uint32_t> now;
                for (std::size_t first = 0; first < kContacts; first += 16)
                    now.push_back(tables->of<Real>().convex->question_gaps(k, first));
                if (found.empty()) found = now;
                CHECK(now == found);
            }
            std::size_t questions = 0, told = 0, open = 0;
            for (std::size_t i = 0; i < kContacts; ++i) {
                CAPTURE(i);
                const auto of = [&](const Column<Real>& column, std::size_t at) {
                    return static_cast<double>(column[at]);
                };
                const auto row_a = static_cast<std::size_t>(g.a[i]), row_b = static_cast<std::size_t>(g.b[i]);
                const double s1 = of(g.separation1, i), s2 = of(g.separation2, i), gap = std::min(s1, s2),
                             thickness = of(g.thickness, i), e = of(g.restitution, i), nx = of(g.normal_x, i),
                             ny = of(g.normal_y, i);
                const double wa = turns ? of(g.spin, row_a) : 0, wb = turns ? of(g.spin, row_b) : 0;
                const double dx = of(g.velocity_x, row_b) - of(g.velocity_x, row_a),
                             dy = of(g.velocity_y, row_b) - of(g.velocity_y, row_a);
                const double va = of(g.velocity_x, row_a) * nx + of(g.velocity_y, row_a) * ny,
                             vb = of(g.velocity_x, row_b) * nx + of(g.velocity_y, row_b) * ny;
                const auto arm = [&](std::size_t row) { return turns ? of(g.radius, row) : 0.5; };
                const double way =
                    kStep * (std::hypot(dx, dy) + std::abs(wa) * arm(row_a) + std::abs(wb) * arm(row_b));
                const bool is_open = gap > 0 && s1 < of(g.separation1, i) + 1 && s1 < 1e29;
                const auto towards = [&](double speed) { return std::max(speed, -e * speed); };
                const auto closes = [&](double s, double la, double lb) {
                    return s <= kShare * thickness + kFall +
                                    kStep * (towards(va + wa * la) + towards(-vb - wb * lb));
                };
                const auto then = [&](double s, double la, double lb) {
                    return s + kStep * (vb - va + wb * lb - wa * la);
                };
                const double a1 = of(g.lever_a1, i), a2 = of(g.lever_a2, i), b1 = of(g.lever_b1, i),
                             b2 = of(g.lever_b2, i);
                const bool is_beside = s2 > 1e29 && std::abs(s1) <= kBeside * thickness;
                const bool is_question =
                    is_beside ||
                    (is_open && ((way > kSwift * thickness && way > gap) ||
                                 !(closes(s1, a1, b1) || closes(s2, a2, b2)) ||
                                 -std::min(then(s1, a1, b1), then(s2, a2, b2)) > kPassing * thickness ||
                                 gap > kFar * (arm(row_a) + arm(row_b))));
                const bool is_told = (found[i / 16] >> (i % 16) & 1) != 0;
                if (is_question) REQUIRE(is_told);
                if (!is_open && !is_beside) REQUIRE_FALSE(is_told);
                questions += is_question, told += is_told, open += is_open;
            }
            CHECK(told <= questions + 2);
            CHECK(questions > kContacts / 8);
            CHECK(open > questions + 50);
        }
    }

    TEST_CASE_TEMPLATE("contacts whose points come fast are told, and few others", Real, float, double) {
        Draw draw(11);
        const auto real = [](double value) { return static_cast<Real>(value); };
        constexpr std::size_t kBundles = 30, kLength = 5;
        constexpr double kFast = 0.05, kSurelyFast = 0.07, kFall = 0.01, kLight = 0.1;  // m/s, m/s, m/s
        Column<Real> velocity(4 * kRows), foreseen(4 * kRows), displacement(2 * kRows), turn(kRows);
        for (std::size_t row = 0; row < kRows; ++row) {
            const double speed = draw.chance(0.1) ? 1e4 : draw.chance(0.5) ? 0.1 : 0.02;
            for (std::size_t k = 0; k < 3; ++k) velocity[4 * row + k] = real(draw(-speed, speed));
            velocity[4 * row + 3] = real(draw(-2, 2));  // 1/kg
        }
        Column<PathLink<Real>> links(kBundles * kLength);
        Column<std::int32_t> heads(kBundles * kPathLanes);
        std::vector<std::size_t> first_link;
        for (std::size_t bundle = 0; bundle <= kBundles; ++bundle) first_link.push_back(bundle * kLength);
        for (std::int32_t& head : heads) head = row_of(draw);
        for (PathLink<Real>& link : links)
            for (std::size_t lane = 0; lane < kPathLanes; ++lane) {
                link.body[lane] = row_of(draw);
                const double angle = draw(-3, 3);
                link.normal_x[lane] = real(std::cos(angle)), link.normal_y[lane] = real(std::sin(angle));
                for (Real* lever : {link.near1, link.near2, link.far1, link.far2})
                    lever[lane] = real(draw(-1, 1));
                if (draw.chance(0.5)) link.normal1[lane] = real(draw(0, 0.01));
                if (draw.chance(0.1)) link.normal2[lane] = real(draw(0, 10));
                link.separation1[lane] = real(draw(-0.001, 0.003));
                link.separation2[lane] = real(draw.chance(0.5) ? kNoPoint : draw(-0.001, 0.003));
            }
        for (std::size_t row = 0; row < kRows; ++row) {
            for (std::size_t k = 0; k < 4; ++k)
                foreseen[4 * row + k] = velocity[4 * row + k] + real(k < 3 ? draw(-0.02, 0.02) : 0.0);
            for (std::size_t k = 0; k < 2; ++k) displacement[2 * row + k] = real(draw(-0.001, 0.001));
            turn[row] = real(draw(-0.001, 0.001));
        }
        std::vector<std::uint32_t> found, found_to_come;
        for (const KernelTables* tables : runnable_kernel_tables()) {
            std::vector<std::uint32_t> now(links.size(), 77), to_come(links.size(), 78);
            SolvePaths<Real> k{};
            k.links = links.data(), k.first_link = first_link.data(), k.heads = heads.data();
            k.velocity = velocity.data(), k.foreseen = foreseen.data();
            k.displacement = displacement.data(), k.turn = turn.data(), k.h = real(kStep);
            k.is_fast = now.data(), k.comes = to_come.data();
            k.fast = real(kFast), k.surely_fast = real(kSurelyFast);
            k.fall = real(kFall), k.light_press = real(kLight);
            const auto kernel = tables->of<Real>().convex->paths.find_fast;
            kernel(k, 0, 2), kernel(k, 2, kBundles);
            if (found.empty()) found = now, found_to_come = to_come;
            CHECK(now == found);
            CHECK(to_come == found_to_come);
        }
        std::size_t fast = 0, told = 0, coming = 0, told_coming = 0;
        for (std::size_t i = 0; i < links.size(); ++i)
            for (std::size_t lane = 0; lane < kPathLanes; ++lane) {
                const PathLink<Real>& link = links[i];
                const bool is_first = i % kLength == 0;
                const std::int32_t near =
                    is_first ? heads[kPathLanes * (i / kLength) + lane] : links[i - 1].body[lane];
                const std::int32_t far = link.body[lane];
                // How fast b leaves a at a point, or how far it has, by a column of so many numbers a row.
                const auto leaving = [&](const auto& x, const auto& y, const auto& rim, const Real* of_near,
                                         const Real* of_far) {
                    const auto row_of_near = static_cast<std::size_t>(near),
                               row_of_far = static_cast<std::size_t>(far);
                    return (x(row_of_far) - x(row_of_near)) * static_cast<double>(link.normal_x[lane]) +
                           (y(row_of_far) - y(row_of_near)) * static_cast<double>(link.normal_y[lane]) +
                           rim(row_of_far) * static_cast<double>(of_far[lane]) -
                           rim(row_of_near) * static_cast<double>(of_near[lane]);
                };
                const auto part = [](const Column<Real>& of, std::size_t width, std::size_t k) {
                    return
                        [&of, width, k](std::size_t row) { return static_cast<double>(of[width * row + k]); };
                };
                struct Point {
                    double closing, gap;  // m/s; m, at the end of the substep
                };
                const auto point = [&](const Real* of_near, const Real* of_far, Real separation) -> Point {
                    const double come = leaving(part(displacement, 2, 0), part(displacement, 2, 1),
                                                part(turn, 1, 0), of_near, of_far),
                                 soon = leaving(part(foreseen, 4, 0), part(foreseen, 4, 1),
                                                part(foreseen, 4, 2), of_near, of_far);
                    return {-leaving(part(velocity, 4, 0), part(velocity, 4, 1), part(velocity, 4, 2),
                                     of_near, of_far),
                            static_cast<double>(separation) + come + kStep * soon};
                };
                const Point one = point(link.near1, link.far1, link.separation1[lane]),
                            two = point(link.near2, link.far2, link.separation2[lane]);
                const auto inverse_mass = [&](std::int32_t row) {
                    return std::abs(static_cast<double>(velocity[4 * static_cast<std::size_t>(row) + 3]));
                };
                const double comes = std::max(one.closing, two.closing),
                             pressing = static_cast<double>(link.normal1[lane]) +
                                        static_cast<double>(link.normal2[lane]),
                             light = kLight / (inverse_mass(near) + inverse_mass(far));
                const bool is_fast = comes > kFast && pressing <= light * (comes + kFall / 2);
                const bool has_two = link.separation2[lane] < real(kNoPoint);
                const bool is_coming =
                    (one.closing > kSurelyFast || (has_two && two.closing > kSurelyFast)) &&
                    pressing <= light * (comes - kFall / 2) && one.gap >= 0 && (!has_two || two.gap >= 0);
                const bool may_meet = (found[i] >> lane & 1) != 0,
                           is_told_to_come = (found_to_come[i] >> lane & 1) != 0;
                if (is_fast) REQUIRE((may_meet || is_told_to_come));
                REQUIRE_FALSE((may_meet && is_told_to_come));
                if (is_told_to_come) REQUIRE(is_coming);
                fast += is_fast, told += may_meet || is_told_to_come;
                coming += is_coming, told_coming += is_told_to_come;
            }
        CHECK(fast > 50);
        CHECK(told <= fast + 3);
        CHECK(told < links.size() * kPathLanes - 50);
        CHECK(coming > 20);
        CHECK(fast > coming + 20);
        CHECK(told_coming + 3 >= coming);
    }
}

}  // namespace test_questions
