#include "narrowphase/convex_impact_time.hpp"

#include <cmath>

#include "narrowphase/placed_pair.hpp"

namespace carom {
namespace {

/// How fast points of the shape move round its centre at most [m/s]; a rounding turns in itself.
double rim_speed(const MovingConvex& body) {
    return std::fabs(body.spin) * (body.shape.extent - body.shape.radius);
}

}  // namespace

PlacedConvex at_time(const MovingConvex& body, double time) {
    return {body.shape, body.centre + time * body.velocity, rotation_by(body.angle + time * body.spin)};
}

ConvexImpact impact_time(const MovingConvex& a, const MovingConvex& b, double dt, double target,
                         double depth) {
    const double turning = rim_speed(a) + rim_speed(b);
    const auto centre = [](const MovingConvex& body, double at) { return body.centre + at * body.velocity; };
    const Rotation first_a = rotation_by(a.angle), first_b = rotation_by(b.angle);
    const auto turn = [](const MovingConvex& body, Rotation first, double at) {
        return body.spin == 0 ? first : rotation_by(body.angle + at * body.spin);
    };
    MovablePair pair(a.shape, b.shape);
    double time = 0;
    for (int i = 0;; ++i) {
        Separation apart =
            pair.separation(centre(a, time), turn(a, first_a, time), centre(b, time), turn(b, first_b, time));
        apart.distance += depth;
        if (apart.distance <= target || i == kMostAdvances) return {time, true, apart.normal, apart.distance};
        if (time == dt) return {dt, false, apart.normal, apart.distance};
        const double approach = dot(a.velocity - b.velocity, apart.normal) + turning;
        const double safe = apart.distance - 0.5 * target;
        time = approach * (dt - time) > safe ? time + safe / approach : dt;
    }
}

}  // namespace carom
