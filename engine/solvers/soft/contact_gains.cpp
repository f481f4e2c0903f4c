#include "solvers/soft/contact_gains.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "solvers/soft/contacts/stored_contact.hpp"
#include "solvers/soft/substep_drives.hpp"

namespace carom {
namespace {

/// Work that contacts of discs may do in a substep, as they are never solved to the end: this share of the
/// energy that gravity gives a body at rest in it.
constexpr double kLeastOfFall = 1e-4;
/// Times that by which work is left where velocities and impulses are rounded to the world's precision.
[[maybe_unused]] constexpr double kRoundOffOfWork = 4;
/// Share that is taken at once, while there are smaller impulses from which some could be taken, too.
constexpr double kMostTaken = 0.5;
/// Impulses count as largest above a speed that is this share of the largest one's, then of that speed, and
/// so on; behind as many speeds as kMostSpeeds all of them do.
constexpr float kNextSpeed = 0.5;
constexpr std::size_t kMostSpeeds = 16;

template <class Real>
std::array<Column<Real>*, 3> impulses_of(ContactRows<Real>& rows) {
    return {&rows.normal_impulse, &rows.friction_impulse, &rows.rolling_impulse};
}

}  // namespace

template <class Real>
auto ContactGains<Real>::measure(const SolvedSubstep<Real>& solved) -> Work {
    const SubstepTerms& terms = solved.contacts.terms;
    const auto [work, energy] = solved.contacts.records.gain(terms, solved.contacts.loops, GainOf::work);
    const double fall = terms.fall_speed();
    return {work, static_cast<double>(std::numeric_limits<Real>::epsilon()) * energy +
                      kLeastOfFall * (0.5 * solved.step.world.dynamic_mass * fall * fall)};
}

/// Lists the contacts that push. @return  J, the work that all did on the bodies, by mean velocities: without
/// what surfaces do by their own motion
template <class Real>
double ContactGains<Real>::find_givers(const SolvedSubstep<Real>& solved) {
    const BodyRecords<Real>& records = solved.contacts.records;
    const ContactRows<Real>&pairs = solved.contacts.graph.pairs, &supports = solved.contacts.supports;
    const auto mean_of = [&](std::int32_t row) {
        DoubleBody body = body_at(records.velocity, row);
        if (!moves(records, row)) return body;
        const Velocity start = records.start_of_substep(row);
        for (std::size_t k = 0; k < 3; ++k) body.record[k] = 0.5 * (body.record[k] + start[k]);
        return body;
    };
    const auto surface_of = [&](std::int32_t row) {
        return moves(records, row) ? DoubleBody{} : body_at(records.velocity, row);
    };
    givers_.clear();
    // Room that no later step of the same world outgrows, unless it gets more pairs than ever.
    givers_.reserve(std::bit_ceil(pairs.a.size() + supports.a.size()));
    double sum = 0;
    const auto note = [&](std::size_t place, const ContactRows<Real>& rows, std::size_t i, double work,
                          double of_surface) {
        sum += work;
        givers_.push_back({of_surface, static_cast<float>(rows.normal_impulse[i] / rows.mass[i]),
                           static_cast<std::uint32_t>(place)});
    };
    pairs.for_each([&](std::size_t i) {
        if (!pairs.is_live[i / kContactBlock] || !(pairs.normal_impulse[i] > 0)) return;
        const std::int32_t a = pairs.a[i], b = pairs.b[i];
        const StoredContact<Real> contact(pairs, i);
        const bool both_move = moves(records, a) && moves(records, b);
        note(i, pairs, i, contact.work(mean_of(a), mean_of(b)),
             both_move ? 0 : contact.work(surface_of(a), surface_of(b)));
    });
    supports.for_each([&](std::size_t i) {
        if (!(supports.normal_impulse[i] > 0)) return;
        const StoredContact<Real> contact(supports, i);
        const DoubleSurface surface = surface_at(supports, i);
        note(pairs.a.size() + i, supports, i, contact.work(mean_of(supports.a[i]), surface),
             contact.work(DoubleBody{}, surface));
    });
    return sum;
}

/// Room for what a gain needs, 60 bytes a row: most worlds never gain, and have none.
template <class Real>
void ContactGains<Real>::begin(std::size_t rows) {
    for (const std::int32_t row : rows_) is_changed_[static_cast<std::size_t>(row)] = 0;
    rows_.clear(), scaled_.clear(), ends_.clear(), shares_.clear(), of_surfaces_ = 0;
    scaled_.reserve(givers_.capacity()), ends_.reserve(kMostSpeeds), shares_.reserve(kMostSpeeds);
    if (rows <= is_changed_.size()) return;
    const std::size_t room = rows + rows / 4;  // rows of what nothing moves come and go with contacts
    given_.resize(room), taken_.resize(room), is_changed_.resize(room), rows_.reserve(room);
}

/// Adds a contact to those that are scaled.
template <class Real>
void ContactGains<Real>::add(const SolvedSubstep<Real>& solved, const Giver& giver) {
    const BodyRecords<Real>& records = solved.contacts.records;
    ContactRows<Real>&pairs = solved.contacts.graph.pairs, &supports = solved.contacts.supports;
    const auto note = [&](std::int32_t row, const DoubleBody& now, const DoubleBody& without) {
        if (!moves(records, row)) return;
        const auto r = static_cast<std::size_t>(row);
        if (!is_changed_[r]) is_changed_[r] = 1, rows_.push_back(row), given_[r] = taken_[r] = {};
        for (std::size_t k = 0; k < 3; ++k) given_[r][k] += now.record[k] - without.record[k];
    };
    const bool is_pair = giver.place < pairs.a.size();
    ContactRows<Real>& rows = is_pair ? pairs : supports;
    const std::size_t i = is_pair ? giver.place : giver.place - pairs.a.size();
    const DoubleBody of_a = body_at(records.velocity, rows.a[i]);
    DoubleBody a = of_a;
    const StoredContact<Real> contact(rows, i);
    if (is_pair) {
        const DoubleBody of_b = body_at(records.velocity, pairs.b[i]);
        DoubleBody b = of_b;
        contact.take_from(a, b);
        note(pairs.b[i], of_b, b);
    } else {
        DoubleSurface surface = surface_at(supports, i);
        contact.take_from(a, surface);
    }
    note(rows.a[i], of_a, a);
    of_surfaces_ += giver.of_surface;
    Scaled scaled{giver.place, {}};
    const auto columns = impulses_of(rows);
    for (std::size_t k = 0; k < columns.size(); ++k)
        if (!columns[k]->empty()) scaled.impulses[k] = (*columns[k])[i];
    scaled_.push_back(scaled);
}

/// With the share u taken from the impulses that are scaled all contacts do the work W(u) = W - u along + u²
/// square: along = w + ½ g · M d, square = ½ d · M d, where w is the work that these did, d what they gave to
/// velocities, and g what all gave.
template <class Real>
auto ContactGains<Real>::sums_of(const SolvedSubstep<Real>& solved) const -> Sums {
    const BodyRecords<Real>& records = solved.contacts.records;
    Sums sums{of_surfaces_, 0};
    for (const std::int32_t row : rows_) {
        const auto r = static_cast<std::size_t>(row);
        const Velocity now = velocity_at(records.velocity, r) - taken_[r],
                       free = records.free_flight(row, solved.contacts.terms),
                       start = records.start_of_substep(row), &given = given_[r];
        // Half of (start + now) + (now - free).
        const Velocity twice_mean{start[0] - free[0] + 2 * now[0], start[1] - free[1] + 2 * now[1],
                                  start[2] - free[2] + 2 * now[2]};
        const double half = 0.5 * static_cast<double>(solved.step.world.bodies.mass[r]);
        sums.along += half * product(twice_mean, given), sums.square += half * product(given, given);
    }
    return sums;
}

/// Velocities and impulses without what was taken.
template <class Real>
void ContactGains<Real>::scale(const SolvedSubstep<Real>& solved) {
    BodyRecords<Real>& records = solved.contacts.records;
    for (const std::int32_t row : rows_) {
        const auto r = static_cast<std::size_t>(row);
        for (std::size_t k = 0; k < 3; ++k) {
            Real& now = records.velocity[4 * r + k];
            now = static_cast<Real>(static_cast<double>(now) - taken_[r][k]);
        }
    }
    ContactRows<Real>&pairs = solved.contacts.graph.pairs, &supports = solved.contacts.supports;
    double left = 1;
    for (std::size_t speed = ends_.size(); speed-- > 0;) {
        left *= shares_[speed];
        for (std::size_t n = speed > 0 ? ends_[speed - 1] : 0; n < ends_[speed]; ++n) {
            const std::size_t place = scaled_[n].place;
            if (place < pairs.a.size())
                scale_impulses(pairs, place, left);
            else
                scale_impulses(supports, place - pairs.a.size(), left);
        }
    }
}

template <class Real>
void ContactGains<Real>::take(const SolvedSubstep<Real>& solved) {
    const BodyRecords<Real>& records = solved.contacts.records;
    const Work all = measure(solved);
    if (!all.is_more()) return;
    double work = find_givers(solved);
    if (!(work > all.least)) return;
    begin(records.rows());
    float above = std::numeric_limits<float>::infinity(), from = 0;  // m/s
    for (const Giver& giver : givers_) from = std::max(from, kNextSpeed * giver.speed);
    while (above > 0 && work > 0) {
        for (const Giver& giver : givers_)
            if (giver.speed >= from && giver.speed < above) add(solved, giver);
        const auto [along, square] = sums_of(solved);
        const double root = along * along - 4 * square * work;
        double share = 0;  // at which no work is left, or at least the least
        if (along > 0) share = root >= 0 ? 2 * work / (along + std::sqrt(root)) : along / (2 * square);
        share = std::min(share, from > 0 ? kMostTaken : 1);
        work -= share * (along - share * square);
        for (const std::int32_t row : rows_) {
            const auto r = static_cast<std::size_t>(row);
            for (std::size_t k = 0; k < 3; ++k)
                taken_[r][k] += share * given_[r][k], given_[r][k] *= 1 - share;
        }
        of_surfaces_ *= 1 - share;
        ends_.push_back(scaled_.size()), shares_.push_back(1 - share);
        if (root >= 0 && along > 0 && share < kMostTaken) break;
        above = from, from = ends_.size() + 1 < kMostSpeeds ? kNextSpeed * from : 0;
    }
    scale(solved);
    has_taken_ = true;
    assert(!(find_givers(solved) > kRoundOffOfWork * all.least) &&
           "contacts of discs that bounce give no energy");
}

template <class Real>
void ContactGains<Real>::give_back(const StepView<Real>& contacts) {
    has_taken_ = false;
    const SubstepTerms& terms = contacts.terms;
    const StartColumns<Real> start = contacts.records.start_columns();
    for (const std::int32_t row : rows_) {
        const auto r = static_cast<std::size_t>(row);
        start.x[r] -= static_cast<Real>(taken_[r][0] / terms.decay);
        start.y[r] -= static_cast<Real>(taken_[r][1] / terms.decay);
        if (start.rim) start.rim[r] -= static_cast<Real>(taken_[r][2] / terms.spin_decay);
    }
    const auto pairs = impulses_of(contacts.graph.pairs), supports = impulses_of(contacts.supports);
    const std::size_t first_support = contacts.graph.pairs.a.size();
    for (const auto& [place, impulses] : scaled_)
        for (std::size_t k = 0; k < impulses.size(); ++k) {
            Column<Real>& column = *(place < first_support ? pairs[k] : supports[k]);
            if (!column.empty()) column[place < first_support ? place : place - first_support] = impulses[k];
        }
}

template <class Real>
std::size_t ContactGains<Real>::bytes() const {
    return givers_.capacity() * sizeof(Giver) + scaled_.capacity() * sizeof(Scaled) +
           ends_.capacity() * sizeof(std::size_t) + shares_.capacity() * sizeof(double) +
           (given_.capacity() + taken_.capacity()) * sizeof(Velocity) + is_changed_.capacity() +
           rows_.capacity() * sizeof(std::int32_t);
}

template class ContactGains<float>;
template class ContactGains<double>;

}  // namespace carom
