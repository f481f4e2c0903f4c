#include "support/event_simulation.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace carom::test {
namespace {

using Number = EventSimulation::Number;
constexpr Number kNotAtAll = std::numeric_limits<Number>::infinity();

/// Smallest t >= 0 at which c + v t + a t²/2 falls through zero; 0 if it is there and falling.
Number first_fall_through_zero(Number c, Number v, Number a) {
    if (c <= 0 && v < 0) return 0;
    const Number discriminant = v * v - 2 * a * c;
    if (!(discriminant >= 0)) return kNotAtAll;
    const Number root = std::sqrt(discriminant);
    if (v < 0) return 2 * c / (root - v);
    return a < 0 ? (v + root) / -a : kNotAtAll;
}

}  // namespace

EventSimulation::EventSimulation(const Scene& scene, Number (*rounded)(double))
    : gravity_x_(scene.gravity.x), gravity_y_(scene.gravity.y) {
    for (const Body& body : scene.bodies) {
        const double radius = std::get<carom::Disc>(body.shape).radius;
        const double mass =
            body.mass ? *body.mass : body.material.density * std::numbers::pi * radius * radius;
        discs.push_back({rounded(body.position.x), rounded(body.position.y), rounded(body.velocity.x),
                         rounded(body.velocity.y), rounded(mass), rounded(radius),
                         rounded(body.material.restitution)});
    }
    if (!scene.walls) return;
    const Walls& walls = *scene.walls;
    wall_restitution_ = walls.material.restitution;
    sides_ = {{walls.left, 1, 0, walls.min.x},
              {walls.right, -1, 0, -walls.max.x},
              {walls.bottom, 0, 1, walls.min.y},
              {walls.top, 0, -1, -walls.max.y}};
}

Number EventSimulation::energy() const {
    Number sum = 0;
    for (const Disc& d : discs)
        sum += d.mass * ((d.vx * d.vx + d.vy * d.vy) / 2 - gravity_x_ * d.x - gravity_y_ * d.y);
    return sum;
}

/// All discs fall alike, so two of them move on straight lines relative to each other.
Number EventSimulation::time_to_meet(const Disc& a, const Disc& b) const {
    const Number x = b.x - a.x, y = b.y - a.y, vx = b.vx - a.vx, vy = b.vy - a.vy;
    const Number approach = x * vx + y * vy;
    if (!(approach < 0)) return kNotAtAll;
    const Number reach = a.radius + b.radius;
    const Number gap = x * x + y * y - reach * reach;
    if (gap <= 0) return 0;
    const Number discriminant = approach * approach - (vx * vx + vy * vy) * gap;
    return discriminant > 0 ? gap / (std::sqrt(discriminant) - approach) : kNotAtAll;
}

Number EventSimulation::time_to_wall(const Disc& disc, const Side& side) const {
    if (!side.is_closed) return kNotAtAll;
    const auto along = [&](Number x, Number y) { return side.normal_x * x + side.normal_y * y; };
    return first_fall_through_zero(along(disc.x, disc.y) - side.offset - disc.radius, along(disc.vx, disc.vy),
                                   along(gravity_x_, gravity_y_));
}

EventSimulation::Event EventSimulation::next_event() const {
    Event first{kNotAtAll, 0, 0};
    const int count = static_cast<int>(discs.size());
    for (int a = 0; a < count; ++a) {
        const Disc& disc = discs[static_cast<std::size_t>(a)];
        for (int b = a + 1; b < count; ++b)
            if (const Number t = time_to_meet(disc, discs[static_cast<std::size_t>(b)]); t < first.after)
                first = {t, a, b};
        for (int side = 0; side < static_cast<int>(sides_.size()); ++side)
            if (const Number t = time_to_wall(disc, sides_[static_cast<std::size_t>(side)]); t < first.after)
                first = {t, a, -1 - side};
    }
    return first;
}

void EventSimulation::fly(Number duration) {
    time_ += duration;
    for (Disc& d : discs) {
        d.x += duration * (d.vx + duration * gravity_x_ / 2);
        d.y += duration * (d.vy + duration * gravity_y_ / 2);
        d.vx += duration * gravity_x_;
        d.vy += duration * gravity_y_;
    }
}

void EventSimulation::collide(Disc& a, Disc& b) {
    const Number x = b.x - a.x, y = b.y - a.y, distance = std::sqrt(x * x + y * y);
    const Number nx = x / distance, ny = y / distance;
    const Number approach = (b.vx - a.vx) * nx + (b.vy - a.vy) * ny;
    const Number restitution = a.restitution > b.restitution ? a.restitution : b.restitution;
    const Number impulse = -(1 + restitution) * approach * a.mass * b.mass / (a.mass + b.mass);
    a.vx -= impulse / a.mass * nx, a.vy -= impulse / a.mass * ny;
    b.vx += impulse / b.mass * nx, b.vy += impulse / b.mass * ny;
    ++pair_impacts;
}

void EventSimulation::bounce(Disc& disc, const Side& side) {
    const Number approach = disc.vx * side.normal_x + disc.vy * side.normal_y;
    const Number restitution = disc.restitution > wall_restitution_ ? disc.restitution : wall_restitution_;
    const Number change = -(1 + restitution) * approach;
    disc.vx += change * side.normal_x, disc.vy += change * side.normal_y;
    wall_impulse += disc.mass * change;
    ++wall_impacts;
}

void EventSimulation::run_until(Number time) {
    for (;;) {
        const Event event = next_event();
        if (!(time_ + event.after <= time)) break;
        fly(event.after);
        Disc& a = discs[static_cast<std::size_t>(event.a)];
        if (event.b >= 0)
            collide(a, discs[static_cast<std::size_t>(event.b)]);
        else
            bounce(a, sides_[static_cast<std::size_t>(-1 - event.b)]);
    }
    fly(time - time_);
}

}  // namespace carom::test
