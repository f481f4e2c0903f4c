#include "solvers/paths/path_books.hpp"

#include <array>

#include "solvers/paths/contact_work.hpp"
#include "state/add_books.hpp"

namespace carom {
namespace {

template <class Real>
MeanVelocity mean_of(const BodyRecords<Real>& records, std::int32_t row) {
    const Real* end = &records.velocity[4 * static_cast<std::size_t>(row)];
    std::array<double, 3> start{end[0], end[1], end[2]};  // of what nothing moves
    if (static_cast<std::size_t>(row) < records.count()) start = records.start_of_substep(row);
    return {{0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])}, 0.5 * (start[2] + end[2])};
}

// For the executor: contacts of a task, and ns for each on one thread.
constexpr std::size_t kContactsPerTaskOfBooks = 1024;
constexpr double kNanosecondsToBook = 20;

template <class Real>
void book_contact(const PathContact<Real>& contact, const BodyRecords<Real>& records, Books& books) {
    const auto is_moved = [&](std::int32_t row) { return static_cast<std::size_t>(row) < records.count(); };
    const ContactWork<Real> booked(contact);
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
}

}  // namespace

template <class Real>
void book_paths(const PathSolver<Real>& paths, const BodyRecords<Real>& records, Books& books,
                std::vector<Books>& parts, const Executor& executor) {
    paths.for_each_surface([&](const PathContact<Real>& contact) {
        if (contact.partner.is_wall())
            books.wall_impulse += static_cast<double>(contact.link.normal1[contact.lane]) +
                                  static_cast<double>(contact.link.normal2[contact.lane]);
    });
    if (!books.is_open) return;
    paths.rolling().book(records, books);
    const std::size_t contacts = paths.manifolds.live().size();
    parts.assign((contacts + kContactsPerTaskOfBooks - 1) / kContactsPerTaskOfBooks, {});
    executor.for_each_chunk(contacts, kContactsPerTaskOfBooks, kNanosecondsToBook,
                            [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                paths.for_each_of(first, last, [&](const PathContact<Real>& contact) {
                                    book_contact(contact, records, parts[chunk]);
                                });
                            });
    for (const Books& part : parts) add_books(books, part);
}

template void book_paths(const PathSolver<float>&, const BodyRecords<float>&, Books&, std::vector<Books>&,
                         const Executor&);
template void book_paths(const PathSolver<double>&, const BodyRecords<double>&, Books&, std::vector<Books>&,
                         const Executor&);

}  // namespace carom
