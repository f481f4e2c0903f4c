#include "solvers/contact_sets/project_positions.hpp"

#include <cmath>

#include "narrowphase/coincident.hpp"

namespace carom {
namespace {

constexpr int kSweepsOfProjection = 32;  // what is left is pushed apart in the next step
/// A push of less than this share of what a pair may overlap is not worth another sweep.
constexpr double kCloseEnough = 0.1;

}  // namespace

bool PositionProjection::push_pair(const Pair& pair) {
    const auto a = static_cast<std::size_t>(pair.a);
    const auto b = static_cast<std::size_t>(pair.b);
    const Vec2 d = (pair.b < 0 ? pair.place : place[b]) - place[a];
    const double near = pair.reach + pair.least, squared = length_squared(d);
    if (squared >= near * near) return false;
    const double distance = std::sqrt(squared), missing = near - distance;
    const Vec2 n = distance > 0 ? (1 / distance) * d
                                : normal_of_coincident(static_cast<std::uint32_t>(pair.a),
                                                       static_cast<std::uint32_t>(pair.b));
    place[a] -= pair.share_a * missing * n;
    is_moved[a] = 1;
    if (pair.b >= 0) place[b] += pair.share_b * missing * n, is_moved[b] = 1;
    return missing > -kCloseEnough * pair.least;
}

bool PositionProjection::push_from_plane(const Plane& plane) {
    const auto a = static_cast<std::size_t>(plane.a);
    const double missing = dot(plane.normal, place[a]) + plane.radius - plane.end;
    if (missing <= 0) return false;
    place[a] -= missing * plane.normal;
    is_moved[a] = 1;
    return missing > kCloseEnough * plane.radius;
}

bool PositionProjection::push_from_planes() {
    bool any = false;
    for (const Plane& plane : planes) any |= push_from_plane(plane);
    return any;
}

bool PositionProjection::part() {
    bool any = false;
    for (int sweep = 0; sweep < kSweepsOfProjection; ++sweep) {
        bool goes_on = false;
        for (const Pair& pair : pairs) goes_on |= push_pair(pair);
        goes_on |= push_from_planes();
        any |= goes_on;
        if (!goes_on) break;
    }
    return any;
}

}  // namespace carom
