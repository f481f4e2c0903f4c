#include "solvers/contact_sets/rebalance.hpp"

#include <algorithm>
#include <cmath>

#include "effects/contact_law.hpp"
#include "math/vec2_math.hpp"

namespace carom {
namespace {

/// A body may keep this much impulse too much: this many times that of its own weight in a substep, plus this
/// share of the impulses that press on it.
constexpr double kAllowedWeights = 0.5, kAllowedShare = 0.002;
/// Stiffness of a contact along its tangent over that along its normal: the ratio of a disc's effective
/// masses.
constexpr double kTangentStiffness = kTangentMassShare;
/// Stiffness, in that of one contact, which is added in every direction: a body with a single contact is then
/// held sideways, too.
constexpr double kLeastStiffness = 1e-3;
constexpr double kOverRelaxation = 1.5;
/// A body is looked at again at once if its excess became smaller than this share of its square: what its
/// contacts cannot take is left.
constexpr double kWorthAnother = 0.9;
/// At most this many looks at a body, 0.1 us each; the sweeps are left the unevenness that remains.
constexpr std::size_t kMostLooks = 20000;
/// Likewise a removed body, unless one was heavier than so many of those that it pressed on: more would
/// loosen what holds together around a hole.
constexpr std::size_t kLooksOfLight = 200;
constexpr double kHeavy = 4;
/// Looks for each further body that goes in the same step: where many go the rest falls anyway.
constexpr std::size_t kLooksOfNext = 60;
/// Bodies around holes are looked at alone if no more contacts were lost; around is within so many radii.
constexpr std::size_t kFewLost = 16;
constexpr double kNearRadii = 24;

Vec2 tangent_of(Vec2 normal) {
    return {-normal.y, normal.x};
}

}  // namespace

/// Marks the bodies that may be looked at: where few light bodies are gone, those around the holes.
template <class Real>
void Rebalance<Real>::mark_near(std::span<const LostContact> lost) {
    const Bodies<Real>& bodies = *bodies_;
    is_near_.assign(bodies.count, lost.size() > kFewLost);
    if (lost.size() > kFewLost) return;
    // The load of a heavy body may go far, and so may that of an edge, whatever it was.
    for (std::size_t first = 0, last = 0; first < lost.size(); first = last) {
        double heaviest = 0;  // kg
        bool is_known = true;
        for (; last < lost.size() && lost[last].gone == lost[first].gone; ++last) {
            heaviest = std::fmax(heaviest,
                                 static_cast<double>(bodies.mass[static_cast<std::size_t>(lost[last].row)]));
            is_known = is_known && lost[last].is_impulse_known;
        }
        if (!is_known || lost[first].mass > kHeavy * heaviest) return is_near_.assign(bodies.count, 1);
    }
    for (const LostContact& contact : lost) {
        const auto row = static_cast<std::size_t>(contact.row);
        const Real x = bodies.position_x[row], y = bodies.position_y[row],
                   reach = static_cast<Real>(kNearRadii) * bodies.radius[row];
        for (std::size_t other = 0; other < bodies.moving(); ++other)
            is_near_[other] |= std::fabs(bodies.position_x[other] - x) < reach &&
                               std::fabs(bodies.position_y[other] - y) < reach;
    }
}

/// Lists the contacts of each row that push, by their numbers: supports come after the pairs.
template <class Real>
void Rebalance<Real>::list_contacts(std::size_t rows) {
    const ContactRows<Real>&pairs = *pairs_, &supports = *supports_;
    const auto for_each_side = [&](const auto& fn) {
        pairs.for_each([&](std::size_t i) {
            if (!is_near_[static_cast<std::size_t>(pairs.a[i])] || !(pairs.normal_impulse[i] > 0)) return;
            fn(pairs.a[i], i), fn(pairs.b[i], i);
        });
        supports.for_each([&](std::size_t i) {
            if (is_near_[static_cast<std::size_t>(supports.a[i])] && supports.normal_impulse[i] > 0)
                fn(supports.a[i], pairs.a.size() + i);
        });
    };
    first_of_.assign(rows + 2, 0);
    for_each_side([&](std::int32_t row, std::size_t) { ++first_of_[static_cast<std::size_t>(row) + 2]; });
    for (std::size_t row = 2; row < rows + 2; ++row) first_of_[row] += first_of_[row - 1];
    of_body_.resize(first_of_[rows + 1]);
    for_each_side([&](std::int32_t row, std::size_t number) {
        of_body_[first_of_[static_cast<std::size_t>(row) + 1]++] = static_cast<std::uint32_t>(number);
    });
    place_of_.assign(pairs.a.size() + supports.a.size(), kNotLoaded);
    loaded_.clear(), known_.clear();
    loaded_.reserve(of_body_.size());
    loads_.resize(std::max(loads_.size(), rows));
}

/// The place of a contact among those in question.
template <class Real>
std::uint32_t Rebalance<Real>::load_contact(std::uint32_t number) {
    std::uint32_t& place = place_of_[number];
    if (place != kNotLoaded) return place;
    place = static_cast<std::uint32_t>(loaded_.size());
    const bool is_pair = number < pairs_->a.size();
    const ContactRows<Real>& contacts = is_pair ? *pairs_ : *supports_;
    const std::size_t i = is_pair ? number : number - pairs_->a.size();
    const auto value = [i](const Column<Real>& column, double without) {
        return column.empty() ? without : static_cast<double>(column[i]);
    };
    const bool is_rough = !contacts.friction_impulse.empty(), rolls = !contacts.rolling_impulse.empty();
    loaded_.push_back({contacts.a[i],
                       is_pair ? contacts.b[i] : -1,
                       number,
                       {contacts.normal_x[i], contacts.normal_y[i]},
                       is_rough ? value(contacts.friction, friction_) : 0,
                       rolls ? value(contacts.rolling, rolling_) : 0,
                       contacts.normal_impulse[i],
                       value(contacts.friction_impulse, 0),
                       value(contacts.rolling_impulse, 0)});
    return place;
}

/// What the contacts of a body give it together.
template <class Real>
Vec2 Rebalance<Real>::impulses_on(std::int32_t row) {
    const Load& load = load_of(row);
    Vec2 sum;
    for (std::uint32_t k = load.begin; k < load.end; ++k) {
        const Loaded& contact = loaded_[of_body_[k]];
        sum += (row == contact.a ? -1.0 : 1.0) * (contact.normal_impulse * contact.normal +
                                                  contact.friction_impulse * tangent_of(contact.normal));
    }
    return sum;
}

/// The load of a body. The first time it is asked for, its contacts come into question.
template <class Real>
auto Rebalance<Real>::load_of(std::int32_t row) -> Load& {
    const auto i = static_cast<std::size_t>(row);
    Load& load = loads_[i];
    if (load.is_known) return load;
    load.is_known = true;
    known_.push_back(row);
    load.begin = first_of_[i], load.end = first_of_[i + 1];
    if (!bodies_->is_immovable(i)) {
        const double mass = bodies_->mass[i];
        load.weight = mass * gain_;
        load.allowed = mass * kAllowedWeights * std::sqrt(length_squared(gain_));
    }
    for (std::uint32_t k = load.begin; k < load.end; ++k) {
        of_body_[k] = load_contact(of_body_[k]);
        const Loaded& contact = loaded_[of_body_[k]];
        load.allowed += kAllowedShare * std::sqrt(contact.normal_impulse * contact.normal_impulse +
                                                  contact.friction_impulse * contact.friction_impulse);
    }
    return load;
}

/// The part of a body's excess impulse that neither rest nor free fall explains: a body may go without any
/// part of what its weight asks for.
template <class Real>
Vec2 Rebalance<Real>::excess_of(const Load& load) const {
    const double w2 = length_squared(load.weight);
    if (!(w2 > 0)) return load.excess;
    const double share = std::fmax(0, std::fmin(1, dot(load.excess, load.weight) / w2));
    return load.excess - share * load.weight;
}

template <class Real>
void Rebalance<Real>::queue_if_uneven(std::int32_t row) {
    Load& load = load_of(row);
    if (load.is_queued) return;
    const Vec2 excess = excess_of(load);
    if (length_squared(excess) <= load.allowed * load.allowed) return;
    load.is_queued = true;
    queue_.push_back(row);
}

/// The weight of a body that is gone is what it pressed on others with, less what pressed on it. That load
/// flows off; the rest finds another way.
template <class Real>
void Rebalance<Real>::begin_flows(std::span<const LostContact> lost) {
    for (std::size_t first = 0, last = 0; first < lost.size(); first = last) {
        double up = 0, down = 0;  // N s, along the weight of the bodies that were pressed
        double heaviest = 0;      // kg, of those
        for (; last < lost.size() && lost[last].gone == lost[first].gone; ++last) {
            const Load& load = load_of(lost[last].row);
            const double weight = std::sqrt(length_squared(load.weight));
            if (!(weight > 0)) continue;  // nothing moves it: what it bore or bore down with ends there
            heaviest = std::fmax(
                heaviest, static_cast<double>(bodies_->mass[static_cast<std::size_t>(lost[last].row)]));
            const double along = dot(load.excess, load.weight) / weight;
            (along < 0 ? up : down) += std::fabs(along);
        }
        most_looks_ += most_looks_ == 0 ? kLooksOfLight : kLooksOfNext;
        if (!(up > down)) continue;
        // Impulses tell what an edge bore that is gone. A body is told by its mass: in a heap that moves its
        // impulses are those of blows, too.
        const double borne = (up - down) / std::sqrt(length_squared(gain_)),
                     mass = lost[first].is_impulse_known ? lost[first].mass : borne;
        if (mass > kHeavy * heaviest) most_looks_ = kMostLooks;
        for (std::size_t i = first; i < last; ++i) {
            Load& load = load_of(lost[i].row);
            if (dot(load.excess, load.weight) < 0) flow_to(lost[i].row, (1 - down / up) * load.excess);
        }
    }
}

template <class Real>
void Rebalance<Real>::flow_to(std::int32_t row, Vec2 impulse) {
    Load& load = load_of(row);
    load.flow += impulse;
    if (load.is_queued || length_squared(load.flow) <= load.allowed * load.allowed) return;
    load.is_queued = true;
    queue_.push_back(row);
}

/// Takes what flows through a body from the contacts that push its way, from each the same share.
template <class Real>
void Rebalance<Real>::pass_load_on(std::int32_t row) {
    Load& load = load_of(row);
    const auto on_body = [&](const Loaded& contact) {
        const Vec2 n = contact.normal;
        return (row == contact.a ? -1.0 : 1.0) *
               (contact.normal_impulse * n + contact.friction_impulse * tangent_of(n));
    };
    const Vec2 flow = load.flow;
    load.flow = {};
    double along = 0;
    for (std::uint32_t k = load.begin; k < load.end; ++k)
        along += std::fmax(0, dot(on_body(loaded_[of_body_[k]]), flow));
    if (!(along > 0)) return;
    const double share = std::fmin(1, length_squared(flow) / along);
    for (std::uint32_t k = load.begin; k < load.end; ++k) {
        Loaded& contact = loaded_[of_body_[k]];
        const Vec2 taken = share * on_body(contact);
        if (!(dot(taken, flow) > 0)) continue;
        contact.normal_impulse *= 1 - share, contact.friction_impulse *= 1 - share;
        contact.rolling_impulse *= 1 - share;
        load.excess -= taken;
        const std::int32_t other = row == contact.a ? contact.b : contact.a;
        if (other < 0) continue;
        load_of(other).excess += taken;
        flow_to(other, taken);
    }
}

/// Shares the excess of a body out among its contacts.
template <class Real>
void Rebalance<Real>::relax_body(std::int32_t row) {
    Load& load = load_of(row);
    // The body on springs of stiffness 1 along normals: sum (n n' + k t t') x = excess.
    double xx = kLeastStiffness, xy = 0, yy = kLeastStiffness;
    for (std::uint32_t k = load.begin; k < load.end; ++k) {
        const Loaded& contact = loaded_[of_body_[k]];
        const Vec2 n = contact.normal;
        const double along = contact.friction > 0 ? kTangentStiffness : 0;
        xx += n.x * n.x + along * n.y * n.y;
        xy += (1 - along) * n.x * n.y;
        yy += n.y * n.y + along * n.x * n.x;
    }
    const double scale = kOverRelaxation / (xx * yy - xy * xy);
    const Vec2 excess = excess_of(load);
    const Vec2 moved{scale * (yy * excess.x - xy * excess.y), scale * (xx * excess.y - xy * excess.x)};
    for (std::uint32_t k = load.begin; k < load.end; ++k) {
        Loaded& contact = loaded_[of_body_[k]];
        const Vec2 n = contact.normal, t = tangent_of(n);
        const double side = row == contact.a ? 1 : -1;  // towards b
        const auto normal = push_only(contact.normal_impulse, contact.normal_impulse + side * dot(moved, n));
        const auto friction = hold_within(contact.friction_impulse,
                                          contact.friction_impulse + side * kTangentStiffness * dot(moved, t),
                                          contact.friction * normal.impulse);
        const auto rolling =
            hold_within(contact.rolling_impulse, contact.rolling_impulse, contact.rolling * normal.impulse);
        const Vec2 added = normal.added * n + friction.added * t;
        contact.normal_impulse = normal.impulse, contact.friction_impulse = friction.impulse;
        contact.rolling_impulse = rolling.impulse;
        load.excess -= side * added;
        const std::int32_t other = row == contact.a ? contact.b : contact.a;
        if (other < 0) continue;
        load_of(other).excess += side * added;
        queue_if_uneven(other);
    }
    // A contact that only pushes, or slides, may not have taken its share: then the others get the rest.
    if (length_squared(excess_of(load)) < kWorthAnother * length_squared(excess)) queue_if_uneven(row);
}

/// Deals with the bodies of the queue, first come, first served; dealing with one may bring others into it.
template <class Real>
void Rebalance<Real>::drain_queue(void (Rebalance::*deal_with)(std::int32_t)) {
    for (std::size_t i = 0; i < queue_.size(); ++i) {
        loads_[static_cast<std::size_t>(queue_[i])].is_queued = false;
        if (i < std::min(most_looks_, kMostLooks)) (this->*deal_with)(queue_[i]);
    }
}

template <class Real>
bool Rebalance<Real>::balance(std::span<const LostContact> lost, ContactRows<Real>& pairs,
                              ContactRows<Real>& supports, const Bodies<Real>& bodies, double friction,
                              double rolling, Vec2 gain) {
    pairs_ = &pairs, supports_ = &supports, bodies_ = &bodies;
    friction_ = friction, rolling_ = rolling, gain_ = gain;
    queue_.clear(), most_looks_ = 0;
    mark_near(lost);
    list_contacts(bodies.count);
    // Before, the impulses gave each body the motion it had: what is uneven is what was lost, and no more.
    for (const LostContact& contact : lost) {
        if (bodies.is_immovable(static_cast<std::size_t>(contact.row))) continue;
        Load& load = load_of(contact.row);
        if (contact.is_impulse_known)
            load.excess -= contact.impulse;
        else
            load.excess = load.weight + impulses_on(contact.row);
    }
    if (length_squared(gain) > 0) begin_flows(lost);
    drain_queue(&Rebalance::pass_load_on);
    touched_.swap(queue_);
    queue_.clear();
    for (const std::int32_t row : touched_) queue_if_uneven(row);
    for (const LostContact& contact : lost) queue_if_uneven(contact.row);
    drain_queue(&Rebalance::relax_body);
    for (const Loaded& contact : loaded_) {
        const bool is_pair = contact.contact < pairs.a.size();
        ContactRows<Real>& contacts = is_pair ? pairs : supports;
        const std::size_t i = is_pair ? contact.contact : contact.contact - pairs.a.size();
        contacts.normal_impulse[i] = static_cast<Real>(contact.normal_impulse);
        if (!contacts.friction_impulse.empty())
            contacts.friction_impulse[i] = static_cast<Real>(contact.friction_impulse);
        if (!contacts.rolling_impulse.empty())
            contacts.rolling_impulse[i] = static_cast<Real>(contact.rolling_impulse);
    }
    for (const std::int32_t row : known_) loads_[static_cast<std::size_t>(row)] = {};
    return most_looks_ >= kMostLooks;
}

template <class Real>
std::size_t Rebalance<Real>::bytes() const {
    return is_near_.capacity() + loaded_.capacity() * sizeof(Loaded) + loads_.capacity() * sizeof(Load) +
           (of_body_.capacity() + first_of_.capacity() + place_of_.capacity()) * sizeof(std::uint32_t) +
           (queue_.capacity() + touched_.capacity() + known_.capacity()) * sizeof(std::int32_t);
}

template class Rebalance<float>;
template class Rebalance<double>;

}  // namespace carom
