#include "solvers/impulse/impacts/resting_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "effects/contact_law.hpp"

namespace carom {
namespace {

// Gauss-Seidel ends when a sweep changes nothing by more than this fraction of the largest value, or here: a
// stack of n needs some 10 n² sweeps. Contacts persist from step to step and start from their last forces, so
// a pile that is too deep for that converges over several steps.
constexpr std::size_t kMostUpdates = 1000000;  // updates of single contacts: some 10 ms
constexpr std::size_t kFewestSweeps = 200;
constexpr std::size_t kMostSweepsAtRest = 10000;  // so that the work is bounded by the contacts there are
constexpr double kConvergedAtRest = 1e-13;

// Parts of the rest speed, which is itself a small part of what gravity adds in a step.
constexpr double kLeaving = 1e-2;
constexpr double kStopped = 1e-12;

}  // namespace

template <class Real>
void RestingContacts<Real>::stop(Flights<Real>& flights, const std::vector<PressedMeeting>& contacts) {
    place_of_row_.resize(std::max(place_of_row_.size(), flights.bodies->count), -1);
    stopped_.begin(place_of_row_);
    stopped_.clear();
    for (const PressedMeeting& contact : contacts) {
        const Encounter e = flights.encounter(contact.meeting, 0);
        stopped_.add(flights, contact.meeting, e, 0, 0);
    }
    stopped_.carry_out(flights, kStopped * flights.rest_speed);
}

template <class Real>
void RestingContacts<Real>::carry(Flights<Real>& flights, std::vector<PressedMeeting>& contacts) {
    const auto accelerate = [&](std::int32_t row, Vec2 force) {
        flights.accelerations[static_cast<std::size_t>(row)] += flights.inverse_mass(row) * force;
    };
    const auto press = [&](std::size_t i, double change) {
        const Vec2 force = change * solved_[i].normal;
        accelerate(contacts[i].meeting.a, -force);
        if (!contacts[i].meeting.with_wall()) accelerate(contacts[i].meeting.b, force);
    };
    for (std::size_t i = 0; i < contacts.size(); ++i) press(i, contacts[i].force);
    const std::size_t most_sweeps = std::clamp(kMostUpdates / std::max<std::size_t>(contacts.size(), 1),
                                               kFewestSweeps, kMostSweepsAtRest);
    for (std::size_t sweep = 0; sweep < most_sweeps; ++sweep) {
        if (flights.is_interrupted_after(contacts.size() * Interruption::kUpdate)) return;
        double largest_change = 0, largest = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const Meeting m = contacts[i].meeting;
            if (solved_[i].inverse_mass_sum == 0) continue;
            const Vec2 of_b = m.with_wall() ? Vec2{} : flights.acceleration(m.b);
            const double apart =
                dot(of_b - flights.acceleration(m.a), solved_[i].normal) + solved_[i].unforced;
            // Signorini's law again, of forces and accelerations.
            const auto [force, change] =
                push_only(contacts[i].force, contacts[i].force - apart / solved_[i].inverse_mass_sum);
            contacts[i].force = force;
            press(i, change);
            largest_change = std::fmax(largest_change, std::fabs(change));
            largest = std::fmax(largest, force);
        }
        if (largest_change <= kConvergedAtRest * largest) break;
    }
}

/// Books the momentum and the work that walls and immovable bodies give to the bodies they carry.
template <class Real>
void RestingContacts<Real>::book(Flights<Real>& flights, const std::vector<PressedMeeting>& contacts) {
    Books& books = *flights.books;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Meeting m = contacts[i].meeting;
        const Vec2 on_a = (-contacts[i].force * flights.end.t) * solved_[i].normal;
        if (m.with_wall()) {
            books.add_wall_impulse(on_a);
        } else if (flights.is_immovable(m.a) != flights.is_immovable(m.b)) {
            const bool b_carries = flights.is_immovable(m.b);
            const Vec2 on_movable = b_carries ? on_a : -on_a;
            const double work = dot(on_movable, flights.flight(b_carries ? m.b : m.a).velocity);
            books.immovable_momentum += on_movable;
            books.drive += work;
            books.restitution -= work;  // it is part of the work of all supports (Flights::support_work)
        }
    }
}

template <class Real>
void RestingContacts<Real>::hold(Flights<Real>& flights, std::vector<PressedMeeting>& contacts,
                                 std::vector<std::int32_t>& held) {
    stop(flights, contacts);
    solved_.clear();
    for (PressedMeeting& contact : contacts) {
        const Meeting m = contact.meeting;
        const Encounter e = flights.encounter(m, 0);
        double turning = 0;
        if (!m.with_wall()) {
            const Vec2 v = flights.flight(m.b).velocity - flights.flight(m.a).velocity;
            const double tangential = cross(e.normal, v);
            turning = tangential * tangential / flights.reach(m);
        }
        // Moving apart: nothing to carry. If it is ever so slow it is held all the same, so that the surfaces
        // are at rest at the end of the substep: u vn + s a = 0. Else it would hover, and rise without work.
        const bool leaves = e.normal_velocity > kLeaving * flights.rest_speed;
        if (leaves) contact.force = 0;
        const double slowing = e.normal_velocity * flights.end.u / flights.end.s;
        solved_.push_back({e.normal, turning + slowing, leaves ? 0 : flights.inverse_mass_sum(m)});
    }
    carry(flights, contacts);
    for (const PressedMeeting& contact : contacts) {
        const Meeting m = contact.meeting;
        if (!flights.is_immovable(m.a)) held.push_back(m.a);
        if (!m.with_wall() && !flights.is_immovable(m.b)) held.push_back(m.b);
    }
    std::sort(held.begin(), held.end());
    held.erase(std::unique(held.begin(), held.end()), held.end());
    book(flights, contacts);
}

template class RestingContacts<float>;
template class RestingContacts<double>;

}  // namespace carom
