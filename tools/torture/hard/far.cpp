// Far from the origin: B11.
#include <cmath>
#include <initializer_list>

#include "measure/text.hpp"
#include "torture/hard/discs.hpp"
#include "torture/hard/far.hpp"
#include "torture/hard/hard_case.hpp"

namespace carom::torture {
namespace {

using measure::format;

constexpr double kSlope = 0.3;  // rad, of the incline

struct Place {
    const char* name;
    Scene (*make)(double distance);
};

Scene with_floor(double distance, double angle, double half_length) {
    const Material rough{.friction = 0.5};
    Scene scene;
    scene.gravity = {0, -10};
    scene.add({.type = BodyType::static_body,
               .shape = Box{2 * half_length, 2},
               .position = {distance + std::sin(angle), distance - std::cos(angle)},
               .angle = -angle,
               .material = rough});
    return scene;
}

/// A disc that rolls on a floor with 2 m/s.
Scene rolling(double distance) {
    constexpr double kRadius = 0.5, kSpeed = 2;  // m, m/s
    Scene scene = with_floor(distance, 0, 100);
    scene.add({.shape = Disc{kRadius},
               .position = {distance, distance + kRadius},
               .velocity = {kSpeed, 0},
               .angular_velocity = -kSpeed / kRadius,
               .material = scene.bodies[0].material});
    return scene;
}

/// A box that lies on an incline less steep than its friction.
Scene on_incline(double distance) {
    constexpr double kHalf = 0.5;  // m
    Scene scene = with_floor(distance, kSlope, 20);
    scene.add({.shape = Box{2 * kHalf, 2 * kHalf},
               .position = {distance + kHalf * std::sin(kSlope), distance + kHalf * std::cos(kSlope)},
               .angle = -kSlope,
               .material = scene.bodies[0].material});
    return scene;
}

/// How far bodies get from where the same ones get at the origin. Double precision has a mark; single
/// precision, which has 1 mm at 1e4 m and 60 mm at 1e6 m, has one for what sinks at 1e4 m.
Measures off_from_origin(HardRun& run, const Place& place, double distance) {
    const bool is_single = run.scene().accuracy.precision == Precision::single_;
    const std::unique_ptr<HardRun> origin = run.another(place.make(0));
    const Shifts shifts(run), own(*origin);
    Largest off, sink;
    for (int i = 0; i < 600 && run.step() && origin->step(); ++i)
        for (std::size_t body = 1; body < run.count(); ++body) {
            const Vec2 a = run.place(body), b = origin->place(body), from = shifts.start(body),
                       there = own.start(body);
            off.take(std::hypot(a.x - from.x - (b.x - there.x), a.y - from.y - (b.y - there.y)));
            sink.take(shifts.sink(run, body) - own.sink(*origin, body));
        }
    Measure way{"m off", off.value()}, depth{"m sunk", sink.value()};
    if (!is_single) way.mark = 1e-9;
    if (is_single && distance <= 1e4) depth.mark = 2e-3;
    return is_single ? Measures{depth, way} : Measures{way, depth};
}

HardCases far_away(std::initializer_list<Place> places) {
    HardCases all;
    for (const Place& place : places)
        for (const double distance : {1e4, 1e5, 1e6})
            all.push_back({.code = "B11",
                           .name = format("%s, %g m from the origin", place.name, distance),
                           .make = [=] { return place.make(distance); },
                           .run = [=](HardRun& run) { return off_from_origin(run, place, distance); }});
    return all;
}

}  // namespace

Scene stack_far_away(double distance) {
    constexpr int kBoxes = 10;
    Scene scene = with_floor(distance, 0, 20);
    for (int i = 0; i < kBoxes; ++i)
        scene.add({.shape = Box{1, 1},
                   .position = {distance, distance + i + 0.5},
                   .material = scene.bodies[0].material});
    return scene;
}

HardCases far_from_the_origin(Extent) {
    return far_away({{"stack of ten boxes", stack_far_away}, {"box on an incline", on_incline}});
}

HardCases rolling_far_from_the_origin(Extent) {
    return far_away({{"rolling disc", rolling}});
}

}  // namespace carom::torture
