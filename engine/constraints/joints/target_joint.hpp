#pragma once

#include "constraints/joints/joint_rows.hpp"
#include "constraints/joints/spring_law.hpp"

namespace carom {

/// A body as a target pulls it.
struct PulledBody {
    Vec2 velocity;  // m/s
    double spin;    // rad/s
    double inverse_mass, inverse_inertia;
};

/// The impulse by which a target draws a body in a substep of h, N s: that of two springs, along x and y, at
/// the anchor, each with the mass that the body alone has there, and no more than the largest force gives.
///
/// With K = the 2 × 2 inverse mass of the anchor the spring law of both rows at once is
/// j = -(1 + gamma)^-1 K^-1 (alpha C + gamma V). What else holds the body makes it heavier, never lighter, so
/// that a spring for the body alone does not explode.
/// @param arm  m, from the centre to the anchor  @param off  m, from the target to the anchor
inline Vec2 target_impulse(const StoredJoint& joint, const PulledBody& body, Vec2 arm, Vec2 off,
                           const SpringTerms& terms, double h) {
    const double w = body.inverse_mass, i = body.inverse_inertia;
    const Vec2 velocity = body.velocity + body.spin * Vec2{-arm.y, arm.x};
    const Vec2 wanted = (-1 / (1 + terms.gamma)) * (terms.alpha * off + terms.gamma * velocity);
    const double xx = w + i * arm.y * arm.y, xy = -i * arm.x * arm.y, yy = w + i * arm.x * arm.x;
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 0)) return {};
    const Vec2 impulse =
        (1 / determinant) * Vec2{yy * wanted.x - xy * wanted.y, xx * wanted.y - xy * wanted.x};
    const double most = joint.max_force * h, size = std::sqrt(length_squared(impulse));
    return size > most ? (most / size) * impulse : impulse;
}

}  // namespace carom
