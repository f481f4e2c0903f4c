#include "solvers/shared/local_solve.hpp"

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
constexpr double kAccuracy = 1e-3;
/// Contacts solved in a substep at most, 20 ns each.
constexpr std::size_t kMostSolves = 8192;

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
std::int32_t LocalSolve<Real>::body_of(std::int32_t row) {
    std::int32_t& number = number_of_[static_cast<std::size_t>(row)];
    if (number < 0) {
        number = static_cast<std::int32_t>(bodies_.size());
        bodies_.push_back({row, 0, 0, 0, 0, 0});
    }
    return number;
}

template <class Real>
void LocalSolve<Real>::begin_step(const ContactRows<Real>& pairs, const ContactRows<Real>& supports) {
    bodies_.clear(), contacts_.clear();
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
    for (const BodyState& body : bodies_) number_of_[static_cast<std::size_t>(body.row)] = -1;
}

template <class Real>
void LocalSolve<Real>::load(const SolveContacts<Real>& of_pairs, const SolveContacts<Real>& of_supports) {
    for (BodyState& body : bodies_) {
        const Real* record = of_pairs.velocity + 4 * static_cast<std::size_t>(body.row);
        body.vx = record[0], body.vy = record[1], body.rim = record[2];
        body.inverse_mass = std::fabs(record[3]);
        body.inverse_inertia = 2 * std::fmax(static_cast<double>(record[3]), 0);
    }
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        Contact& c = contacts_[i];
        const bool is_pair = i < pair_count_;
        const SolveContacts<Real>& k = is_pair ? of_pairs : of_supports;
        const ContactColumns<Real>& columns = k.contacts;
        const std::size_t at = c.contact;
        const bool is_rough = columns.friction_impulse != nullptr;
        const BodyState& a = bodies_[static_cast<std::size_t>(c.a)];
        double inverse = a.inverse_mass, turning = a.inverse_inertia;
        if (is_pair) {
            const BodyState& b = bodies_[static_cast<std::size_t>(c.b)];
            inverse += b.inverse_mass, turning += b.inverse_inertia;
        }
        c.nx = columns.normal_x[at], c.ny = columns.normal_y[at];
        c.mass = 1 / inverse, c.tangent_mass = is_rough ? 1 / (inverse + turning) : 0;
        c.friction = !is_rough          ? 0
                     : columns.friction ? static_cast<double>(columns.friction[at])
                                        : static_cast<double>(k.uniform_friction);
        c.floor = columns.floor[at];
        c.surface_normal = is_pair ? 0 : static_cast<double>(columns.surface_normal[at]);
        c.surface_tangent = is_pair ? 0 : static_cast<double>(columns.surface_tangent[at]);
        c.normal = columns.normal_impulse[at];
        c.tangent = is_rough ? static_cast<double>(columns.friction_impulse[at]) : 0;
        c.normal_step = c.tangent_step = 0;
    }
}

template <class Real>
void LocalSolve<Real>::store(const SolveContacts<Real>& of_pairs,
                             const SolveContacts<Real>& of_supports) const {
    for (const BodyState& body : bodies_) {
        Real* record = of_pairs.velocity + 4 * static_cast<std::size_t>(body.row);
        record[0] = static_cast<Real>(body.vx), record[1] = static_cast<Real>(body.vy);
        record[2] = static_cast<Real>(body.rim);
    }
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Contact& c = contacts_[i];
        const ContactColumns<Real>& columns = (i < pair_count_ ? of_pairs : of_supports).contacts;
        const auto normal = static_cast<Real>(c.normal);
        columns.normal_impulse[c.contact] = normal;
        if (columns.friction_impulse) columns.friction_impulse[c.contact] = static_cast<Real>(c.tangent);
        if (columns.largest_impulse)
            columns.largest_impulse[c.contact] = std::max(columns.largest_impulse[c.contact], normal);
    }
}

template <class Real>
void LocalSolve<Real>::apply(const Contact& c, double normal, double tangent) {
    const double x = normal * c.nx - tangent * c.ny, y = normal * c.ny + tangent * c.nx;
    BodyState& a = bodies_[static_cast<std::size_t>(c.a)];
    a.vx -= a.inverse_mass * x, a.vy -= a.inverse_mass * y, a.rim -= a.inverse_inertia * tangent;
    if (c.b < 0) return;
    BodyState& b = bodies_[static_cast<std::size_t>(c.b)];
    b.vx += b.inverse_mass * x, b.vy += b.inverse_mass * y, b.rim -= b.inverse_inertia * tangent;
}

/// @return m/s, the largest change.
template <class Real>
double LocalSolve<Real>::sweep() {
    double largest = 0;
    for (Contact& c : contacts_) {
        const BodyState& a = bodies_[static_cast<std::size_t>(c.a)];
        double normal_velocity = c.surface_normal - (a.vx * c.nx + a.vy * c.ny);
        double tangent_velocity = c.surface_tangent - (a.vy * c.nx - a.vx * c.ny) - a.rim;
        if (c.b >= 0) {
            const BodyState& b = bodies_[static_cast<std::size_t>(c.b)];
            normal_velocity += b.vx * c.nx + b.vy * c.ny;
            tangent_velocity += b.vy * c.nx - b.vx * c.ny - b.rim;
        }
        const double normal = std::fmax(c.normal + c.mass * (c.floor - normal_velocity), 0);
        const double limit = c.friction * normal;
        const double tangent =
            std::fmax(-limit, std::fmin(limit, c.tangent - c.tangent_mass * tangent_velocity));
        const double added = normal - c.normal, added_along = tangent - c.tangent;
        c.normal = normal, c.tangent = tangent;
        apply(c, added, added_along);
        largest = std::fmax(largest, std::fmax(std::fabs(added), std::fabs(added_along)) / c.mass);
    }
    return largest;
}

/// How much the last sweep changed: energy in units of kg m²/s².
template <class Real>
double LocalSolve<Real>::change() const {
    double sum = 0;
    for (const Contact& c : contacts_) {
        const double normal = c.normal - c.normal_before, tangent = c.tangent - c.tangent_before;
        sum += (normal * normal + tangent * tangent) / c.mass;
    }
    return sum;
}

/// Goes on in the direction of the sweeps so far. @param share  of the step before, 0 ... 1
template <class Real>
void LocalSolve<Real>::conjugate_step(double share) {
    for (Contact& c : contacts_) {
        const double normal = c.normal - c.normal_before, tangent = c.tangent - c.tangent_before;
        const double added = share * c.normal_step, added_along = share * c.tangent_step;
        c.normal += added, c.tangent += added_along;
        if (added != 0 || added_along != 0) apply(c, added, added_along);
        c.normal_step = added + normal, c.tangent_step = added_along + tangent;
    }
}

template <class Real>
void LocalSolve<Real>::solve(const SolveContacts<Real>& of_pairs, const SolveContacts<Real>& of_supports,
                             double fall) {
    if (contacts_.empty()) return;
    load(of_pairs, of_supports);
    const std::size_t most = std::max<std::size_t>(kMostSolves / contacts_.size(), 1);
    double first = 0, before = 0;
    for (std::size_t sweeps = 1;; ++sweeps) {
        for (Contact& c : contacts_) c.normal_before = c.normal, c.tangent_before = c.tangent;
        if (sweep() <= kAccuracy * fall) break;
        // The change by a sweep is the gradient of what is to become least.
        const double now = change();
        if (sweeps == 1) first = now, first_bodies_ = bodies_, first_contacts_ = contacts_;
        if (sweeps >= most) {
            if (now > first) bodies_ = first_bodies_, contacts_ = first_contacts_;  // worse than one sweep
            break;
        }
        const double share = before > 0 ? now / before : 0;
        if (share <= 1) {
            conjugate_step(share);
        } else {
            for (Contact& c : contacts_) c.normal_step = c.tangent_step = 0;
        }
        before = now;
    }
    store(of_pairs, of_supports);
}

template <class Real>
std::size_t LocalSolve<Real>::bytes() const {
    return pairs_.capacity() * sizeof(std::uint32_t) + is_near_.capacity() +
           number_of_.capacity() * sizeof(std::int32_t) +
           (bodies_.capacity() + first_bodies_.capacity()) * sizeof(BodyState) +
           (contacts_.capacity() + first_contacts_.capacity()) * sizeof(Contact);
}

template class LocalSolve<float>;
template class LocalSolve<double>;

}  // namespace carom
