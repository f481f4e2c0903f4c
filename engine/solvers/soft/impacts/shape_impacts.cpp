#include "solvers/soft/impacts/shape_impacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "solvers/soft/impacts/shape_meeting.hpp"

namespace carom {
namespace {

/// Rounds over all contacts in a substep: what a blow sets in motion may hit the next body in the same one.
constexpr int kRoundsOfShapeImpacts = 8;

/// The impact of shapes of which joints hold one at least: held_impacts.hpp.
/// @param meets  which of the two points
/// @param note_changed  as of `carry_out_one`
/// @return whether there was one
template <class Real, class Fn>
bool strike_held(HeldImpacts<Real>& held, const StruckBody<Real>& a, const StruckBody<Real>& b, Vec2 n,
                 Vec2 t, const Levers& lever_a, const Levers& lever_b, const std::array<bool, 2>& meets,
                 const typename HeldImpacts<Real>::Materials& materials, const SubstepTerms& terms,
                 BodyRecords<Real>& records, Books& books, double& gravity_work, PointImpulses& found,
                 const Fn& note_changed) {
    using Law = typename HeldImpacts<Real>::Law;
    std::array<typename HeldImpacts<Real>::Direction, 3> directions;
    std::array<std::size_t, 3> point{};  // of each direction
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (k < 2 ? !meets[k] : !(materials.friction > 0)) continue;
        const Vec2 along = k < 2 ? n : t;
        double surface = 0;
        if (!(a.w > 0)) surface -= dot(a.start, along) + a.start_rim * lever_a[k];
        if (!(b.w > 0)) surface += dot(b.start, along) + b.start_rim * lever_b[k];
        point[count] = k;
        directions[count++] = {k < 2 ? Law::normal : Law::friction, along, -lever_a[k], lever_b[k], surface};
    }
    const auto record_of = [&](std::int32_t row) {
        const StruckBody<Real> body(records, row, half_kick_of(held, row, terms));
        return std::array<double, 4>{body.start.x, body.start.y, body.start_rim,
                                     records.velocity[4 * static_cast<std::size_t>(row) + 3]};
    };
    if (!held.solve({a.w > 0 ? a.row : kNothing, b.w > 0 ? b.row : kNothing},
                    std::span(directions).first(count), materials, record_of))
        return false;
    for (std::size_t i = 0; i < count; ++i) (point[i] < 2 ? found.x[point[i]] : found.y) = held.impulses()[i];
    found.by_normal = held.work_of(Law::normal), found.by_friction = held.work_of(Law::friction);
    found.is_given = true;
    books.immovable_momentum += held.carry_out([&](std::int32_t row, const std::array<double, 3>& by) {
        // The books will take the whole kick of this substep to be still to come, and half of it has been.
        const double inverse_mass = std::fabs(records.velocity[4 * static_cast<std::size_t>(row) + 3]);
        gravity_work -= dot(Vec2{by[0], by[1]}, half_kick_of(held, row, terms)) / inverse_mass;
        records.add_velocity(row, {by[0], by[1]}, by[2], terms);
        note_changed(row);
    });
    return true;
}

/// What comes no faster than this [m/s] at the start of a substep is no impact, whatever joints hold: half a
/// kick of gravity may come to one of two bodies. A quarter more is left to rounding.
double speed_of_none(const SubstepTerms& terms) {
    return (kRestFalls - 0.75) * terms.fall_speed();
}

/// What comes faster than this [m/s] comes fast, whatever joints hold.
double speed_of_all(const SubstepTerms& terms) {
    return (kRestFalls + 0.75) * terms.fall_speed();
}

/// Whether a point of a contact comes faster than speed_of_none().
template <class Real>
bool may_be_fast(const PathContact<Real>& contact, const SubstepTerms& terms,
                 const BodyRecords<Real>& records) {
    const auto velocity_of = [&](std::int32_t row) -> std::array<double, 3> {
        if (static_cast<std::size_t>(row) < records.count()) return records.start_of_substep(row);
        const Real* record = &records.velocity[4 * static_cast<std::size_t>(row)];  // nothing moves it
        return {record[0], record[1], record[2]};
    };
    const auto a = velocity_of(contact.near), b = velocity_of(contact.far);
    const PathLink<Real>& link = contact.link;
    const std::size_t lane = contact.lane;
    const double along = dot(Vec2{b[0], b[1]} - Vec2{a[0], a[1]}, {link.normal_x[lane], link.normal_y[lane]});
    const auto comes = [&](const Real* near, const Real* far) {
        return along + b[2] * static_cast<double>(far[lane]) - a[2] * static_cast<double>(near[lane]) <
               -speed_of_none(terms);
    };
    return comes(link.near1, link.far1) || comes(link.near2, link.far2);
}

/// Gives a body what an impact gives it, from the start of the substep on: drag takes more of a change then
/// than from its own time.
/// @return J, work of gravity that velocities tell of but the body has not had
template <class Real>
double give(const Meeting<Real>& met, const StruckBody<Real>& body, Vec2 dv, double du,
            BodyRecords<Real>& records) {
    const SubstepTerms& terms = met.terms;
    const double share = met.time / terms.substep_dt, least = std::numeric_limits<double>::min(),
                 left = std::fmax(1 - share * (1 - terms.decay), least),
                 spin_left = std::fmax(1 - share * (1 - terms.spin_decay), least);
    records.add_velocity(body.row, (1 / left) * dv, du / spin_left, terms);
    records.delay(body.row, (1 / left) * dv, du / spin_left, met.time);
    return share / body.w * dot(terms.gravity_change, dv);
}

/// @param note_changed  note_changed(row) is called for each body whose velocity changes
template <class Real, class Fn>
Outcome carry_out_one(const PathContact<Real>& contact, const SubstepTerms& terms, const Bodies<Real>& bodies,
                      BodyRecords<Real>& records, HeldImpacts<Real>& held, Books& books, double& gravity_work,
                      const Fn& note_changed) {
    Meeting<Real> met(contact, terms, bodies, records, held);
    if (const Outcome outcome = met.look(); outcome != Outcome::met) return outcome;
    const bool are_held = held.holds(contact.near) || held.holds(contact.far);
    // The system that answers for what joints hold is that of the substep's start.
    met.go_to_meeting(are_held ? 0 : met.time);
    const StruckBody<Real>&a = met.a, &b = met.b;
    const auto friction = static_cast<double>(contact.link.friction[contact.lane]);
    PointImpulses found;
    if (!are_held || !strike_held(held, a, b, met.n, met.t, met.lever_a, met.lever_b, met.meets,
                                  {contact.restitution, friction, 0}, terms, records, books, gravity_work,
                                  found, note_changed))
        found = met.strike();
    const std::array<double, 2>& x = found.x;
    const double sum = x[0] + x[1], y = found.y;
    const Vec2 impulse = sum * met.n + y * met.t;
    if (!found.is_given && a.w > 0)
        gravity_work -= give(met, a, -a.w * impulse, met.change_of_rim(a, -1, met.lever_a, found), records);
    if (!found.is_given && b.w > 0)
        gravity_work -= give(met, b, b.w * impulse, met.change_of_rim(b, 1, met.lever_b, found), records);
    note_changed(contact.near), note_changed(contact.far);
    if (contact.partner.is_wall()) books.wall_impulse += sum;
    if (!books.is_open) return Outcome::met;
    books.restitution += found.by_normal, books.friction += found.by_friction;
    const bool is_far_moved = b.w > 0, is_near_moved = a.w > 0;
    if (is_far_moved && is_near_moved) return Outcome::met;
    // What nothing moves: the energy that its own motion gives the other body comes from outside.
    const StruckBody<Real>& still = is_far_moved ? a : b;
    const Levers& lever = is_far_moved ? met.lever_a : met.lever_b;
    const Vec2 on_still = is_far_moved ? -impulse : impulse;
    const double spin = (is_far_moved ? -1 : 1) * (lever[0] * x[0] + lever[1] * x[1] + lever[2] * y);
    books.drive -= dot(on_still, still.start) + still.start_rim * spin;
    (contact.partner.is_wall() ? books.wall_momentum : books.immovable_momentum) -= on_still;
    return Outcome::met;
}

}  // namespace

/// Lists the contacts that have restitution, in their order.
template <class Real>
void ShapeImpacts<Real>::list_bouncing(const PathSolver<Real>& paths, std::size_t links) {
    if (is_listed_) return;
    is_listed_ = true;
    bouncing_.clear(), at_place_.assign(kPathLanes * links, -1);
    paths.for_each([&](const PathContact<Real>& contact) {
        if (!(contact.restitution > 0)) return;
        at_place_[paths.place_of(contact)] = static_cast<std::int32_t>(bouncing_.size());
        bouncing_.push_back(contact);
    });
}

/// Lists the contacts of each body. What nothing moves has a row for each contact: nothing that one of them
/// does concerns another one.
template <class Real>
void ShapeImpacts<Real>::list_of_rows(std::size_t rows) {
    if (are_of_rows_listed_) return;
    are_of_rows_listed_ = true;
    first_of_row_.assign(rows + 1, 0);
    const auto for_each_row = [&](const PathContact<Real>& bouncing, const auto& fn) {
        for (const std::int32_t row : {bouncing.near, bouncing.far})
            if (static_cast<std::size_t>(row) < rows) fn(static_cast<std::size_t>(row));
    };
    for (const PathContact<Real>& bouncing : bouncing_)
        for_each_row(bouncing, [&](std::size_t row) { ++first_of_row_[row]; });
    for (std::size_t row = 0; row < rows; ++row) first_of_row_[row + 1] += first_of_row_[row];
    of_row_.resize(first_of_row_[rows]);
    for (std::size_t i = bouncing_.size(); i-- > 0;)
        for_each_row(bouncing_[i],
                     [&](std::size_t row) { of_row_[--first_of_row_[row]] = static_cast<std::uint32_t>(i); });
}

/// Makes those due that come fast as the substep begins, and may meet in it. @return whether there are any,
/// or others that come
template <class Real>
bool ShapeImpacts<Real>::list_fast(PathSolver<Real>& paths, const SubstepTerms& terms,
                                   BodyRecords<Real>& records, const StepLoops<Real>& loops) {
    start_.resize_for_overwrite(records.velocity.size());
    std::copy(records.velocity.begin(), records.velocity.end(), start_.begin());
    const StartColumns<Real> start = records.start_columns();
    for (std::size_t row = 0; row < records.count(); ++row) {
        start_[4 * row] = start.x[row], start_[4 * row + 1] = start.y[row];
        start_[4 * row + 2] = start.rim ? start.rim[row] : Real(0);
    }
    const typename PathSolver<Real>::FastContacts fast = paths.find_fast(
        start_, speed_of_none(terms), speed_of_all(terms), kLightPress, terms, records, loops);
    bool any = false;
    const auto list = [&](std::span<const std::uint32_t> links, Set& set) {
        for (std::size_t link = 0; link < links.size(); ++link)
            for (std::uint32_t left = links[link]; left != 0; left &= left - 1) {
                list_bouncing(paths, links.size());
                const std::size_t lane = static_cast<std::size_t>(std::countr_zero(left));
                const std::int32_t bouncing = at_place_[kPathLanes * link + lane];
                if (bouncing < 0) continue;
                if (!any) due_.clear(bouncing_.size()), coming_.clear(bouncing_.size());
                any = true, set.put(static_cast<std::size_t>(bouncing));
            }
    };
    list(fast.may_meet, due_), list(fast.comes, coming_);
    return any;
}

/// An impact changes what its bodies, and what joints hold them with, meet from then on: other contacts are
/// not looked at again.
template <class Real>
std::int64_t ShapeImpacts<Real>::carry_out(PathSolver<Real>& paths, const SubstepTerms& terms,
                                           const Bodies<Real>& bodies, BodyRecords<Real>& records,
                                           const StepLoops<Real>& loops, HeldImpacts<Real>& held,
                                           Books& books, double& gravity_work) {
    deflected_.clear(), paths.unhide();
    if (!list_fast(paths, terms, records, loops)) return 0;
    const auto note_changed = [&](std::int32_t number) {
        const auto row = static_cast<std::size_t>(number);
        if (row >= records.count()) return;
        list_of_rows(records.count());
        for (std::size_t n = first_of_row_[row]; n < first_of_row_[row + 1]; ++n) due_.put(of_row_[n]);
    };
    std::int64_t impacts = 0;
    bool goes_on = true;
    const auto look_at = [&](std::size_t i) {
        const PathContact<Real>& contact = bouncing_[i];
        due_.take(i), coming_.take(i);
        if (!may_be_fast(contact, terms, records)) return;
        const Outcome outcome =
            carry_out_one(contact, terms, bodies, records, held, books, gravity_work, note_changed);
        if (outcome == Outcome::comes) coming_.put(i);
        if (outcome != Outcome::met) return;
        ++impacts, goes_on = true;
        for (const std::int32_t row : {contact.near, contact.far})
            if (static_cast<std::size_t>(row) < bodies.moving() &&
                bodies.is_disc(static_cast<std::size_t>(row)))
                deflected_.push_back(row);
    };
    for (int round = 0; round < kRoundsOfShapeImpacts && goes_on; ++round) {
        goes_on = false;
        due_.for_each(look_at);
    }
    if (!goes_on)  // else what was seen in the last round no longer holds
        coming_.for_each([&](std::size_t i) { paths.hide(bouncing_[i]); });
    records.put_off_delays();
    return impacts;
}

template <class Real>
std::size_t ShapeImpacts<Real>::bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return of(bouncing_) + of(at_place_) + of(first_of_row_) + of(of_row_) + due_.bytes() + coming_.bytes() +
           start_.bytes() + of(deflected_);
}

template class ShapeImpacts<float>;
template class ShapeImpacts<double>;

}  // namespace carom
