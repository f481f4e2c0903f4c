#pragma once

namespace carom {

/// Separation of a point that a manifold does not have [m].
inline constexpr double kNoPoint = 1e30;

/// Where two convex shapes touch, in the terms of ManifoldColumns (kernels/manifolds/manifold_arguments.hpp):
/// a number or a batch each.
template <class F>
struct Manifold {
    F normal_x, normal_y;
    F lever_a1, lever_a2, lever_b1, lever_b2;  // m
    F lever_a_t, lever_b_t;                    // m
    F separation1, separation2;                // m
};

}  // namespace carom
