#pragma once

#include "kernels/paths/path_arguments.hpp"
#include "simd/lanes.hpp"

// What one contact along a path is, a lane a path: its bodies, its levers, its masses, the law of two
// normals.

namespace carom {
namespace {

/// Solves a two-by-two problem of complementarity: x >= 0, K x + b >= 0, one of both zero. K = [k11 k12; k12
/// k22]. All four cases are told apart by the same numbers: otherwise round-off could refuse all of them and
/// drop a load.
template <class F>
[[gnu::always_inline]] inline void solve_two_normals(F k11, F k12, F k22, F b1, F b2, F& x1, F& x2) {
    using simd::select;
    const F zero(0), n1 = k12 * b2 - k22 * b1, n2 = k12 * b1 - k11 * b2;
    const F determinant = k11 * k22 - k12 * k12, inverse = F(1) / determinant;
    const auto both = (n1 >= zero) & (n2 >= zero) & (determinant > zero);
    const auto one = (!both) & (b1 < zero) & (n2 <= zero),
               two = (!both) & (!one) & (b2 < zero) & (n1 <= zero);
    x1 = select(both, n1 * inverse, select(one, -b1 / k11, zero));
    x2 = select(both, n2 * inverse, select(two, -b2 / k22, zero));
}

/// A body of a path, in the records.
template <class Lanes>
struct PathBody {
    using F = typename Lanes::Batch;
    typename Lanes::Batch4 record;  // vx, vy, rim speed [m/s], inverse mass with a sign

    F inverse_mass() const { return simd::abs(record[3]); }
    F inverse_rim_mass() const {
        const F turning = simd::max(record[3], F(0));
        return turning + turning;
    }
    /// @param spin  sum of lever times impulse
    void apply(F sign, F jx, F jy, F spin) {
        const F w = inverse_mass() * sign;
        record[0] += w * jx, record[1] += w * jy, record[2] += inverse_rim_mass() * sign * spin;
    }
};

/// A link's numbers, a lane a path.
template <class Lanes, class Real>
struct LinkLanes {
    using F = typename Lanes::Batch;
    F nx, ny, near1, near2, near_t, far1, far2, far_t;

    LinkLanes(const PathLink<Real>& link, std::size_t o)
        : nx(Lanes::load(link.normal_x + o)),
          ny(Lanes::load(link.normal_y + o)),
          near1(Lanes::load(link.near1 + o)),
          near2(Lanes::load(link.near2 + o)),
          near_t(Lanes::load(link.near_t + o)),
          far1(Lanes::load(link.far1 + o)),
          far2(Lanes::load(link.far2 + o)),
          far_t(Lanes::load(link.far_t + o)) {}

    /// Relative velocity (or displacement) of the first point along the normal, of the second, of both along
    /// the tangent.
    void relative(F dx, F dy, F of_near, F of_far, F& v1, F& v2, F& vt) const {
        const F vn = dx * nx + dy * ny;
        v1 = vn + of_far * far1 - of_near * near1;
        v2 = vn + of_far * far2 - of_near * near2;
        vt = dy * nx - dx * ny + of_far * far_t - of_near * near_t;
    }
    /// Impulse of the normal and tangential ones, in x and y.
    void impulse(F normal, F tangent, F& jx, F& jy) const {
        jx = normal * nx - tangent * ny, jy = normal * ny + tangent * nx;
    }
};

/// What an impulse along each row changes the velocity of each row by [1/kg].
template <class F>
struct LinkMass {
    F k11, k12, k22, k1t, k2t, ktt;

    LinkMass() = default;
    template <class Lanes, class Real>
    LinkMass(const LinkLanes<Lanes, Real>& l, F near_w, F near_w2, F far_w, F far_w2) {
        const F w = near_w + far_w, a1 = near_w2 * l.near1, a2 = near_w2 * l.near2, b1 = far_w2 * l.far1,
                b2 = far_w2 * l.far2;
        k11 = w + a1 * l.near1 + b1 * l.far1, k12 = w + a1 * l.near2 + b1 * l.far2;
        k22 = w + a2 * l.near2 + b2 * l.far2;
        k1t = a1 * l.near_t + b1 * l.far_t, k2t = a2 * l.near_t + b2 * l.far_t;
        ktt = w + near_w2 * l.near_t * l.near_t + far_w2 * l.far_t * l.far_t;
    }
};

/// Lanes of one batch of a bundle: what all functions below are told.
template <class Real>
struct PathBatch {
    const SolvePaths<Real>& k;
    PathLink<Real>* link;      // the first
    std::size_t length, lane;  // links; first lane of the batch
    const std::int32_t* head;  // rows

    const std::int32_t* near_rows(std::size_t i) const { return i == 0 ? head : link[i - 1].body + lane; }
    const std::int32_t* far_rows(std::size_t i) const { return link[i].body + lane; }
};

/// Calls fn(batch) for each batch of each bundle.
template <class Lanes, class Real, class Fn>
[[gnu::always_inline]] inline void for_each_path_batch(const SolvePaths<Real>& k, std::size_t first,
                                                       std::size_t last, const Fn& fn) {
    for (std::size_t bundle = first; bundle < last; ++bundle)
        for (std::size_t lane = 0; lane < kPathLanes; lane += Lanes::size)
            fn(PathBatch<Real>{k, k.links + k.first_link[bundle],
                               k.first_link[bundle + 1] - k.first_link[bundle], lane,
                               k.heads + bundle * kPathLanes + lane});
}

}  // namespace
}  // namespace carom
