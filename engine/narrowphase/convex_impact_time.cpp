#include "narrowphase/convex_impact_time.hpp"

#include <cmath>

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
    double time = 0;
    for (int i = 0;; ++i) {
        Separation apart = separation_of(at_time(a, time), at_time(b, time));
        apart.distance += depth;
        if (apart.distance <= target || i == kMostAdvances) return {time, true, apart.normal, apart.distance};
        if (time == dt) return {dt, false, apart.normal, apart.distance};
        const double approach = dot(a.velocity - b.velocity, apart.normal) + turning;
        const double safe = apart.distance - 0.5 * target;
        time = approach * (dt - time) > safe ? time + safe / approach : dt;
    }
}

}  // namespace carom
