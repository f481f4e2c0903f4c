#include "solvers/contact_sets/light_groups.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "effects/contact_law.hpp"
#include "math/vec2_math.hpp"
#include "state/columns/index.hpp"

namespace carom {
namespace {

// docs/decisions/0106-grains-between-balls.md has what other values do.

/// Light bodies of a group at most: columns carry heavy bodies, and are solved by sweeps.
constexpr std::int32_t kMostLight = 4;
/// A group is solved if none of its contacts is off by more than this share of what gravity adds to a
/// velocity in a substep. Sweeps often leave it so.
constexpr double kOff = 0.05;
/// What is off by more of it is struck or squeezed: as exactly as groups are solved here, grains would be
/// shot out of gaps that close, at hundreds of m/s where their surfaces are nearly parallel. Sweeps, which
/// end before, let them overlap.
constexpr double kQuiet = 2;
/// What stands on what does not move and carries more than so many times the weight of its lightest body may
/// be all that a heavy body lies on: it is solved to this share.
constexpr double kManyWeights = 30;
constexpr double kOffCarrying = 0.002;
/// A group is small: it is relaxed as exactly as that costs little, and gains no energy.
constexpr RelaxationEffort kEffort{.rounds = 8, .accuracy = 1e-3, .slack = 0};

using Impulses = ContactImpulses<double>;

}  // namespace

template <int kSize>
void LightGroups<kSize>::find(std::span<const LocalContact> contacts, std::span<const double> records,
                              double uneven) {
    const std::size_t bodies = records.size() / 4;
    const auto inverse = [&](std::int32_t body) { return std::fabs(records[4 * index(body) + 3]); };
    touching_.reset(bodies), light_.assign(bodies, 0), number_of_.assign(bodies, -1);
    for (const LocalContact& c : contacts)
        if (c.b >= 0 && inverse(c.a) <= uneven * inverse(c.b) && inverse(c.b) <= uneven * inverse(c.a))
            touching_.join(c.a, c.b);
    for (std::size_t body = 0; body < bodies; ++body)
        ++light_[index(touching_.island_of(static_cast<std::int32_t>(body)))];
    order_.resize(contacts.size()), group_of_.resize(contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const LocalContact& c = contacts[i];
        const std::int32_t lighter = c.b < 0 || inverse(c.a) >= inverse(c.b) ? c.a : c.b;
        order_[i] = static_cast<std::uint32_t>(i), group_of_[i] = touching_.island_of(lighter);
    }
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t i, std::uint32_t j) {
        return group_of_[i] != group_of_[j] ? group_of_[i] < group_of_[j] : i < j;
    });
    groups_.clear();
    for (std::uint32_t first = 0; first < order_.size();) {
        std::uint32_t last = first;
        bool has_pairs = false;
        const std::int32_t group = group_of_[order_[first]];
        for (; last < order_.size() && group_of_[order_[last]] == group; ++last)
            has_pairs |= contacts[order_[last]].b >= 0;
        const bool is_small = light_[index(group)] <= kMostLight;
        groups_.push_back({first, last, has_pairs, is_small});
        first = last;
    }
    are_known_ = true;
}

/// How far the contacts of the group are from their laws, each on its own [m/s].
template <int kSize>
double LightGroups<kSize>::off() const {
    return largest_residual(contacts_, [&](std::int32_t body) {
        return DoubleBody{DoubleLanes::load_rows4(records_.data(), &body)};
    });
}

/// Whether the group stands on what does not move and has impulses of many weights of its lightest body.
template <int kSize>
bool LightGroups<kSize>::carries(double fall) const {
    double lightest = 0, largest = 0;  // 1/kg, N s
    bool stands = false;
    for (const LocalContact& c : contacts_) {
        const double of_a = std::fabs(records_[4 * index(c.a) + 3]),
                     of_b = c.b < 0 ? 0 : std::fabs(records_[4 * index(c.b) + 3]);
        lightest = std::fmax(lightest, std::fmax(of_a, of_b));
        largest = std::fmax(largest, c.impulses.normal);
        stands |= !(of_a > 0) || !(of_b > 0);
    }
    return stands && largest * lightest > kManyWeights * fall;
}

/// Velocity of the heaviest body of the group [m/s].
template <int kSize>
Vec2 LightGroups<kSize>::velocity_of_heaviest() const {
    std::size_t heaviest = 0;
    for (std::size_t at = 0; at < records_.size(); at += 4)
        if (std::fabs(records_[at + 3]) < std::fabs(records_[heaviest + 3])) heaviest = at;
    return {records_[heaviest], records_[heaviest + 1]};
}

/// Speed of the fastest body of the group, seen from what moves so [m/s].
template <int kSize>
double LightGroups<kSize>::fastest(Vec2 from) const {
    double square = 0;
    for (std::size_t at = 0; at < records_.size(); at += 4)
        square = std::fmax(square, length_squared(Vec2{records_[at], records_[at + 1]} - from));
    return std::sqrt(square);
}

/// Gives the bodies of the group what its contacts carry, so often.
template <int kSize>
void LightGroups<kSize>::give_impulses(double times) {
    for (const LocalContact& c : contacts_) {
        const Impulses given{times * c.impulses.normal, times * c.impulses.tangent,
                             times * c.impulses.rolling};
        with_sides(records_.data(), c, [&](auto& a, auto& b) {
            apply_impulses<kEveryEffect>(a, b, c.terms.nx, c.terms.ny, c.terms.of_a, given);
        });
    }
}

/// @return whether the group is solved; if not it is as it was
template <int kSize>
bool LightGroups<kSize>::relax(const Group& group, std::span<LocalContact> contacts,
                               std::span<double> records, double fall) {
    using Velocity = typename ContactRelaxation<kSize>::Velocity;
    contacts_.clear(), bodies_.clear(), records_.clear();
    const auto number = [&](std::int32_t body) {
        std::int32_t& known = number_of_[index(body)];
        if (known < 0) {
            known = static_cast<std::int32_t>(bodies_.size());
            bodies_.push_back(body);
            const double* record = &records[4 * index(body)];
            records_.insert(records_.end(), record, record + 4);
        }
        return known;
    };
    for (std::uint32_t i = group.first; i < group.last; ++i) {
        LocalContact c = contacts[order_[i]];
        c.a = number(c.a);
        if (c.b >= 0) c.b = number(c.b);
        contacts_.push_back(c);
    }
    for (const std::int32_t body : bodies_) number_of_[index(body)] = -1;
    const auto limit = [&] { return (carries(fall) ? kOffCarrying : kOff) * fall; };
    const double before = off();
    if (before <= limit()) return true;
    if (!(before <= kQuiet * fall)) return false;
    const Vec2 from = velocity_of_heaviest();
    const double fastest_before = fastest(from);
    give_impulses(-1);
    relaxation_.begin(contacts_, bodies_.size());
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        const double* swept_record = &records[4 * index(bodies_[body])];
        Velocity free, swept;
        for (std::size_t k = 0; k < kSize; ++k) free[k] = records_[4 * body + k], swept[k] = swept_record[k];
        relaxation_.set_body(body, swept_record[3], swept, free, swept);
    }
    relaxation_.solve(contacts_, fall, kEffort);
    // The bodies take what impulses give: the relaxation moves no heavy body by less than it looks at.
    give_impulses(1);
    if (!(off() <= limit()) || !(fastest(from) <= fastest_before + fall)) return false;
    for (std::size_t body = 0; body < bodies_.size(); ++body)
        std::copy_n(&records_[4 * body], kSize, &records[4 * index(bodies_[body])]);
    for (std::uint32_t i = group.first; i < group.last; ++i)
        contacts[order_[i]].impulses = contacts_[i - group.first].impulses;
    return true;
}

template <int kSize>
void LightGroups<kSize>::solve(std::span<LocalContact> contacts, std::span<double> records, double uneven,
                               double fall) {
    if (!are_known_) find(contacts, records, uneven);
    left_.clear(), unsolved_ = 0;
    const auto leave = [&](const Group& group) {
        left_.insert(left_.end(), order_.begin() + group.first, order_.begin() + group.last);
    };
    for (const Group& group : groups_) {
        const bool may_relax = group.is_small && fall > 0;
        if (!group.has_pairs || (may_relax && relax(group, contacts, records, fall))) continue;
        unsolved_ += group.last - group.first;
        leave(group);
    }
    if (left_.empty()) return;
    for (const Group& group : groups_)
        if (!group.has_pairs) leave(group);
}

template <int kSize>
std::size_t LightGroups<kSize>::bytes() const {
    return touching_.bytes() + (order_.capacity() + left_.capacity()) * sizeof(std::uint32_t) +
           (group_of_.capacity() + light_.capacity() + number_of_.capacity() + bodies_.capacity()) *
               sizeof(std::int32_t) +
           groups_.capacity() * sizeof(Group) + contacts_.capacity() * sizeof(LocalContact) +
           records_.capacity() * sizeof(double) + relaxation_.bytes();
}

template class LightGroups<2>;
template class LightGroups<3>;

}  // namespace carom
