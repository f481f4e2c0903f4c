#include "solvers/soft/books.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/vec2_math.hpp"
#include "solvers/paths/contact_work.hpp"
#include "solvers/soft/contacts/stored_contact.hpp"

namespace carom {
namespace {

// Bodies of a chunk: sums have the same bits on any number of threads. ns a body and a contact on one thread,
// for the executor: docs/decisions/0080-price-of-the-ledger.md.
constexpr std::size_t kRowsToAverage = 2048;
constexpr double kNanosecondsToAverage = 1, kNanosecondsToBook = 1.5;

/// What supports give to bodies, and what they drive them with by their own motion; the impulses of walls
/// alone if the ledger is closed.
template <class Real>
void book_supports(const StepView<Real>& step, Books& books) {
    const ContactRows<Real>& supports = step.supports;
    const auto is_wall = [&](std::size_t i) {
        return step.graph.supports.partner(static_cast<std::size_t>(supports.candidate[i])).is_wall();
    };
    double wall_impulse = books.wall_impulse;
    if (!books.is_open) {
        supports.for_each([&](std::size_t i) {
            wall_impulse += is_wall(i) ? static_cast<double>(supports.normal_impulse[i]) : 0;
        });
        books.wall_impulse = wall_impulse;
        return;
    }
    Vec2 of_walls = books.wall_momentum, of_immovable = books.immovable_momentum;
    double drive = books.drive;
    supports.for_each([&](std::size_t i) {
        const StoredContact<Real> contact(supports, i);
        const ContactImpulses<double>& j = contact.impulses;
        const Vec2 n{contact.nx, contact.ny}, t{-n.y, n.x}, given = j.normal * n + j.tangent * t;
        if (is_wall(i))
            of_walls -= given, wall_impulse += j.normal;
        else
            of_immovable -= given;
        const DoubleSurface surface = surface_at(supports, i);
        drive -= j.normal * surface.normal + j.tangent * surface.tangent + j.rolling * surface.rolling;
    });
    books.wall_momentum = of_walls, books.immovable_momentum = of_immovable;
    books.drive = drive, books.wall_impulse = wall_impulse;
}

}  // namespace

/// Mean velocities of all bodies that something may move, for book_contacts. Gravity's share is booked as the
/// work it did on velocities, to be set off against the fall of the positions at the end of the step: what is
/// left is displacement that no velocity accounts for.
template <class Real>
void SubstepBooks<Real>::book_free_flight(const StepView<Real>& step, const WorldState<Real>& world,
                                          Books& books) {
    BodyRecords<Real>& records = step.records;
    const SubstepTerms& terms = step.terms;
    mean_.resize_for_overwrite(records.velocity.size());
    // Padding of contacts names rows beyond the bodies.
    std::fill(mean_.data() + 4 * records.count(), mean_.data() + mean_.size(), Real(0));
    const Property<Real>& mass = world.bodies.mass;
    const bool has_drag = terms.decay != 1 || terms.spin_decay != 1;
    const TakeMeans<Real> k{records.velocity.data(), records.start_columns(), mass.data(),
                            mass.uniform_value(), mean_.data()};
    const auto kernel = step.loops.kernels->take_means[(k.start.rim ? 1 : 0) + (has_drag ? 2 : 0)];
    flights_.assign((records.moving() + kRowsToAverage - 1) / kRowsToAverage, {});
    step.loops.executor->for_each_chunk(records.moving(), kRowsToAverage, kNanosecondsToAverage,
                                        [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                            FlightSums sums;
                                            kernel(k, first, padded(last), sums);
                                            flights_[chunk].mean = {sums.mean_x.sum(), sums.mean_y.sum()};
                                            if (!has_drag) return;
                                            flights_[chunk].start = {sums.start_x.sum(), sums.start_y.sum()};
                                            flights_[chunk].path = sums.path.sum(),
                                            flights_[chunk].turn = sums.turn.sum();
                                        });
    Flights all;
    for (const Flights& part : flights_)
        all.mean += part.mean, all.start += part.start, all.path += part.path, all.turn += part.turn;
    const double h = terms.substep_dt;
    gravity_work += h * dot(world.gravity, all.mean);
    books.gravity_momentum += (world.dynamic_mass * h) * world.gravity;
    if (!has_drag) return;
    // What drag takes from a velocity, by the numbers that bodies flew with, and from what gravity adds.
    const double loss = static_cast<double>(static_cast<Real>(terms.decay)) - 1,
                 spin_loss = static_cast<double>(static_cast<Real>(terms.spin_decay)) - 1;
    const Vec2 of_gravity = terms.gravity_change - h * world.gravity;
    books.drag += loss * all.path + dot(of_gravity, all.mean) + 0.5 * spin_loss * all.turn;
    books.drag_momentum += loss * all.start + world.dynamic_mass * of_gravity;
}

/// What contacts take: those of a group one behind the other, so that sums have the same bits on any number
/// of threads.
template <class Real>
void SubstepBooks<Real>::book_contacts(const StepView<Real>& step, Books& books) {
    const ContactKernels<Real>& kernels = *step.loops.contacts;
    ContactRows<Real>&pairs = step.graph.pairs, &supports = step.supports;
    SolveContacts<Real> on_pairs{}, on_supports{};
    on_pairs.contacts = pairs.columns(), on_pairs.velocity = mean_.data();
    on_supports.contacts = supports.columns(), on_supports.velocity = mean_.data();
    const std::size_t groups = pairs.groups();
    works_.assign(groups + supports.groups(), {});
    const auto is_empty = [&](std::size_t group) {
        if (group < groups) return pairs.run_count[group] == 0;
        return supports.first_colour[group - groups] == supports.first_colour[group - groups + 1];
    };
    const auto book = [&](std::size_t group) {
        if (is_empty(group)) return;  // in a world of few bodies most are, and to add up nothing takes time
        WorkSums sums;
        if (group < groups) {
            const auto* run = pairs.run.data() + pairs.first_place(group) / kContactBlock;
            for (const auto* const end = run + pairs.run_count[group]; run < end; ++run)
                kernels.sum_work_pairs(on_pairs, kHalfBlock * run->first, kHalfBlock * run->last, sums);
        } else {
            const std::size_t of = group - groups;
            for (std::size_t c = supports.first_colour[of]; c < supports.first_colour[of + 1]; ++c)
                kernels.sum_work_supports(on_supports, supports.begin[c],
                                          supports.begin[c] + supports.length(c), sums);
        }
        works_[group] = {sums.normal.sum(), sums.tangent.sum()};
    };
    step.loops.executor->for_each_task(
        works_.size(), kNanosecondsToBook * static_cast<double>(pairs.a.size() + supports.a.size()), book);
    Work all{0, 0};  // J
    for (const Work& work : works_) all.normal += work.normal, all.tangent += work.tangent;
    // Both act at once, and a mean velocity says nothing of which came first: where friction draws a body on
    // to what stops it, the stop seems to give what friction takes too much. Neither gives any.
    const double shared = all.normal > 0    ? std::min(all.normal, std::max(-all.tangent, 0.0))
                          : all.tangent > 0 ? -std::min(all.tangent, -all.normal)
                                            : 0;
    books.restitution += all.normal - shared, books.friction += all.tangent + shared;
}

template <class Real>
void SubstepBooks<Real>::book_substep(const StepView<Real>& step, const WorldState<Real>& world,
                                      Books& books) {
    book_supports(step, books);
    if (!books.is_open) return;
    book_free_flight(step, world, books);
    book_contacts(step, books);
}

template <class Real>
void SubstepBooks<Real>::book_displacements(std::size_t rows, const WorldState<Real>& world,
                                            const Column<Real>& motion, Books& books) {
    double fall = 0;
    const Bodies<Real>& bodies = world.bodies;
    for (std::size_t row = 0; row < rows; ++row) {
        if (bodies.is_immovable(row)) continue;
        const Vec2 from{motion[4 * row], motion[4 * row + 1]},
            to{bodies.position_x[row], bodies.position_y[row]};
        fall += static_cast<double>(bodies.mass[row]) * dot(world.gravity, to - from);
    }
    books.correction += gravity_work - fall;
    gravity_work = 0;
}

template <class Real>
void SubstepBooks<Real>::book_overlaps(const StepView<Real>& step, const PathSolver<Real>& paths,
                                       const WorldState<Real>& world, Books& books) {
    const double g = std::sqrt(length_squared(world.gravity)), per_h = 1 / step.terms.substep_dt;
    std::array<double, kHalfBlock> sums{};  // J; of pairs, every kHalfBlock-th
    const auto add = [&](const ContactRows<Real>& rows, std::size_t i, double& sum) {
        const double separation = rows.separation[i], depth = separation < 0 ? -separation : 0;
        sum += depth *
               (per_h * static_cast<double>(rows.normal_impulse[i]) + g * static_cast<double>(rows.mass[i]));
    };
    const ContactRows<Real>&pairs = step.graph.pairs, &supports = step.supports;
    for (std::size_t group = 0; group < pairs.groups(); ++group) {
        const auto* run = pairs.run.data() + pairs.first_place(group) / kContactBlock;
        for (const auto* const end = run + pairs.run_count[group]; run < end; ++run)
            for (std::size_t first = kHalfBlock * run->first; first < kHalfBlock * run->last;
                 first += kHalfBlock)
                for (std::size_t k = 0; k < kHalfBlock; ++k) add(pairs, first + k, sums[k]);
    }
    double worth = 0;
    for (const double sum : sums) worth += sum;
    supports.for_each([&](std::size_t i) { add(supports, i, worth); });
    if (world.bodies.has_shapes)
        paths.for_each([&](const PathContact<Real>& contact) {
            const ContactWork<Real> of(contact);
            const auto depth = [](Real separation) { return std::fmax(0, -static_cast<double>(separation)); };
            const double depth1 = depth(contact.link.separation1[contact.lane]),
                         depth2 = depth(contact.link.separation2[contact.lane]);
            if (depth1 + depth2 == 0) return;
            double mass = 0;  // kg, of both: no less than the effective one
            for (const std::int32_t row : {contact.near, contact.far}) {
                const auto r = static_cast<std::size_t>(row);
                if (r < step.records.count() && !world.bodies.is_immovable(r))
                    mass += static_cast<double>(world.bodies.mass[r]);
            }
            worth +=
                depth1 * (per_h * of.impulse[0] + mass * g) + depth2 * (per_h * of.impulse[1] + mass * g);
        });
    books.overlap_worth += worth;
}

template class SubstepBooks<float>;
template class SubstepBooks<double>;

}  // namespace carom
