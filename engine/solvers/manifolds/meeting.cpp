#include "solvers/manifolds/meeting.hpp"

#include <cmath>

#include "kernels/manifolds/manifold_arguments.hpp"
#include "math/vec2_math.hpp"

namespace carom {

MovingConvex still_edge(const Edge& edge) {
    const Vec2 centre = 0.5 * (edge.a + edge.b), half = 0.5 * (edge.b - edge.a);
    const double length = std::sqrt(length_squared(half));
    const Vec2 normal{half.y / length, -half.x / length};  // right of the way from a to b
    ConvexShape<double> shape{};
    for (int i = 0; i < kMostVertices; ++i) {
        const double end = i == 0 ? -1 : 1;
        shape.x[i] = end * half.x, shape.y[i] = end * half.y;
        shape.normal_x[i] = -end * normal.x, shape.normal_y[i] = -end * normal.y;
    }
    shape.extent = length, shape.count = 2;
    return {shape, centre, {}, 0, 0};
}

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
