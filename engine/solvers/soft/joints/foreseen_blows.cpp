#include "solvers/soft/joints/foreseen_blows.hpp"

#include <algorithm>

#include "solvers/paths/contact_work.hpp"
#include "solvers/soft/contacts/stored_contact.hpp"

namespace carom {
namespace {

/// What contacts may give a group, above round-off and the bends of joints: a share of the energy that free
/// flight leaves it, and that of so many times the speed that gravity adds in a substep.
constexpr double kLeastShare = 1e-3, kFallsOfGroup = 2;

constexpr double kNanosecondsToLook = 3;    // a body, on one thread, for the executor
constexpr std::size_t kGroupsPerTask = 16;  // some microseconds of work

/// A body's velocity after a substep of free flight.
template <class Real>
class FreeVelocities {
  public:
    FreeVelocities(const BodyRecords<Real>& records, const SubstepTerms& terms)
        : records_(records), terms_(terms) {}

    DoubleBody free(std::int32_t row) const {
        const auto [x, y, rim] = records_.free_flight(row, terms_);
        return DoubleBody{{{x, y, rim, 0}}};
    }
    /// The mean of that and of the velocity now; of what nothing moves, its own.
    DoubleBody mean(std::int32_t row) const {
        DoubleBody body = body_at(records_.velocity, row);
        if (static_cast<std::size_t>(row) >= records_.count() || body.record[3] == 0) return body;
        const DoubleBody before = free(row);
        for (std::size_t k = 0; k < 3; ++k) body.record[k] = 0.5 * (body.record[k] + before.record[k]);
        return body;
    }

  private:
    const BodyRecords<Real>& records_;
    const SubstepTerms& terms_;
};

double energy_of(double mass, const DoubleBody& body) {
    const auto& v = body.record;
    return 0.5 * mass * (v[0] * v[0] + v[1] * v[1] + 0.5 * v[2] * v[2]);
}

}  // namespace

template <class Real>
void ForeseenBlows<Real>::set_groups(const std::vector<std::int32_t>& group_of, std::size_t groups) {
    group_of_ = group_of;
    first_.assign(groups + 1, 0);
    for (const std::int32_t group : group_of_)
        if (group >= 0) ++first_[static_cast<std::size_t>(group) + 1];
    for (std::size_t group = 0; group < groups; ++group) first_[group + 1] += first_[group];
    members_.resize(first_[groups]);
    std::vector<std::size_t> place(first_.begin(), first_.end());
    for (std::size_t row = 0; row < group_of_.size(); ++row)
        if (group_of_[row] >= 0)
            members_[place[static_cast<std::size_t>(group_of_[row])]++] = static_cast<std::int32_t>(row);
    is_thrown_.assign(groups, 0), least_.assign(groups, 0), work_.assign(groups, 0);
}

/// Marks groups that have more energy than free flight left them.
template <class Real>
bool ForeseenBlows<Real>::find_risen(const JointStep<Real>& step, const StepLoops<Real>& loops,
                                     const std::vector<std::uint8_t>& touches) {
    const FreeVelocities<Real> velocities(step.records, step.terms);
    loops.executor->for_each_chunk(
        is_thrown_.size(), kGroupsPerTask,
        kNanosecondsToLook * static_cast<double>(members_.size()) /
            static_cast<double>(is_thrown_.size() + 1),
        [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t group = first; group < last; ++group) {
                is_thrown_[group] = 0;
                if (!touches[group]) continue;
                double before = 0, now = 0, mass_sum = 0;
                for (std::size_t i = first_[group]; i < first_[group + 1]; ++i) {
                    const std::int32_t row = members_[i];
                    const double mass = step.world.bodies.mass[static_cast<std::size_t>(row)];
                    mass_sum += mass, before += energy_of(mass, velocities.free(row));
                    now += energy_of(mass, body_at(step.records.velocity, row));
                }
                const double fall = kFallsOfGroup * step.terms.fall_speed();
                least_[group] = kLeastShare * before + 0.5 * mass_sum * fall * fall;
                is_thrown_[group] = now > before + least_[group];
            }
        });
    return std::find(is_thrown_.begin(), is_thrown_.end(), 1) != is_thrown_.end();
}

template <class Real>
bool ForeseenBlows<Real>::find(const JointStep<Real>& step, const StepView<Real>& contacts,
                               const PathSolver<Real>& paths, const JoinedContacts& joined,
                               const std::vector<std::uint8_t>& touches) {
    if (!find_risen(step, contacts.loops, touches)) return false;
    // Motors and springs give energy, too, and so do belts by their own motion: what counts is the work of
    // contacts.
    std::fill(work_.begin(), work_.end(), 0);
    const FreeVelocities<Real> velocities(step.records, step.terms);
    const auto risen_at = [&](std::int32_t row) {
        const auto r = static_cast<std::size_t>(row);
        const std::int32_t group = row >= 0 && r < group_of_.size() ? group_of_[r] : -1;
        return group >= 0 && is_thrown_[static_cast<std::size_t>(group)] ? group : -1;
    };
    const auto add = [&](std::int32_t a, std::int32_t b, const auto& work) {
        const std::int32_t of_a = risen_at(a), of_b = risen_at(b);
        if (of_a < 0 && of_b < 0) return;
        const double done = work();
        if (of_a >= 0) work_[static_cast<std::size_t>(of_a)] += done;
        if (of_b >= 0 && of_b != of_a) work_[static_cast<std::size_t>(of_b)] += done;
    };
    const ContactRows<Real>& pairs = contacts.graph.pairs;
    for (const std::size_t i : joined.pairs)
        add(pairs.a[i], pairs.b[i], [&] {
            return StoredContact<Real>(pairs, i).work(velocities.mean(pairs.a[i]),
                                                      velocities.mean(pairs.b[i]));
        });
    const ContactRows<Real>& supports = contacts.supports;
    for (const std::size_t i : joined.supports)
        add(supports.a[i], -1, [&] {
            return StoredContact<Real>(supports, i)
                .work(velocities.mean(supports.a[i]), surface_at(supports, i));
        });
    const auto mean = [&](std::int32_t row) {
        const DoubleBody body = velocities.mean(row);
        return MeanVelocity{{body.record[0], body.record[1]}, body.record[2]};
    };
    joined.for_each_path(paths, [&](const PathContact<Real>& contact, std::size_t) {
        add(contact.near, contact.far,
            [&] { return ContactWork<Real>(contact).work(mean(contact.near), mean(contact.far)); });
    });
    bool any = false;
    for (std::size_t group = 0; group < is_thrown_.size(); ++group) {
        is_thrown_[group] = is_thrown_[group] && work_[group] > least_[group];
        any = any || is_thrown_[group];
    }
    if (!any) return false;
    is_of_thrown_.assign(step.records.rows(), 0);
    for (std::size_t group = 0; group < is_thrown_.size(); ++group)
        for (std::size_t i = first_[group]; is_thrown_[group] && i < first_[group + 1]; ++i)
            is_of_thrown_[static_cast<std::size_t>(members_[i])] = 1;
    return true;
}

template <class Real>
void ForeseenBlows<Real>::take_back(const StepView<Real>& contacts, PathSolver<Real>& paths) const {
    Column<Real>& velocity = contacts.records.velocity;
    const auto is_of = [&](std::int32_t row) { return is_of_thrown_[static_cast<std::size_t>(row)] != 0; };
    const auto store = [&](std::int32_t row, const DoubleBody& body) {
        for (std::size_t k = 0; k < 3; ++k)
            velocity[4 * static_cast<std::size_t>(row) + k] = static_cast<Real>(body.record[k]);
    };
    const auto take = [&](ContactRows<Real>& rows, std::size_t i, auto other) {
        DoubleBody a = body_at(velocity, rows.a[i]);
        StoredContact<Real>(rows, i).take_from(a, other);
        store(rows.a[i], a), scale_impulses(rows, i, 0);
        return other;
    };
    ContactRows<Real>& pairs = contacts.graph.pairs;
    pairs.for_each([&](std::size_t i) {
        if (!pairs.is_live[i / kContactBlock] || !(is_of(pairs.a[i]) || is_of(pairs.b[i]))) return;
        store(pairs.b[i], take(pairs, i, body_at(velocity, pairs.b[i])));
    });
    ContactRows<Real>& supports = contacts.supports;
    supports.for_each([&](std::size_t i) {
        if (is_of(supports.a[i])) take(supports, i, surface_at(supports, i));
    });
    paths.take_back(is_of_thrown_, contacts.records);
}

template <class Real>
std::size_t ForeseenBlows<Real>::bytes() const {
    return first_.capacity() * sizeof(std::size_t) +
           (members_.capacity() + group_of_.capacity()) * sizeof(std::int32_t) +
           (least_.capacity() + work_.capacity()) * sizeof(double) + is_thrown_.capacity() +
           is_of_thrown_.capacity();
}

template class ForeseenBlows<float>;
template class ForeseenBlows<double>;

}  // namespace carom
