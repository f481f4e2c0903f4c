#include "solvers/contact_sets/local_solve.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

/// The contacts of a squeezed body are solved with it, then those of the bodies they touch, ring by ring,
/// while there are fewer contacts than this.
constexpr std::size_t kFewContacts = 128;
/// Rings at most.
constexpr int kMostRings = 64;
/// The system is solved when no contact's velocity changes by more than this share of what gravity adds to a
/// velocity in a substep.
constexpr double kAccuracyOfContact = 1e-3;
/// Contacts solved in a substep at most, 20 ns each.
constexpr std::size_t kMostSolves = 8192;

constexpr unsigned kDoesNotRoll = kEveryEffect & ~kRolling;
using Impulses = ContactImpulses<double>;

Impulses operator+(const Impulses& a, const Impulses& b) {
    return {a.normal + b.normal, a.tangent + b.tangent, a.rolling + b.rolling};
}
Impulses operator-(const Impulses& a, const Impulses& b) {
    return {a.normal - b.normal, a.tangent - b.tangent, a.rolling - b.rolling};
}
Impulses operator*(double share, const Impulses& a) {
    return {share * a.normal, share * a.tangent, share * a.rolling};
}
double largest_of(const Impulses& a) {
    return std::fmax(std::fmax(std::fabs(a.normal), std::fabs(a.tangent)), std::fabs(a.rolling));
}
double squares_of(const Impulses& a) {
    return a.normal * a.normal + a.tangent * a.tangent + a.rolling * a.rolling;
}

}  // namespace

template <class Real>
void LocalSolve<Real>::find(const ContactRows<Real>& pairs, const Column<Real>& inverse_mass,
                            std::size_t rows) {
    pairs_.clear();
    const auto inverse = [&](std::int32_t row) {
        return static_cast<double>(std::fabs(inverse_mass[static_cast<std::size_t>(row)]));
    };
    bool any = false;
    const auto mark = [&](std::int32_t row) {
        if (!any) is_near_.assign(rows, 0);
        any = true;
        is_near_[static_cast<std::size_t>(row)] = 1;
    };
    pairs.for_each([&](std::size_t i) {
        const double of_a = inverse(pairs.a[i]), of_b = inverse(pairs.b[i]);
        if (of_a > kUneven * of_b) mark(pairs.a[i]);
        if (of_b > kUneven * of_a) mark(pairs.b[i]);
    });
    if (!any) return;
    number_of_.assign(rows, -1);
    std::size_t before = 0;
    for (std::uint8_t ring = 1; ring < kMostRings; ++ring) {
        pairs_.clear();
        pairs.for_each([&](std::size_t i) {
            std::uint8_t &a = is_near_[static_cast<std::size_t>(pairs.a[i])],
                         &b = is_near_[static_cast<std::size_t>(pairs.b[i])];
            const bool reaches_a = b > 0 && b <= ring, reaches_b = a > 0 && a <= ring;
            if (!reaches_a && !reaches_b) return;
            pairs_.push_back(static_cast<std::uint32_t>(i));
            // A body much heavier than the one it touches stands still for that one.
            const double of_a = inverse(pairs.a[i]), of_b = inverse(pairs.b[i]);
            if (a == 0 && kUneven * of_a >= of_b) a = static_cast<std::uint8_t>(ring + 1);
            if (b == 0 && kUneven * of_b >= of_a) b = static_cast<std::uint8_t>(ring + 1);
        });
        if (ring > 1 && (pairs_.size() == before || pairs_.size() > kFewContacts)) return;
        before = pairs_.size();
    }
}

template <class Real>
bool LocalSolve<Real>::has_many() const {
    return pairs_.size() > kFewContacts;
}

template <class Real>
std::int32_t LocalSolve<Real>::body_of(std::int32_t row) {
    std::int32_t& number = number_of_[static_cast<std::size_t>(row)];
    if (number < 0) {
        number = static_cast<std::int32_t>(rows_.size());
        rows_.push_back(row);
    }
    return number;
}

template <class Real>
void LocalSolve<Real>::begin_step(const ContactRows<Real>& pairs, const ContactRows<Real>& supports) {
    leave_step();
    if (pairs_.empty()) return;
    for (const std::uint32_t i : pairs_) {
        if (!pairs.is_live[i / kContactBlock]) continue;
        Contact contact{};
        contact.a = body_of(pairs.a[i]), contact.b = body_of(pairs.b[i]), contact.contact = i;
        contacts_.push_back(contact);
    }
    pair_count_ = contacts_.size();
    if (pair_count_ > 0)
        supports.for_each([&](std::size_t i) {
            const std::int32_t row = supports.a[i];
            if (number_of_[static_cast<std::size_t>(row)] < 0) return;
            Contact contact{};
            contact.a = body_of(row), contact.b = -1, contact.contact = static_cast<std::uint32_t>(i);
            contacts_.push_back(contact);
        });
    for (const std::int32_t row : rows_) number_of_[static_cast<std::size_t>(row)] = -1;
    smooth_.begin_step(), rough_.begin_step();
}

template <class Real>
void LocalSolve<Real>::load(const SolveContacts<Real>& of_pairs, const SolveContacts<Real>& of_supports) {
    records_.resize(4 * rows_.size());
    for (std::size_t body = 0; body < rows_.size(); ++body)
        std::copy_n(of_pairs.velocity + 4 * static_cast<std::size_t>(rows_[body]), 4, &records_[4 * body]);
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        Contact& c = contacts_[i];
        const SolveContacts<Real>& k = i < pair_count_ ? of_pairs : of_supports;
        c.read(k);
        with_sides(records_.data(), c, [&](const auto& a, const auto& b) {
            c.terms.mass = 1 / inverse_mass(a, b);
            c.terms.tangent_mass = tangent_mass<kEveryEffect>(a, b, c.terms.mass);
        });
    }
}

template <class Real>
void LocalSolve<Real>::store(const SolveContacts<Real>& of_pairs,
                             const SolveContacts<Real>& of_supports) const {
    for (std::size_t body = 0; body < rows_.size(); ++body)
        for (std::size_t k = 0; k < 3; ++k)
            of_pairs.velocity[4 * static_cast<std::size_t>(rows_[body]) + k] =
                static_cast<Real>(records_[4 * body + k]);
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Contact& c = contacts_[i];
        const ContactColumns<Real>& columns = (i < pair_count_ ? of_pairs : of_supports).contacts;
        const auto normal = static_cast<Real>(c.impulses.normal);
        columns.normal_impulse[c.contact] = normal;
        if (columns.friction_impulse)
            columns.friction_impulse[c.contact] = static_cast<Real>(c.impulses.tangent);
        if (columns.rolling_impulse)
            columns.rolling_impulse[c.contact] = static_cast<Real>(c.impulses.rolling);
    }
}

/// @return m/s, the largest change.
template <class Real>
template <unsigned kVariant>
double LocalSolve<Real>::sweep() {
    double largest = 0;
    for (const std::uint32_t i : swept_) {
        Contact& c = contacts_[i];
        Impulses added{};
        with_sides(records_.data(), c, [&](auto& a, auto& b) {
            added = solve_contact<kVariant>(a, b, c.terms, c.impulses, [](double wanted) { return wanted; });
        });
        largest = std::fmax(largest, largest_of(added) / c.terms.mass);
    }
    return largest;
}

/// How much the last sweep changed: energy in units of kg m²/s².
template <class Real>
double LocalSolve<Real>::change() const {
    double sum = 0;
    for (const std::uint32_t i : swept_) {
        const Contact& c = contacts_[i];
        sum += squares_of(c.impulses - c.before) / c.terms.mass;
    }
    return sum;
}

/// Goes on in the direction of the sweeps so far. @param share  of the step before, 0 ... 1
template <class Real>
void LocalSolve<Real>::conjugate_step(double share) {
    for (const std::uint32_t i : swept_) {
        Contact& c = contacts_[i];
        const Impulses by_sweep = c.impulses - c.before, added = share * c.step;
        c.impulses = c.impulses + added;
        if (largest_of(added) > 0)
            with_sides(records_.data(), c, [&](auto& a, auto& b) {
                apply_impulses<kEveryEffect>(a, b, c.terms.nx, c.terms.ny, c.terms.of_a, added);
            });
        c.step = added + by_sweep;
    }
}

template <class Real>
template <int kSize>
std::size_t LocalSolve<Real>::relax(LightGroups<kSize>& groups, double fall) {
    groups.solve(contacts_, records_, kUneven, fall);
    swept_.assign(groups.left().begin(), groups.left().end());
    return groups.unsolved();
}

template <class Real>
std::size_t LocalSolve<Real>::begin(const SolveContacts<Real>& of_pairs,
                                    const SolveContacts<Real>& of_supports, double fall) {
    if (contacts_.empty()) return 0;
    load(of_pairs, of_supports);
    return of_pairs.contacts.friction_impulse ? relax(rough_, fall) : relax(smooth_, fall);
}

template <class Real>
double LocalSolve<Real>::solve(const SolveContacts<Real>& of_pairs, const SolveContacts<Real>& of_supports,
                               double fall) {
    if (contacts_.empty()) return 0;
    if (swept_.empty()) {
        store(of_pairs, of_supports);
        return 0;
    }
    const bool rolls = of_pairs.contacts.rolling_impulse != nullptr;
    const std::size_t most = std::max<std::size_t>(kMostSolves / contacts_.size(), 1);
    double first = 0, before = 0, left = 0;
    for (std::size_t sweeps = 1;; ++sweeps) {
        for (const std::uint32_t i : swept_) contacts_[i].before = contacts_[i].impulses;
        left = rolls ? sweep<kEveryEffect>() : sweep<kDoesNotRoll>();
        if (left <= kAccuracyOfContact * fall) break;
        // The change by a sweep is the gradient of what is to become least.
        const double now = change();
        if (sweeps == 1) first = now, first_records_ = records_, first_contacts_ = contacts_;
        if (sweeps >= most) {
            if (now > first) records_ = first_records_, contacts_ = first_contacts_;  // worse than one sweep
            break;
        }
        const double share = before > 0 ? now / before : 0;
        if (share <= 1) {
            conjugate_step(share);
        } else {
            for (const std::uint32_t i : swept_) contacts_[i].step = {};
        }
        before = now;
    }
    store(of_pairs, of_supports);
    return left;
}

template <class Real>
std::size_t LocalSolve<Real>::bytes() const {
    return pairs_.capacity() * sizeof(std::uint32_t) + is_near_.capacity() +
           (number_of_.capacity() + rows_.capacity()) * sizeof(std::int32_t) +
           (records_.capacity() + first_records_.capacity()) * sizeof(double) +
           (contacts_.capacity() + first_contacts_.capacity()) * sizeof(Contact) +
           swept_.capacity() * sizeof(std::uint32_t) + smooth_.bytes() + rough_.bytes();
}

template class LocalSolve<float>;
template class LocalSolve<double>;

}  // namespace carom
