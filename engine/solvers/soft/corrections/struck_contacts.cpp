#include "solvers/soft/corrections/struck_contacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "solvers/soft/impacts/hidden_contacts.hpp"
#include "state/columns/index.hpp"

namespace carom {
namespace {

// docs/decisions/0093-crowds-that-bounce.md has what else was tried.

/// Sweeps behind the impacts of a substep.
constexpr int kSweeps = 8;
/// The factor by which all of them but the last go farther.
constexpr double kFarther = 1.5;
/// The share of their impulses that is foreseen.
constexpr double kForeseen = 0.4;
// ns a contact on one thread, for the executor.
constexpr double kNanosecondsToBegin = 6;

}  // namespace

/// Pairs as they stand behind the substep.
template <class Real>
void StruckContacts<Real>::begin_pairs(const StepView<Real>& step, const Column<Real>& motion) {
    const ContactRows<Real>& pairs = step.graph.pairs;
    pairs_.resize(pairs.a.size());
    const Real *velocity = step.records.velocity.data(), *moved = step.records.displacement.data();
    const auto h = static_cast<Real>(step.terms.substep_dt);
    const Real inverse_h = 1 / h;
    const auto begin = [&](std::size_t i) {
        const std::size_t a = index(pairs.a[i]), b = index(pairs.b[i]);
        if (!(pairs.reach[i] > 0)) return pairs_.set(i, 0, 0, 0, 0);  // padding
        const Real nx = pairs.normal_x[i], ny = pairs.normal_y[i];
        const Real moved_x = moved[2 * b] - moved[2 * a], moved_y = moved[2 * b + 1] - moved[2 * a + 1];
        if (!is_hidden(pairs.separation[i])) {
            const Real now = pairs.separation[i] + moved_x * nx + moved_y * ny;
            return pairs_.set(i, nx, ny, pairs.mass[i], std::min(-now * inverse_h, Real(0)));
        }
        // The normal of an impact is that of its own moment: here that of where the two end.
        const Real x = motion[4 * b] - motion[4 * a] + moved_x,
                   y = motion[4 * b + 1] - motion[4 * a + 1] + moved_y,
                   v_x = velocity[4 * b] - velocity[4 * a], v_y = velocity[4 * b + 1] - velocity[4 * a + 1];
        const Real end_x = x + h * v_x, end_y = y + h * v_y,
                   distance = std::sqrt(end_x * end_x + end_y * end_y);
        if (!(distance > 0)) return pairs_.set(i, 0, 0, 0, 0);
        const Real now = std::sqrt(x * x + y * y) - pairs.reach[i], end = distance - pairs.reach[i],
                   to_x = end_x / distance, to_y = end_y / distance;
        const Real velocity_of_end = v_x * to_x + v_y * to_y;
        pairs_.set(i, to_x, to_y, pairs.mass[i],
                   velocity_of_end - (end - std::min(now, Real(0))) * inverse_h);
    };
    const double work = kNanosecondsToBegin * static_cast<double>(pairs.a.size());
    step.loops.executor->for_each_task(pairs.groups(), work, [&](std::size_t group) {
        for (const auto& run : runs_.of_group(group))
            for (std::size_t i = kHalfBlock * run.first, end = padded(kHalfBlock * run.last); i < end; ++i)
                begin(i);
    });
}

/// Supports likewise; those beyond the chunks have no mass.
template <class Real>
void StruckContacts<Real>::begin_supports(const StepView<Real>& step) {
    const ContactRows<Real>& supports = step.supports;
    supports_.resize(supports.a.size());
    const Real* moved = step.records.displacement.data();
    const auto elapsed = static_cast<Real>(step.terms.elapsed),
               inverse_h = static_cast<Real>(1 / step.terms.substep_dt);
    for (std::size_t i = 0; i < supports.a.size(); ++i) supports_.set(i, 0, 0, 0, 0);
    supports.for_each([&](std::size_t i) {
        if (!is_swept_[step.graph.groups.chunk_of(supports.a[i])]) return;
        const std::size_t a = index(supports.a[i]);
        const Real nx = supports.normal_x[i], ny = supports.normal_y[i];
        const Real from = is_hidden(supports.separation[i]) ? supports.clearance[i] : supports.separation[i],
                   now = from + supports.surface_normal[i] * elapsed -
                         (moved[2 * a] * nx + moved[2 * a + 1] * ny);
        supports_.set(i, nx, ny, supports.mass[i], std::min(-now * inverse_h, Real(0)));
    });
}

/// What the next substep foresees of the impulses. Those of hidden contacts are among them: the sweeps will
/// take them back, along the normal that they had, with what the bodies have of them.
template <class Real>
void StruckContacts<Real>::keep_impulses(const StepView<Real>& step, Books& books) {
    const auto share = static_cast<Real>(kForeseen);
    ContactRows<Real>&pairs = step.graph.pairs, &supports = step.supports;
    for (const auto& run : runs_.runs)
        for (std::size_t i = kHalfBlock * run.first; i < kHalfBlock * run.last; ++i) {
            if (!(pairs_.impulse[i] > 0)) continue;
            pairs.normal_impulse[i] += share * pairs_.impulse[i];
            pairs.normal_x[i] = pairs_.normal_x[i], pairs.normal_y[i] = pairs_.normal_y[i];
        }
    supports.for_each([&](std::size_t i) {
        const Real impulse = supports_.impulse[i];
        if (!(impulse > 0)) return;
        supports.normal_impulse[i] += share * impulse;
        const auto given = static_cast<double>(impulse);
        const Vec2 momentum{given * static_cast<double>(supports.normal_x[i]),
                            given * static_cast<double>(supports.normal_y[i])};
        const bool is_wall =
            step.graph.supports.partner(static_cast<std::size_t>(supports.candidate[i])).is_wall();
        if (is_wall) books.wall_impulse += given;
        if (!books.is_open) return;
        (is_wall ? books.wall_momentum : books.immovable_momentum) -= momentum;
        books.drive -= given * static_cast<double>(supports.surface_normal[i]);
        books.restitution += given * static_cast<double>(supports.surface_normal[i]);
    });
}

/// What the impulses have changed acts from the start of the substep on, and but for the share that is
/// foreseen the start is told so, too.
template <class Real>
void StruckContacts<Real>::keep_velocities(const StepView<Real>& step, const WorldState<Real>& world,
                                           Books& books) {
    const StartColumns<Real> start = step.records.start_columns();
    const Real* velocity = step.records.velocity.data();
    const auto at_start = static_cast<Real>((1 - kForeseen) / step.terms.decay);
    double work = 0;  // J
    for (std::size_t row = 0; row < step.records.moving(); ++row) {
        const Real *now = velocity + 4 * row, *before = before_.data() + 4 * row;
        const Real by_x = now[0] - before[0], by_y = now[1] - before[1];
        if (by_x == 0 && by_y == 0) continue;
        start.x[row] += at_start * by_x, start.y[row] += at_start * by_y;
        if (!books.is_open) continue;
        const auto work_along = [](Real to, Real from) {
            return 0.5 * (static_cast<double>(to) * static_cast<double>(to) -
                          static_cast<double>(from) * static_cast<double>(from));
        };
        work += static_cast<double>(world.bodies.mass[row]) *
                (work_along(now[0], before[0]) + work_along(now[1], before[1]));
    }
    books.restitution += work;
}

template <class Real>
void StruckContacts<Real>::settle(const StepView<Real>& step, const WorldState<Real>& world,
                                  ContactSweeps<Real>& sweeps, const Column<Real>& motion,
                                  const std::vector<std::uint8_t>& chunks, Books& books) {
    const TaskGroups& groups = step.graph.groups;
    is_swept_.assign(groups.chunks, 0);
    for (std::size_t chunk = 0; chunk < groups.chunks; ++chunk)
        if (chunks[chunk])
            for (std::size_t near = chunk - (chunk > 0); near <= chunk + 1 && near < groups.chunks; ++near)
                is_swept_[near] = 1;
    runs_.list(step.graph, is_swept_);
    before_ = step.records.velocity;
    begin_pairs(step, motion), begin_supports(step);
    // Those that know no friction: the impulses only push, along the normals.
    const ContactKernels<Real>& kernels = step.loops.kernels->contacts[0];
    using Sweep = typename ContactSweeps<Real>::Sweep;
    Sweep farther{kernels.next_pairs, kernels.next_supports};
    farther.times = kSweeps - 1, farther.over_relaxation = kFarther, farther.of_runs = &runs_;
    Sweep last = farther;
    last.times = 1, last.over_relaxation = 1;
    const SolveContacts<Real> k = ContactSweeps<Real>::arguments(step, step.graph.pairs);
    sweeps.run(step, std::array{farther, last}, pairs_.put_in(k),
               supports_.put_in(ContactSweeps<Real>::with_rows(k, step.supports)));
    keep_impulses(step, books), keep_velocities(step, world, books);
}

template class StruckContacts<float>;
template class StruckContacts<double>;

}  // namespace carom
