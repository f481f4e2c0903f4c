#include "solvers/shared/rebalance.hpp"

#include <algorithm>
#include <cmath>

#include "constraints/contact_law.hpp"
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

Vec2 tangent_of(Vec2 normal) {
    return {-normal.y, normal.x};
}

}  // namespace

template <class Real>
void Rebalance<Real>::list(const ContactRows<Real>& contacts, bool are_pairs, double friction,
                           double rolling) {
    contacts.for_each([&](std::size_t i) {
        if (!(contacts.normal_impulse[i] > 0)) return;
        const auto value = [i](const Column<Real>& column, double without) {
            return column.empty() ? without : static_cast<double>(column[i]);
        };
        const bool is_rough = !contacts.friction_impulse.empty(), rolls = !contacts.rolling_impulse.empty();
        loaded_.push_back({contacts.a[i],
                           are_pairs ? contacts.b[i] : -1,
                           static_cast<std::uint32_t>(i),
                           {contacts.normal_x[i], contacts.normal_y[i]},
                           is_rough ? value(contacts.friction, friction) : 0,
                           rolls ? value(contacts.rolling, rolling) : 0,
                           contacts.normal_impulse[i],
                           value(contacts.friction_impulse, 0),
                           value(contacts.rolling_impulse, 0)});
    });
}

template <class Real>
void Rebalance<Real>::sort_by_body() {
    for (const Loaded& contact : loaded_)
        for (const std::int32_t row : {contact.a, contact.b})
            if (row >= 0) ++loads_[static_cast<std::size_t>(row)].end;
    std::uint32_t place = 0;
    for (Load& load : loads_) {
        load.begin = place;
        place += load.end;
        load.end = load.begin;
    }
    of_body_.resize(place);
    for (std::uint32_t i = 0; i < loaded_.size(); ++i) {
        const Loaded& contact = loaded_[i];
        const Vec2 impulse =
            contact.normal_impulse * contact.normal + contact.friction_impulse * tangent_of(contact.normal);
        for (const std::int32_t row : {contact.a, contact.b}) {
            if (row < 0) continue;
            Load& load = loads_[static_cast<std::size_t>(row)];
            of_body_[load.end++] = i;
            load.excess += (row == contact.a ? -1.0 : 1.0) * impulse;
            load.allowed += kAllowedShare * std::sqrt(length_squared(impulse));
        }
    }
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
    Load& load = loads_[static_cast<std::size_t>(row)];
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
        for (; last < lost.size() && lost[last].gone == lost[first].gone; ++last) {
            const Load& load = loads_[static_cast<std::size_t>(lost[last].row)];
            const double weight = std::sqrt(length_squared(load.weight));
            if (!(weight > 0)) continue;  // nothing moves it: what it bore or bore down with ends there
            const double along = dot(load.excess, load.weight) / weight;
            (along < 0 ? up : down) += std::fabs(along);
        }
        if (!(up > down)) continue;
        for (std::size_t i = first; i < last; ++i) {
            Load& load = loads_[static_cast<std::size_t>(lost[i].row)];
            if (dot(load.excess, load.weight) < 0) flow_to(lost[i].row, (1 - down / up) * load.excess);
        }
    }
}

template <class Real>
void Rebalance<Real>::flow_to(std::int32_t row, Vec2 impulse) {
    Load& load = loads_[static_cast<std::size_t>(row)];
    load.flow += impulse;
    if (load.is_queued || length_squared(load.flow) <= load.allowed * load.allowed) return;
    load.is_queued = true;
    queue_.push_back(row);
}

/// Takes what flows through a body from the contacts that push its way, from each the same share.
template <class Real>
void Rebalance<Real>::pass_load_on(std::int32_t row) {
    Load& load = loads_[static_cast<std::size_t>(row)];
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
        loads_[static_cast<std::size_t>(other)].excess += taken;
        flow_to(other, taken);
    }
}

/// Shares the excess of a body out among its contacts.
template <class Real>
void Rebalance<Real>::relax_body(std::int32_t row) {
    Load& load = loads_[static_cast<std::size_t>(row)];
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
        loads_[static_cast<std::size_t>(other)].excess += side * added;
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
        if (i < kMostLooks) (this->*deal_with)(queue_[i]);
    }
}

template <class Real>
void Rebalance<Real>::balance(std::span<const LostContact> lost, ContactRows<Real>& pairs,
                              ContactRows<Real>& supports, const Bodies<Real>& bodies, double friction,
                              double rolling, Vec2 gain) {
    loaded_.clear(), queue_.clear();
    list(pairs, true, friction, rolling);
    const std::size_t pair_count = loaded_.size();
    list(supports, false, friction, rolling);
    loads_.assign(bodies.count, {});
    sort_by_body();
    const double weight = kAllowedWeights * std::sqrt(length_squared(gain));
    for (std::size_t row = 0; row < bodies.count; ++row) {
        if (bodies.is_immovable(row)) continue;
        const double mass = bodies.mass[row];
        loads_[row].excess += mass * gain, loads_[row].weight = mass * gain;
        loads_[row].allowed += mass * weight;
    }
    if (weight > 0) begin_flows(lost);
    drain_queue(&Rebalance::pass_load_on);
    touched_.swap(queue_);
    queue_.clear();
    for (const std::int32_t row : touched_) queue_if_uneven(row);
    for (const LostContact& contact : lost) queue_if_uneven(contact.row);
    drain_queue(&Rebalance::relax_body);
    for (std::size_t i = 0; i < loaded_.size(); ++i) {
        ContactRows<Real>& contacts = i < pair_count ? pairs : supports;
        const Loaded& contact = loaded_[i];
        contacts.normal_impulse[contact.contact] = static_cast<Real>(contact.normal_impulse);
        if (!contacts.friction_impulse.empty())
            contacts.friction_impulse[contact.contact] = static_cast<Real>(contact.friction_impulse);
        if (!contacts.rolling_impulse.empty())
            contacts.rolling_impulse[contact.contact] = static_cast<Real>(contact.rolling_impulse);
    }
}

template <class Real>
std::size_t Rebalance<Real>::bytes() const {
    return loaded_.capacity() * sizeof(Loaded) + loads_.capacity() * sizeof(Load) +
           of_body_.capacity() * sizeof(std::uint32_t) +
           (queue_.capacity() + touched_.capacity()) * sizeof(std::int32_t);
}

template class Rebalance<float>;
template class Rebalance<double>;

}  // namespace carom
