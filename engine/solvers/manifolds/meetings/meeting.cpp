#include "solvers/manifolds/meetings/meeting.hpp"

#include <cmath>

#include "kernels/manifolds/manifold_arguments.hpp"
#include "math/vec2_math.hpp"

namespace carom {
namespace {

/// Vertices are of one face if they are as far out along its normal but for this share of how long the shape
/// is: an angle of 0.3 degrees.
constexpr double kSameFace = 0.005;

struct Interval {
    double low, high;  // m
};

/// What of a body is farthest out along a normal, as an interval along the tangent: a face, or one vertex.
Interval outermost(const MovingConvex& body, Vec2 normal, Vec2 tangent, double time) {
    const Rotation turn = rotation_by(body.angle);
    const Vec2 n = rotate_back(turn, normal), t = rotate_back(turn, tangent);
    const ConvexShape<double>& shape = body.shape;
    double farthest = -HUGE_VAL, length = 0;
    for (int i = 0; i < shape.count; ++i) {
        farthest = std::fmax(farthest, shape.x[i] * n.x + shape.y[i] * n.y);
        const Vec2 from_first{shape.x[i] - shape.x[0], shape.y[i] - shape.y[0]};
        length = std::fmax(length, std::sqrt(length_squared(from_first)));
    }
    Interval found{HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < shape.count; ++i) {
        if (shape.x[i] * n.x + shape.y[i] * n.y < farthest - kSameFace * length) continue;
        const double along = shape.x[i] * t.x + shape.y[i] * t.y;
        found.low = std::fmin(found.low, along), found.high = std::fmax(found.high, along);
    }
    const double centre = dot(body.centre + time * body.velocity, tangent);
    return {centre + found.low, centre + found.high};
}

}  // namespace

bool meets_face(const MovingConvex& a, const MovingConvex& b, Vec2 normal, double dt, double gap,
                double thickness) {
    const double closing = dot(a.velocity - b.velocity, normal), grazing = kGrazing * thickness;
    const double time = closing * dt > gap ? std::fmax(gap, 0) / closing : dt;
    const Vec2 tangent{-normal.y, normal.x};
    const Interval of_a = outermost(a, normal, tangent, time), of_b = outermost(b, -normal, tangent, time);
    const double longer = std::fmax(of_a.high - of_a.low, of_b.high - of_b.low);
    return longer > grazing && std::fmin(of_a.high - of_b.low, of_b.high - of_a.low) > grazing;
}

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

void move_back(Manifold<double>& manifold, const RelativeMotion& motion, double time) {
    const double closing = dot(motion.velocity, {manifold.normal_x, manifold.normal_y});
    manifold.separation1 -=
        time * (closing + motion.spin_b * manifold.lever_b1 - motion.spin_a * manifold.lever_a1);
    if (manifold.separation2 < kNoPoint)
        manifold.separation2 -=
            time * (closing + motion.spin_b * manifold.lever_b2 - motion.spin_a * manifold.lever_a2);
}

bool pass_plane(const Manifold<double>& manifold, const RelativeMotion& motion, double dt, double thickness) {
    if (!(std::fmin(manifold.separation1, manifold.separation2) > 0)) return false;
    Manifold<double> then = manifold;
    move_back(then, motion, -dt);
    return -std::fmin(then.separation1, then.separation2) > kPassing * thickness;
}

bool pass_each_other(const MovingConvex& a, const MovingConvex& b, const Manifold<double>& manifold,
                     double dt, double thickness) {
    if (!pass_plane(manifold, relative_motion(a, b), dt, thickness)) return false;
    const double gap = std::fmin(manifold.separation1, manifold.separation2);
    if (meets_face(a, b, {manifold.normal_x, manifold.normal_y}, dt, gap, thickness)) return false;
    const double target = kMeetingTarget * thickness;
    return !impact_time(a, b, dt, target, kGrazing * thickness + target).touches;
}

bool are_beside(const MovingConvex& a, const MovingConvex& b, const Manifold<double>& manifold, double dt,
                double thickness) {
    const double least = kBeside * thickness;
    if (!(std::fabs(manifold.separation1) <= least)) return false;
    const Vec2 normal{manifold.normal_x, manifold.normal_y}, tangent{-normal.y, normal.x};
    const Interval of_a = outermost(a, normal, tangent, 0), of_b = outermost(b, -normal, tangent, 0);
    const bool are_faces = std::fmin(of_a.high - of_a.low, of_b.high - of_b.low) > least;
    const bool b_is_higher = of_a.high - of_b.low < of_b.high - of_a.low;
    if (!are_faces || (b_is_higher ? of_a.high - of_b.low : of_b.high - of_a.low) > least) return false;
    const Vec2 closing = a.velocity - b.velocity;
    const double along = b_is_higher ? dot(closing, tangent) : -dot(closing, tangent);
    return !(dt * dot(closing, normal) > least && dt * along > least);
}

bool meeting_manifold(const MovingConvex& a, const MovingConvex& b, double dt, double thickness,
                      Manifold<double>& manifold) {
    const ConvexImpact impact = impact_time(a, b, dt, kMeetingTarget * thickness);
    if (!impact.touches || !(impact.time > 0)) return false;
    manifold = manifold_of(at_time(a, impact.time), at_time(b, impact.time));
    move_back(manifold, relative_motion(a, b), impact.time);
    return true;
}

}  // namespace carom
