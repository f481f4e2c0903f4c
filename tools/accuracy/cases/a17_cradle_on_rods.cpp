#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr std::size_t kBalls = 5;
constexpr double kRadius = 0.1, kApart = 0.201, kRod = 1, kLift = 0.8;  // m, m, m, rad
constexpr double kTime = 10, kLook = 0.1, kStep = 1e-3;                 // s, the last of the reference

using Angles = std::array<double, 2 * kBalls>;  // rad from below, then rad/s

double hung_at(std::size_t ball) {
    return kApart * static_cast<double>(ball);
}

Vec2 place_of(std::size_t ball, double angle) {
    return {hung_at(ball) + kRod * std::sin(angle), -kRod * std::cos(angle)};
}

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    for (std::size_t i = 0; i < kBalls; ++i)
        scene.add(disc(kRadius, 1, place_of(i, i == 0 ? -kLift : 0), {}, bouncy(1)));
    for (std::uint32_t i = 0; i < kBalls; ++i)
        scene.add(
            Joint{.b = BodyId{i, 0}, .kind = DistanceJoint{.anchor_a = {hung_at(i), 0}, .length = kRod}});
    return scene;
}

Angles rate_of(const Angles& at) {
    Angles change{};
    for (std::size_t i = 0; i < kBalls; ++i) {
        change[i] = at[kBalls + i];
        change[kBalls + i] = -kGravity / kRod * std::sin(at[i]);
    }
    return change;
}

/// Whether neighbours overlap that near each other.
bool overlaps(const Angles& y) {
    for (std::size_t i = 0; i + 1 < kBalls; ++i)
        if (distance(place_of(i, y[i]), place_of(i + 1, y[i + 1])) < 2 * kRadius &&
            y[kBalls + i] > y[kBalls + i + 1])
            return true;
    return false;
}

/// Elastic impacts of neighbours that touch, along the line of their centres; the rods take what is across.
void collide(Angles& y) {
    for (bool meets = true; meets;) {
        meets = false;
        for (std::size_t i = 0; i + 1 < kBalls; ++i) {
            const Vec2 a = place_of(i, y[i]), b = place_of(i + 1, y[i + 1]);
            const double apart = distance(a, b);
            if (apart > 2 * kRadius) continue;
            const Vec2 n{(b.x - a.x) / apart, (b.y - a.y) / apart};
            const double on_a = n.x * std::cos(y[i]) + n.y * std::sin(y[i]),
                         on_b = n.x * std::cos(y[i + 1]) + n.y * std::sin(y[i + 1]);
            double &va = y[kBalls + i], &vb = y[kBalls + i + 1];
            const double closing = vb * on_b - va * on_a;
            if (!(closing < 0)) continue;
            const double change = -2 * closing / (on_a * on_a + on_b * on_b);
            va -= change * on_a, vb += change * on_b, meets = true;
        }
    }
}

/// Five pendulums, from impact to impact.
void swing(Angles& y, double time) {
    for (double left = time; left > 1e-12;) {
        const double step = std::min(kStep, left);
        Angles after = y;
        integrate(after, step, kStep, rate_of);
        if (!overlaps(after)) {
            y = after, left -= step;
            continue;
        }
        double free = 0, met = step;  // by bisection: s from here to the impact
        for (int i = 0; i < 50; ++i) {
            const double middle = 0.5 * (free + met);
            after = y;
            integrate(after, middle, kStep, rate_of);
            (overlaps(after) ? met : free) = middle;
        }
        integrate(y, met, kStep, rate_of);
        collide(y), left -= met;
    }
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    Angles exact{};
    exact[0] = -kLift;
    const double start = stepper.energy(), swings = kGravity * kRod * (1 - std::cos(kLift));
    double energy = 0;
    RootMeanSquare angle;
    for (int i = 1; kLook * i <= kTime + 1e-9; ++i) {
        stepper.advance_to(kLook * i);
        swing(exact, kLook);
        energy = std::max(energy, std::abs(stepper.energy() - start) / swings);
        for (std::size_t ball = 0; ball < kBalls; ++ball) {
            const Vec2 at = stepper.state(ball).position;
            angle.add((std::atan2(at.x - hung_at(ball), -at.y) - exact[ball]) / kLift);
        }
    }
    return {energy, angle.value()};
}

}  // namespace

Case cradle_on_rods() {
    return {.id = "A17-rods",
            .title = "Newton's cradle on rods: five balls 1 mm apart, the first lifted by 0.8 rad",
            .kind = "mechanisms in contact",
            .effects = "G N R J",
            .exact =
                "energy is kept; angles from an integration of five pendulums (Runge and Kutta, 1 ms) with "
                "elastic impacts; looked at every 0.1 s up to 10 s, 5 periods",
            .errors = {{"energy", "largest difference in energy, over that of the lift"},
                       {"angle", "root mean square difference in angle, over the first"}},
            .solvers = {"soft"},
            .steps = steps_of_frames(),
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy
