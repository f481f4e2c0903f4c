#include "solvers/soft/corrections/contact_chains.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "effects/contact_law.hpp"
#include "state/columns/index.hpp"

namespace carom {
namespace {

/// Contacts of a chain, at least: the sweeps settle shorter ones.
constexpr std::size_t kFewestContacts = 9;
/// Cosine of the turn of a chain at a body, at least.
constexpr double kLeastFacing = 0.95;
/// Contacts of all chains, at most: more are those of a lattice that falls, whose columns soon break up. In
/// worlds where they are less than nine tenths of all pairs of discs that can touch, the sweeps have the rest
/// anyhow.
constexpr std::size_t kMostContacts = 512;
/// More columns than this are such a lattice as well.
constexpr std::size_t kMostChains = 8;
/// Steps after which chains are listed anew.
constexpr int kStepsOfList = 16;
/// Likewise at least, where the pairs are found anew and there were chains.
constexpr int kFewestSteps = 4;
/// By which a contact may miss its law, in shares of what gravity adds to a speed in a substep.
constexpr double kTolerance = 2e-4;

}  // namespace

template <class Real>
void ContactChains<Real>::begin_step(const StepView<Real>& step) {
    if (step.records.count() < kFewestContacts || !(step.terms.fall_speed() > 0)) return chains_.clear();
    ++age_;
    const bool are_void = version_ != step.graph.version;
    if (version_ < 0 || age_ >= kStepsOfList || (are_void && !contacts_.empty() && age_ >= kFewestSteps))
        list(step);
    else if (are_void)
        chains_.clear();
    if (!chains_.empty()) find_feet(step);
}

/// Whether a chain that comes to a body by a pair leads on: it touches one more disc, straight ahead, and
/// nothing else.
template <class Real>
bool ContactChains<Real>::leads_on(const Rows& pairs, std::int32_t row, std::uint32_t pair) const {
    if (touches_[index(row)] != 2) return false;
    const auto& [first, second] = pairs_of_[index(row)];
    if (first != pair && second != pair) return false;
    const Real product =
        pairs.normal_x[first] * pairs.normal_x[second] + pairs.normal_y[first] * pairs.normal_y[second];
    const bool both_leave = (pairs.a[first] == row) == (pairs.a[second] == row);
    return (both_leave ? -product : product) > static_cast<Real>(kLeastFacing);
}

template <class Real>
void ContactChains<Real>::list(const StepView<Real>& step) {
    const Rows &pairs = step.graph.pairs, &supports = step.supports;
    version_ = step.graph.version, age_ = 0;
    chains_.clear(), contacts_.clear();
    const std::size_t live =
        std::accumulate(pairs.live_count.begin(), pairs.live_count.end(), std::size_t{0});
    if (10 * kMostContacts < 9 * live) return;  // in a pile chains cannot be nine tenths of it
    touches_.assign(step.records.count(), 0), pairs_of_.resize(step.records.count());
    const auto touch = [&](const Rows& rows, std::size_t i, const auto& fn) {
        const bool varies = step.settings.effects.radius_varies;
        const double smaller = varies ? static_cast<double>(rows.smaller[i]) : step.settings.radius;
        if (static_cast<double>(rows.separation[i]) < step.settings.contact_distance(smaller)) fn();
    };
    const auto count = [&](std::size_t i, std::int32_t row) {
        std::uint8_t& number = touches_[index(row)];
        if (number < 2) pairs_of_[index(row)][number] = static_cast<std::uint32_t>(i);
        number = std::min<std::uint8_t>(number + 1, 3);
    };
    pairs.for_each([&](std::size_t i) {
        if (pairs.is_live[i / kContactBlock])
            touch(pairs, i, [&] { count(i, pairs.a[i]), count(i, pairs.b[i]); });
    });
    if (std::count(touches_.begin(), touches_.end(), std::uint8_t{2}) <
        static_cast<std::ptrdiff_t>(kFewestContacts) - 1)
        return;
    supports.for_each([&](std::size_t i) {
        std::uint8_t& number = touches_[index(supports.a[i])];
        touch(supports, i, [&] { number = number < 2 ? number : std::uint8_t{3}; });
    });
    is_seen_.assign(pairs.a.size(), 0);
    pairs.for_each([&](std::size_t i) {
        const auto pair = static_cast<std::uint32_t>(i);
        if (is_seen_[i]) return;
        const bool leads_on_at_a = leads_on(pairs, pairs.a[i], pair);
        if (leads_on_at_a != leads_on(pairs, pairs.b[i], pair)) walk(pairs, pair, leads_on_at_a);
    });
    if (chains_.size() > kMostChains || contacts_.size() > kMostContacts || 10 * contacts_.size() < 9 * live)
        chains_.clear(), contacts_.clear();
}

/// Follows a chain from its first contact.
template <class Real>
void ContactChains<Real>::walk(const Rows& pairs, std::uint32_t pair, bool is_reversed) {
    const std::size_t first = contacts_.size();
    for (;;) {
        is_seen_[pair] = 1;
        contacts_.push_back({pair, is_reversed ? 1U : 0U});
        const std::int32_t row = is_reversed ? pairs.a[pair] : pairs.b[pair];
        if (!leads_on(pairs, row, pair)) break;
        const auto& [first_pair, second_pair] = pairs_of_[index(row)];
        pair = first_pair == pair ? second_pair : first_pair;
        is_reversed = pairs.b[pair] == row;
    }
    const ChainContact begin = contacts_[first], end = contacts_.back();
    const bool is_ring = (begin.is_reversed ? pairs.b : pairs.a)[begin.pair] ==
                         (end.is_reversed ? pairs.a : pairs.b)[end.pair];
    if (is_ring || contacts_.size() - first < kFewestContacts) return contacts_.resize(first);
    chains_.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(contacts_.size())});
}

/// What chains stand on in this step. One between two supports stands on one of them: squeezed by both it
/// might have no solution.
template <class Real>
void ContactChains<Real>::find_feet(const StepView<Real>& step) {
    const Rows &pairs = step.graph.pairs, &supports = step.supports;
    foot_.assign(chains_.size(), -1);
    chain_of_end_.assign(step.records.count(), -1);
    const auto end_of = [&](const Chain& chain, bool is_last) {
        return contacts_[is_last ? chain.last - 1 : chain.first];
    };
    for (std::size_t chain = 0; chain < chains_.size(); ++chain)
        for (const bool is_last : {false, true}) {
            const ChainContact end = end_of(chains_[chain], is_last);
            const auto& rows = (end.is_reversed != 0) == is_last ? pairs.a : pairs.b;
            chain_of_end_[index(rows[end.pair])] = static_cast<std::int32_t>(2 * chain + (is_last ? 1 : 0));
        }
    supports.for_each([&](std::size_t i) {
        const std::int32_t side = chain_of_end_[index(supports.a[i])];
        if (side < 0 || foot_[index(side) / 2] >= 0) return;
        Chain& chain = chains_[index(side) / 2];
        const ChainContact end = end_of(chain, side % 2 == 1);
        const Real along =
            pairs.normal_x[end.pair] * supports.normal_x[i] + pairs.normal_y[end.pair] * supports.normal_y[i];
        if ((end.is_reversed != 0) == (side % 2 == 1) ? along > static_cast<Real>(-kLeastFacing)
                                                      : along < static_cast<Real>(kLeastFacing))
            return;
        foot_[index(side) / 2] = static_cast<std::int32_t>(i);
        if (side % 2 == 0) return;
        const auto begin = contacts_.begin();  // chains begin where they stand
        std::reverse(begin + chain.first, begin + chain.last);
        std::for_each(begin + chain.first, begin + chain.last,
                      [](ChainContact& contact) { contact.is_reversed ^= 1U; });
    });
}

/// Calls fn(rows, i, contact) for the contacts of a chain from its foot on: `rows` has contact i, and
/// `contact` tells how the chain goes through it; null: it is the foot.
template <class Real>
template <class Fn>
void ContactChains<Real>::for_each_contact(const StepView<Real>& step, std::size_t chain,
                                           const Fn& fn) const {
    if (foot_[chain] >= 0) fn(step.supports, index(foot_[chain]), nullptr);
    for (std::size_t n = chains_[chain].first; n < chains_[chain].last; ++n)
        fn(step.graph.pairs, index(static_cast<std::int32_t>(contacts_[n].pair)), &contacts_[n]);
}

/// Whether no contact of a chain misses its law by more than the tolerance [m/s].
template <class Real>
bool ContactChains<Real>::keeps_laws(const StepView<Real>& step, std::size_t chain, double tolerance) const {
    bool keeps = true;
    for_each_contact(step, chain, [&](const Rows& rows, std::size_t i, const ChainContact* contact) {
        const double nx = rows.normal_x[i], ny = rows.normal_y[i];
        const DoubleBody a = body_at(step.records.velocity, rows.a[i]);
        const double velocity = contact
                                    ? normal_velocity(a, body_at(step.records.velocity, rows.b[i]), nx, ny)
                                    : normal_velocity(a, DoubleSurface{rows.surface_normal[i], 0, 0}, nx, ny);
        const double off = velocity - static_cast<double>(rows.floor[i]);
        keeps &= !(off < -tolerance) && !(rows.normal_impulse[i] > 0 && off > tolerance);
    });
    return keeps;
}

/// Reads the contacts of a chain, with the velocities that bodies would have without their impulses.
template <class Real>
void ContactChains<Real>::read(const StepView<Real>& step, std::size_t chain) {
    links_.clear(), line_.contacts.clear();
    double inverse_mass_behind = 0;
    for_each_contact(step, chain, [&](const Rows& rows, std::size_t i, const ChainContact* contact) {
        const double nx = rows.normal_x[i], ny = rows.normal_y[i];
        const DoubleBody a = body_at(step.records.velocity, rows.a[i]);
        const bool is_reversed = !contact || contact->is_reversed;  // a foot pushes the first body
        Link link{-1, rows.a[i], is_reversed ? -nx : nx, is_reversed ? -ny : ny, rows.normal_impulse[i]};
        TridiagonalContact entry{0, rows.floor[i], 0, 0, 0};
        if (!line_.contacts.empty())
            line_.contacts.back().coupling =
                -inverse_mass_behind * (links_.back().nx * link.nx + links_.back().ny * link.ny);
        const auto meet = [&](const auto& b) {
            entry.velocity = normal_velocity(a, b, nx, ny), entry.diagonal = inverse_mass(a, b);
        };
        inverse_mass_behind = a.inverse_mass();
        if (contact) {
            const DoubleBody b = body_at(step.records.velocity, rows.b[i]);
            meet(b);
            link.before = rows.b[i];
            if (!is_reversed) std::swap(link.before, link.behind), inverse_mass_behind = b.inverse_mass();
        } else {
            meet(DoubleSurface{rows.surface_normal[i], 0, 0});
        }
        links_.push_back(link), line_.contacts.push_back(entry);
    });
    for (std::size_t n = 0; n < links_.size(); ++n) {
        TridiagonalContact& entry = line_.contacts[n];
        entry.velocity -= entry.diagonal * links_[n].impulse;
        if (n > 0) entry.velocity -= line_.contacts[n - 1].coupling * links_[n - 1].impulse;
        if (n + 1 < links_.size()) entry.velocity -= entry.coupling * links_[n + 1].impulse;
    }
}

/// Gives the bodies of a chain what its impulses have changed by, and keeps these.
template <class Real>
void ContactChains<Real>::store(const StepView<Real>& step, std::size_t chain) const {
    Column<Real>& records = step.records.velocity;
    const auto push = [&](std::int32_t row, const Link& link, double change, double sign) {
        if (row < 0) return;
        DoubleBody body = body_at(records, row);
        body.apply_impulse(change, 0, link.nx, link.ny, sign);
        for (std::size_t k = 0; k < 2; ++k) records[4 * index(row) + k] = static_cast<Real>(body.record[k]);
    };
    const std::size_t feet = foot_[chain] >= 0 ? 1 : 0;
    for (std::size_t n = 0; n < links_.size(); ++n) {
        const Link& link = links_[n];
        const double impulse = line_.contacts[n].impulse;
        push(link.before, link, impulse - link.impulse, -1),
            push(link.behind, link, impulse - link.impulse, 1);
        if (n < feet)
            step.supports.normal_impulse[index(foot_[chain])] = static_cast<Real>(impulse);
        else
            step.graph.pairs.normal_impulse[contacts_[chains_[chain].first + n - feet].pair] =
                static_cast<Real>(impulse);
    }
}

template <class Real>
void ContactChains<Real>::solve(const StepView<Real>& step) {
    const double tolerance = kTolerance * step.terms.fall_speed();
    for (std::size_t chain = 0; chain < chains_.size(); ++chain) {
        if (keeps_laws(step, chain, tolerance)) continue;
        read(step, chain);
        line_.solve();
        store(step, chain);
    }
}

template <class Real>
std::size_t ContactChains<Real>::bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return of(chains_) + of(contacts_) + of(touches_) + of(pairs_of_) + of(is_seen_) + of(chain_of_end_) +
           of(foot_) + of(links_) + line_.bytes();
}

template class ContactChains<float>;
template class ContactChains<double>;

}  // namespace carom
