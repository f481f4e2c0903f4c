#pragma once

#include <array>

#include "math/vec2_math.hpp"
#include "solvers/paths/path_solver.hpp"

namespace carom {

/// Mean velocity of a body over the time in which impulses act.
struct MeanVelocity {
    Vec2 velocity;   // m/s
    double rim = 0;  // m/s
};

/// A contact along a path, in double precision: what its impulses do.
template <class Real>
struct ContactWork {
    Vec2 normal;
    std::array<double, 3> lever_near, lever_far, impulse;  // normal 1, normal 2, tangent: rims, N s

    explicit ContactWork(const PathContact<Real>& contact) : ContactWork(contact.link, contact.lane) {}
    ContactWork(const PathLink<Real>& link, std::size_t lane)
        : normal{link.normal_x[lane], link.normal_y[lane]},
          lever_near{link.near1[lane], link.near2[lane], link.near_t[lane]},
          lever_far{link.far1[lane], link.far2[lane], link.far_t[lane]},
          impulse{link.normal1[lane], link.normal2[lane], link.tangent[lane]} {}

    Vec2 tangent() const { return {-normal.y, normal.x}; }
    /// Work of impulse k on both bodies [J].
    double work(std::size_t k, const MeanVelocity& near, const MeanVelocity& far) const {
        const Vec2 along = k < 2 ? normal : tangent();
        return impulse[k] *
               (dot(far.velocity - near.velocity, along) + far.rim * lever_far[k] - near.rim * lever_near[k]);
    }
    double work(const MeanVelocity& near, const MeanVelocity& far) const {
        return work(0, near, far) + work(1, near, far) + work(2, near, far);
    }
    Vec2 on_far() const { return (impulse[0] + impulse[1]) * normal + impulse[2] * tangent(); }
};

}  // namespace carom
