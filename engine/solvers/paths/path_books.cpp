#include <array>

#include "constraints/partner.hpp"
#include "solvers/paths/path_solver.hpp"

namespace carom {
namespace {

/// Mean velocity of a body over a substep.
struct MeanVelocity {
    Vec2 velocity;   // m/s
    double rim = 0;  // m/s
};

template <class Real>
MeanVelocity mean_of(const BodyRecords<Real>& records, std::int32_t row) {
    const Real* end = &records.velocity[4 * static_cast<std::size_t>(row)];
    std::array<double, 3> start{end[0], end[1], end[2]};  // of what nothing moves
    if (static_cast<std::size_t>(row) < records.count()) start = records.start_of_substep(row);
    return {{0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])}, 0.5 * (start[2] + end[2])};
}

/// The contact in a lane of a link, from body a to b, in double precision.
template <class Real>
struct BookedContact {
    Vec2 normal;
    std::array<double, 3> lever_a, lever_b, impulse;  // normal 1, normal 2, tangent: rims, N s

    BookedContact(const PathLink<Real>& link, typename PathCut::Place place)
        : normal{link.normal_x[place.lane], link.normal_y[place.lane]},
          lever_a{link.near1[place.lane], link.near2[place.lane], link.near_t[place.lane]},
          lever_b{link.far1[place.lane], link.far2[place.lane], link.far_t[place.lane]},
          impulse{link.normal1[place.lane], link.normal2[place.lane], link.tangent[place.lane]} {
        if (!place.is_reversed) return;
        normal = -normal;
        std::swap(lever_a, lever_b);
        for (std::size_t k = 0; k < 3; ++k) lever_a[k] = -lever_a[k], lever_b[k] = -lever_b[k];
    }
    Vec2 tangent() const { return {-normal.y, normal.x}; }
    /// Work of impulse k on both bodies [J].
    double work(std::size_t k, const MeanVelocity& a, const MeanVelocity& b) const {
        const Vec2 along = k < 2 ? normal : tangent();
        return impulse[k] * (dot(b.velocity - a.velocity, along) + b.rim * lever_b[k] - a.rim * lever_a[k]);
    }
    /// Of the whole impulse on b by a velocity of b alone [J].
    double work_on_b(const MeanVelocity& b) const { return work(0, {}, b) + work(1, {}, b) + work(2, {}, b); }
    Vec2 on_b() const { return (impulse[0] + impulse[1]) * normal + impulse[2] * tangent(); }
};

}  // namespace

template <class Real>
void PathSolver<Real>::book_substep(const BodyRecords<Real>& records, Books& books) {
    for (std::size_t n = 0; n < live_.size(); ++n) {
        const typename PathCut::Place place = cut_.places()[n];
        const BookedContact<Real> contact(links_[place.link], place);
        const Partner partner(list_of(live_[n]).b[place_of(live_[n])]);
        if (partner.is_wall()) books.wall_impulse += contact.impulse[0] + contact.impulse[1];
        if (!books.is_open) continue;
        const std::int32_t row_a = list_of(live_[n]).a[place_of(live_[n])], row_b = row_of_far_[n];
        const MeanVelocity a = mean_of(records, row_a), b = mean_of(records, row_b);
        books.restitution += contact.work(0, a, b) + contact.work(1, a, b);
        books.friction += contact.work(2, a, b);
        if (static_cast<std::size_t>(row_b) < records.count()) continue;
        // Nothing moves b: what it is given comes from outside.
        books.drive -= contact.work_on_b(b);
        (partner.is_wall() ? books.wall_momentum : books.immovable_momentum) -= contact.on_b();
    }
}

template void PathSolver<float>::book_substep(const BodyRecords<float>&, Books&);
template void PathSolver<double>::book_substep(const BodyRecords<double>&, Books&);

}  // namespace carom
