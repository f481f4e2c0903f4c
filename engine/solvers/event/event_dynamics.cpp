#include "solvers/event/event_dynamics.hpp"

#include <algorithm>
#include <cmath>

// The events of solver `event`. How discs are laid out in memory is in event_layout.cpp.

namespace carom {
namespace {

constexpr double kFarAhead = 1e15;  // s, at which the search for a curved path's impact ends
/// The search for a contact ends within this share of the reach (the sum of the radii).
constexpr double kContactRoundOff = 1e-13;
/// It gave up before the two touched if they are farther apart than this share of the reach, and than
/// round-off: the share below of the coordinates.
constexpr double kStillApart = 1e-9;
constexpr double kRoundOff = 1e-14;

/// Impacts in one advance() beyond which it gives up: docs/decisions/0024-interrupted-steps.md.
constexpr std::int64_t kMostImpacts = 1000000;
constexpr std::int64_t kMostImpactsADisc = 10000;
/// The number of impacts before the bound in which the discs with most of them are looked for.
constexpr std::int64_t kTallied = 10000;

}  // namespace

/// The first impact a disc is offered, and when the second would be.
struct EventDynamics::Earliest {
    double time = kNever, second = kNever;
    std::int32_t partner = kNoPartner;

    void offer(double when, std::int32_t with) {
        if (when < time)
            second = time, time = when, partner = with;
        else if (when < second)
            second = when;
    }
};

double EventDynamics::meeting_time(std::size_t disc, const Path& path, std::size_t other) {
    ++counters_.pair_tests;
    const Vec2 d = store_.position_at(other, path.now) - path.position;
    const Vec2 v = store_.velocity_at(other, path.now) - path.velocity;
    const double reach = store_.movers[disc].radius + store_.movers[other].radius;
    const Window window{0, kFarAhead, 0};
    if (store_.fall_alike(disc, other)) return path.now + straight_impact_time(d, v, reach, window);
    const Flight relative{d, v, store_.gravity_on(other) - store_.gravity_on(disc)};
    const double round_off = kContactRoundOff * reach;
    const bool rests = length_squared(d) <= (reach + round_off) * (reach + round_off) && dot(d, v) == 0 &&
                       dot(d, relative.acceleration) + length_squared(v) < 0;
    return rests ? path.now : path.now + accelerated_impact_time(relative, reach, window, round_off);
}

template <class Offer>
void EventDynamics::for_each_meeting(std::size_t disc, const Path& path, const Offer& offer) {
    for (std::int32_t side = 0; side < 4 && !store_.is_immovable(disc); ++side) {
        const EventWall& wall = store_.laws.walls[static_cast<std::size_t>(side)];
        if (!wall.is_closed) continue;
        const double clearance = dot(wall.normal, path.position) - wall.offset - store_.movers[disc].radius;
        offer(path.now + fall_time(clearance, dot(wall.normal, path.velocity),
                                   dot(wall.normal, store_.laws.gravity)),
              -1 - side);
    }
    for_each_neighbour(disc, [&](std::size_t other) {
        offer(meeting_time(disc, path, other), static_cast<std::int32_t>(other));
    });
}

/// Looks for all impacts of a disc from now on, and for when it leaves its cell.
void EventDynamics::forecast(std::size_t disc, double now) {
    ++counters_.forecasts;
    const Path path{store_.position_at(disc, now), store_.velocity_at(disc, now), now};
    Earliest earliest;
    const bool stands = store_.is_immovable(disc) && path.velocity == Vec2{};  // others come to it
    if (!stands) {
        for_each_meeting(disc, path, [&](double time, std::int32_t with) { earliest.offer(time, with); });
        if (!store_.is_large(disc)) set_exit(disc, path);
    }
    EventForecast& f = store_.forecasts[disc];
    f.impact_time = earliest.time, f.partner = earliest.partner;
    f.is_tied = earliest.second - earliest.time <= same_instant_;
    if (f.partner >= 0) f.partner_impacts = store_.forecasts[static_cast<std::size_t>(f.partner)].impacts;
    queue_.set(disc, f.time());
}

void EventDynamics::set_exit(std::size_t disc, const Path& path) {
    const EventCells::Exit exit =
        cells_.find_exit(store_.movers[disc], path.position, path.velocity, store_.gravity_on(disc));
    store_.forecasts[disc].exit_time = path.now + exit.after;
    store_.forecasts[disc].exit_side = exit.side;
}

/// A disc enters the next cell: only the discs of three more cells are new to it.
void EventDynamics::cross(std::size_t disc, double now) {
    ++counters_.crossings;
    EventForecast& f = store_.forecasts[disc];
    const std::uint8_t side = f.exit_side;
    cells_.move({store_.movers.data(), store_.count()}, static_cast<std::int32_t>(disc), side);
    const Path path{store_.position_at(disc, now), store_.velocity_at(disc, now), now};
    Earliest earliest;
    cells_.for_each_ahead(store_.movers.span(), store_.movers[disc], side, [&](std::int32_t other) {
        const auto with = static_cast<std::size_t>(other);
        const bool is_known = other == f.partner && !is_void(f);
        if (with != disc && !is_known && !(store_.is_immovable(disc) && store_.is_immovable(with)))
            earliest.offer(meeting_time(disc, path, with), other);
    });
    if (earliest.time < f.impact_time) {
        f.is_tied = std::min(earliest.second, f.impact_time) - earliest.time <= same_instant_;
        f.impact_time = earliest.time, f.partner = earliest.partner;
        f.partner_impacts = store_.forecasts[static_cast<std::size_t>(f.partner)].impacts;
    } else if (earliest.time - f.impact_time <= same_instant_) {
        f.is_tied = true;
    }
    set_exit(disc, path);
    queue_.set(disc, f.time());
}

bool EventDynamics::is_void(const EventForecast& f) const {
    return f.partner >= 0 &&
           store_.forecasts[static_cast<std::size_t>(f.partner)].impacts != f.partner_impacts;
}

double EventDynamics::advance(double duration, Interruption& interruption) {
    impacts_left_ = most_impacts();
    double left = duration;
    while (time_ + left > longest_clock_) {
        const double part = std::min(left, longest_clock_);
        restart_clock();
        if (!run_until(part, interruption)) return duration - (left - time_);
        left -= part;
    }
    const double begin = time_;
    return run_until(time_ + left, interruption) ? duration : duration - (left - (time_ - begin));
}

/// @return whether it came to the end; if not, `time_` is that of the next event
bool EventDynamics::run_until(double end, Interruption& interruption) {
    while (queue_.first_time() <= end) {
        const std::size_t disc = queue_.first();
        const EventForecast& f = store_.forecasts[disc];
        const double now = f.time();
        bool is_over = interruption.is_due_after(Interruption::kImpact);
        if (is_over) {
        } else if (f.exit_time < f.impact_time) {
            cross(disc, now);
        } else if (is_void(f)) {
            forecast(disc, now);
        } else {
            is_over = !count_impact(disc);
            if (!is_over) impact(disc, now);
        }
        if (!is_over) continue;
        time_ = std::max(time_, now);
        return false;
    }
    time_ = end;
    return true;
}

std::int64_t EventDynamics::most_impacts() const {
    return kMostImpacts + kMostImpactsADisc * static_cast<std::int64_t>(store_.first_immovable);
}

/// Takes an impact that is due off the limit. @return whether there was one left
bool EventDynamics::count_impact(std::size_t disc) {
    if (--impacts_left_ >= kTallied) return true;
    const std::size_t walls = store_.count();
    if (impacts_left_ + 1 == kTallied) tally_.assign(walls + store_.laws.walls.size(), 0);
    if (impacts_left_ < 0) return false;
    const std::int32_t partner = store_.forecasts[disc].partner;
    ++tally_[static_cast<std::size_t>(store_.row_of[disc])];
    ++tally_[partner < 0 ? walls + static_cast<std::size_t>(-1 - partner)
                         : static_cast<std::size_t>(store_.row_of[static_cast<std::size_t>(partner)])];
    return true;
}

auto EventDynamics::find_busiest() const -> Busiest {
    Busiest busiest{kTallied, {}};
    for (std::size_t i = 0; i < tally_.size(); ++i) {
        const auto number = static_cast<std::int32_t>(i), walls = static_cast<std::int32_t>(store_.count());
        if (tally_[i] > 0) busiest.sides.push_back({number < walls ? number : walls - 1 - number, tally_[i]});
    }
    const auto more = [](const Busiest::Side& p, const Busiest::Side& q) { return p.impacts > q.impacts; };
    std::stable_sort(busiest.sides.begin(), busiest.sides.end(), more);
    return busiest;
}

/// The contact of a disc and its partner, A the one that can move, or the first of two.
EventContact EventDynamics::contact_of(std::size_t disc, std::int32_t partner, double now) const {
    auto a = static_cast<std::int32_t>(disc), b = partner;
    if (b >= 0 && b < a) std::swap(a, b);  // immovable ones have the highest numbers
    return impacts_.measure(store_, a, b, now);
}

/// Whether the search for an impact on curved paths gave up before they touched.
bool EventDynamics::is_still_apart(const EventContact& c, double now) const {
    const auto a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
    if (c.b < 0 || store_.fall_alike(a, b)) return false;
    const Vec2 x = store_.position_at(a, now);
    const double reach = store_.movers[a].radius + store_.movers[b].radius;
    return c.separation > kStillApart * reach + kRoundOff * (std::fabs(x.x) + std::fabs(x.y));
}

void EventDynamics::impact(std::size_t disc, double now) {
    const EventForecast& f = store_.forecasts[disc];
    queue_.set(disc, kNever);
    if (f.partner >= 0) {  // a disc, which mostly has foreseen the same impact
        const EventForecast& of_partner = store_.forecasts[static_cast<std::size_t>(f.partner)];
        const bool is_same = of_partner.partner == static_cast<std::int32_t>(disc) &&
                             of_partner.impact_time <= now + same_instant_;
        if (is_same && !of_partner.is_tied) queue_.set(static_cast<std::size_t>(f.partner), kNever);
    }
    if (f.is_tied || queue_.first_time() <= now + same_instant_) return impact_together(disc, now);
    EventContact contact = contact_of(disc, f.partner, now);
    if (!is_still_apart(contact, now)) return carry_out_alone(disc, contact, now);
    const auto partner = static_cast<std::size_t>(f.partner);
    forecast(disc, now);
    forecast(partner, now);
}

void EventDynamics::carry_out_alone(std::size_t disc, EventContact& contact, double now) {
    impacts_.carry_out(store_, contact, now);
    const auto a = static_cast<std::size_t>(contact.a), b = static_cast<std::size_t>(contact.b);
    const bool both_move = contact.b >= 0 && !store_.is_immovable(b);
    ++store_.forecasts[a].impacts;
    if (both_move) ++store_.forecasts[b].impacts;
    forecast(a, now);
    if (both_move || disc == b) forecast(b, now);
}

void EventDynamics::involve(std::int32_t disc) {
    if (is_involved_.size() < store_.count()) is_involved_.resize(store_.count(), 0);
    std::uint8_t& is_involved = is_involved_[static_cast<std::size_t>(disc)];
    if (is_involved != 0) return;
    is_involved = 1;
    involved_.push_back(disc);
}

void EventDynamics::add_contact(std::size_t disc, std::int32_t partner, double now) {
    const EventContact contact = contact_of(disc, partner, now);
    involve(static_cast<std::int32_t>(disc));
    if (is_still_apart(contact, now)) return;
    if (partner >= 0) involve(partner);
    contacts_.push_back(contact);
}

/// Carries out the impacts of this instant together: the disc's own, and all others that the discs involved
/// have at it.
void EventDynamics::impact_together(std::size_t disc, double now) {
    contacts_.clear(), involved_.clear();
    add_contact(disc, store_.forecasts[disc].partner, now);
    while (queue_.first_time() <= now + same_instant_) {
        const std::size_t next = queue_.first();
        const EventForecast& f = store_.forecasts[next];
        if (f.exit_time < f.impact_time) {
            cross(next, f.exit_time);
        } else if (is_void(f)) {
            forecast(next, f.impact_time);
        } else {
            add_contact(next, f.partner, now);
            queue_.set(next, kNever);
        }
    }
    for (std::size_t i = 0; i < involved_.size(); ++i) {
        const auto each = static_cast<std::size_t>(involved_[i]);
        const Path path{store_.position_at(each, now), store_.velocity_at(each, now), now};
        for_each_meeting(each, path, [&](double time, std::int32_t with) {
            if (time <= now + same_instant_) add_contact(each, with, now);
        });
    }
    const auto before = [](const EventContact& p, const EventContact& q) {
        return p.a != q.a ? p.a < q.a : p.b < q.b;
    };
    std::sort(contacts_.begin(), contacts_.end(), before);
    const auto same = [](const EventContact& p, const EventContact& q) { return p.a == q.a && p.b == q.b; };
    contacts_.erase(std::unique(contacts_.begin(), contacts_.end(), same), contacts_.end());
    impacts_.carry_out(store_, contacts_, now);
    for (const std::int32_t each : involved_) {
        is_involved_[static_cast<std::size_t>(each)] = 0;
        ++store_.forecasts[static_cast<std::size_t>(each)].impacts;
    }
    for (const std::int32_t each : involved_) forecast(static_cast<std::size_t>(each), now);
}

EventDynamics::State EventDynamics::state(std::size_t row) const {
    const auto disc = static_cast<std::size_t>(store_.disc_of[row]);
    return {store_.position_at(disc, time_), store_.velocity_at(disc, time_), store_.angle_at(disc, time_),
            store_.surfaces[disc].spin};
}

std::size_t EventDynamics::bytes() const {
    return store_.bytes() + cells_.bytes() + queue_.bytes() + impacts_.bytes() +
           contacts_.capacity() * sizeof(EventContact) + involved_.capacity() * sizeof(std::int32_t) +
           tally_.capacity() * sizeof(std::int64_t);
}

}  // namespace carom
