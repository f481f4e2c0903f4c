#include "solvers/paths/path_books.hpp"

#include <array>

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

/// The contact in a lane of a link, in double precision.
template <class Real>
struct BookedContact {
    Vec2 normal;
    std::array<double, 3> lever_near, lever_far, impulse;  // normal 1, normal 2, tangent: rims, N s

    explicit BookedContact(const PathContact<Real>& contact) : BookedContact(contact.link, contact.lane) {}
    BookedContact(const PathLink<Real>& link, std::size_t lane)
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

}  // namespace

template <class Real>
void book_paths(const PathSolver<Real>& paths, const BodyRecords<Real>& records, Books& books) {
    paths.for_each_surface([&](const PathContact<Real>& contact) {
        if (contact.partner.is_wall())
            books.wall_impulse += static_cast<double>(contact.link.normal1[contact.lane]) +
                                  static_cast<double>(contact.link.normal2[contact.lane]);
    });
    if (!books.is_open) return;
    paths.rolling().book(records, books);
    const auto is_moved = [&](std::int32_t row) { return static_cast<std::size_t>(row) < records.count(); };
    paths.for_each([&](const PathContact<Real>& contact) {
        const BookedContact<Real> booked(contact);
        const bool is_wall = contact.partner.is_wall();
        const MeanVelocity near = mean_of(records, contact.near), far = mean_of(records, contact.far);
        books.restitution += booked.work(0, near, far) + booked.work(1, near, far);
        books.friction += booked.work(2, near, far);
        if (is_moved(contact.near) && is_moved(contact.far)) return;
        // What nothing moves gives energy by its own motion, and takes momentum.
        const bool is_far_still = !is_moved(contact.far);
        books.drive -= is_far_still ? booked.work({}, far) : booked.work(near, {});
        Vec2& momentum = is_wall ? books.wall_momentum : books.immovable_momentum;
        momentum += is_far_still ? -booked.on_far() : booked.on_far();
    });
}

template void book_paths(const PathSolver<float>&, const BodyRecords<float>&, Books&);
template void book_paths(const PathSolver<double>&, const BodyRecords<double>&, Books&);

}  // namespace carom
