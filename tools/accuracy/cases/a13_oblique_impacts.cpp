#include <algorithm>
#include <array>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

using Number = long double;

constexpr double kRestitution = 0.8, kFriction = 0.3;
constexpr double kRadiusA = 0.5, kRadiusB = 0.3, kReach = kRadiusA + kRadiusB;  // m
constexpr double kFastest = 5;  // m/s, of one relative to the other
constexpr double kTime = 0.2;   // s; they meet at 0.02 to 0.12

/// Pairs of discs, each far from the others: angles, mass ratios, spins.
Scene pairs_of(double friction) {
    Scene scene;
    double x = 0;
    for (const double offset : {0.0, 0.3, -0.5, 0.8, 0.95})
        for (const double ratio : {0.1, 1.0, 10.0})
            for (const double spin : {0.0, 12.5}) {
                if (spin != 0 && friction == 0) continue;
                const double aside = offset * kReach;
                const double ahead = std::sqrt(kReach * kReach - aside * aside) + 0.1 + 0.01 * x;
                const Material material = bouncy(kRestitution, friction);
                Body a = disc(kRadiusA, 1, {10 * x, 0}, {0.8 * kFastest, 0}, material);
                Body b = disc(kRadiusB, ratio, {10 * x + ahead, aside}, {-0.2 * kFastest, 0.2}, material);
                a.angular_velocity = spin, b.angular_velocity = -0.5 * spin;
                scene.add(a);
                scene.add(b);
                x += 1;
            }
    return scene;
}

struct Motion {
    Number x, y, vx, vy, spin;
};

Motion motion_of(const Body& body) {
    return {body.position.x, body.position.y, body.velocity.x, body.velocity.y, body.angular_velocity};
}

/// Velocities after the impact of two discs: Newton's restitution and Coulomb's friction at the place where
/// they meet.
std::array<Motion, 2> after_impact(const Body& a, const Body& b) {
    const Number ma = *a.mass, mb = *b.mass, effective = ma * mb / (ma + mb);
    const Number ra = kRadiusA, rb = kRadiusB, reach = ra + rb;
    Motion p = motion_of(a), q = motion_of(b);
    const Number x = q.x - p.x, y = q.y - p.y, vx = q.vx - p.vx, vy = q.vy - p.vy;
    const Number along = x * vx + y * vy, v2 = vx * vx + vy * vy;
    const Number gap = x * x + y * y - reach * reach;
    const Number t = gap / (std::sqrt(along * along - v2 * gap) - along);
    const Number nx = (x + vx * t) / reach, ny = (y + vy * t) / reach;
    const Number vn = vx * nx + vy * ny, vt = -vx * ny + vy * nx - ra * p.spin - rb * q.spin;
    const Number normal = -(1 + Number(a.material.restitution)) * effective * vn;
    const Number limit = Number(a.material.friction) * normal;
    const Number tangential = std::clamp(-vt * effective / 3, -limit, limit);
    const Number jx = normal * nx - tangential * ny, jy = normal * ny + tangential * nx;
    p.vx -= jx / ma, p.vy -= jy / ma, p.spin -= 2 * tangential / (ma * ra);
    q.vx += jx / mb, q.vy += jy / mb, q.spin -= 2 * tangential / (mb * rb);
    return {p, q};
}

std::vector<double> run(Stepper& stepper, const Scene& scene, int) {
    stepper.advance_to(kTime);
    Number largest = 0, squares = 0;
    for (std::size_t pair = 0; pair < scene.bodies.size(); pair += 2) {
        const auto exact = after_impact(scene.bodies[pair], scene.bodies[pair + 1]);
        for (std::size_t i = 0; i < 2; ++i) {
            const BodyState s = stepper.state(pair + i);
            const Number radius = i == 0 ? kRadiusA : kRadiusB;
            const Number dx = s.velocity.x - exact[i].vx, dy = s.velocity.y - exact[i].vy;
            const Number dw = radius * (s.angular_velocity - exact[i].spin);
            const Number error = (dx * dx + dy * dy + dw * dw) / (kFastest * kFastest);
            largest = std::max(largest, error), squares += error;
        }
    }
    const auto bodies = static_cast<Number>(scene.bodies.size());
    return {static_cast<double>(std::sqrt(squares / bodies)), static_cast<double>(std::sqrt(largest))};
}

Case impacts_of(std::string_view id, std::string_view title, std::string_view kind,
                std::string_view effects) {
    return {.id = id,
            .title = title,
            .kind = kind,
            .effects = effects,
            .exact = "Jn = (1+e) m_eff |vn|; Jt = -vt m_eff/3, at most μ Jn, at the place where they meet",
            .errors = {{"velocities (rms)",
                        "root mean square difference of velocity and spin times radius, over the approach"},
                       {"velocities (largest)", "the largest of them"}},
            .solvers = {},
            .steps = {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480, 1.0 / 960},
            .scene = nullptr,
            .run = run};
}

}  // namespace

Case oblique_impacts() {
    Case impacts = impacts_of("A13", "Smooth discs meet off-centre", "single impacts", "N R");
    impacts.solvers = {"event", "impulse", "soft", "pairwise"};
    impacts.scene = [](int) { return pairs_of(0); };
    return impacts;
}

Case rough_impacts() {
    Case impacts = impacts_of("A13-rough", "Rough spinning discs meet off-centre, friction 0.3",
                              "single impacts with friction", "N R W F");
    impacts.solvers = {"event", "impulse", "soft"};
    impacts.scene = [](int) { return pairs_of(kFriction); };
    return impacts;
}

}  // namespace carom::accuracy
