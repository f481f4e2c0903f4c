// Discs in a wedge of two surfaces that nothing moves: B37.
#include <algorithm>
#include <cmath>

#include "measure/text.hpp"
#include "torture/hard/hard_case.hpp"

namespace carom::torture {
namespace {

using measure::format;

constexpr double kRadius = 0.1, kSpeed = 1;  // m, m/s
constexpr double kAngles[] = {0.02, 0.05, 0.2, 0.5, 1};
constexpr double kFrictions[] = {0, 0.2};  // of what holds a disc: tan of half the angle

/// A floor, and a kinematic line that rises from it to the right and comes down on discs that lie on it.
Scene closing_wedge(double angle, int discs, double friction) {
    constexpr double kAt = 2, kLength = 20, kGap = 0.01;  // m
    const Material material{.friction = friction};
    Scene scene;
    scene.walls = Walls{.min = {-1e4, 0},
                        .max = {1e4, 1e4},
                        .left = false,
                        .right = false,
                        .top = false,
                        .material = material};
    Body blade{.type = BodyType::kinematic_body,
               .shape = Segment{{0, 0}, {kLength, 0}},
               .angle = angle,
               .velocity = {0, -kSpeed},
               .material = material};
    // Where its line passes the first disc at a distance of the radius and a gap.
    blade.position.y = kRadius + (kRadius + kGap - kAt * std::sin(angle)) / std::cos(angle);
    scene.add(blade);
    for (int i = 0; i < discs; ++i)
        scene.add({.shape = Disc{kRadius},
                   .position = {kAt + i * (2 * kRadius + kGap), kRadius},
                   .material = material});
    return scene;
}

/// What touches both surfaces moves at the line's speed over tan(angle).
Measures speed_out_of_wedge(HardRun& run) {
    constexpr double kWay = 6;  // m, of a disc at that speed
    const double fastest = kSpeed / std::tan(run.scene().bodies[0].angle);
    Largest most;
    double lowest = kRadius;
    for (double time = 0; time < kWay / fastest && run.step(kUsualStep); time += kUsualStep)
        for (std::size_t body = 1; body < run.count(); ++body)
            most.take(run.speed(body)), lowest = std::fmin(lowest, run.place(body).y);
    // One disc keeps the law; those in front of others are hit by them.
    return {{"speed/limit", most.value() / fastest, run.count() > 2 ? 1.5 : 1.02},
            {"radii below the floor", 1 - lowest / kRadius, 1},
            {"m/s", most.value()}};
}

/// A V of two lines, and a disc that is thrown into it from above.
Scene vee(double angle, double friction, double gravity) {
    constexpr double kLength = 50, kGap = 0.05;  // m
    const Material material{.friction = friction};
    Scene scene;
    scene.gravity = {0, -gravity};
    const Vec2 end{kLength * std::sin(angle / 2), kLength * std::cos(angle / 2)};
    for (const double side : {-1.0, 1.0})
        scene.add({.type = BodyType::static_body,
                   .shape = Segment{{0, 0}, {side * end.x, end.y}},
                   .material = material});
    scene.add({.shape = Disc{kRadius},
               .position = {0, kRadius / std::sin(angle / 2) + kGap},
               .velocity = {0, -kSpeed},
               .material = material});
    return scene;
}

/// Nothing bounces here, so that the disc stays.
Measures rebound_from_vee(HardRun& run) {
    Largest up, down;
    for (int i = 0; i < 300 && run.step(kUsualStep); ++i) {
        const double upward = run.state(2).velocity.y;
        up.take(upward), down.take(-upward);
    }
    return {{"m/s up", up.value(), 0.03}, {"overlap", run.overlap(), 0.01}, {"m/s down", down.value()}};
}

/// Calls fn(angle, friction) for every wedge.
template <class Fn>
void for_each_wedge(const Fn& fn) {
    for (const double angle : kAngles)
        for (const double share : kFrictions) fn(angle, share * std::tan(angle / 2));
}

}  // namespace

HardCases discs_in_closing_wedges(Extent) {
    HardCases all;
    for_each_wedge([&](double angle, double friction) {
        for (const int discs : {1, 3})
            all.push_back({.code = "B37",
                           .name = format("wedge of %g rad that closes, discs: %d, friction %.2g", angle,
                                          discs, friction),
                           .make = [=] { return closing_wedge(angle, discs, friction); },
                           .run = speed_out_of_wedge});
    });
    return all;
}

HardCases discs_thrown_into_wedges(Extent) {
    HardCases all;
    for_each_wedge([&](double angle, double friction) {
        for (const double gravity : {0.0, 10.0})
            all.push_back({.code = "B37",
                           .name = format("disc thrown into a V of %g rad, friction %.2g, gravity %g", angle,
                                          friction, gravity),
                           .make = [=] { return vee(angle, friction, gravity); },
                           .run = rebound_from_vee});
    });
    return all;
}

}  // namespace carom::torture
