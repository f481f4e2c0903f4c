#include "solvers/manifolds/meeting.hpp"

#include "kernels/manifold_arguments.hpp"
#include "math/vec2_math.hpp"

namespace carom {
void move_back(Manifold<double>& manifold, const MovingConvex& a, const MovingConvex& b, double time) {
    const double closing = dot(b.velocity - a.velocity, {manifold.normal_x, manifold.normal_y});
    manifold.separation1 -= time * (closing + b.spin * manifold.lever_b1 - a.spin * manifold.lever_a1);
    if (manifold.separation2 < kNoPoint)
        manifold.separation2 -= time * (closing + b.spin * manifold.lever_b2 - a.spin * manifold.lever_a2);
}

bool meeting_manifold(const MovingConvex& a, const MovingConvex& b, double dt, double thickness,
                      Manifold<double>& manifold) {
    const ConvexImpact impact = impact_time(a, b, dt, kMeetingTarget * thickness);
    if (!impact.touches || !(impact.time > 0)) return false;
    manifold = manifold_of(at_time(a, impact.time), at_time(b, impact.time));
    move_back(manifold, a, b, impact.time);
    return true;
}

}  // namespace carom
