#include "solvers/manifolds/finders/gaps.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "solvers/manifolds/meetings/meeting.hpp"

namespace carom {
namespace {

/// Share of how far a shape reaches by which a gap may be off through rounding.
template <class Real>
constexpr double kRoundingOfGaps = 16 * static_cast<double>(std::numeric_limits<Real>::epsilon());

/// Bodies with a gap of more than so many times the sum of their radii are far apart: of all that is so far
/// away in a crowd whose bodies fly a hundred sizes in a step, each could be in the way of each.
constexpr double kFar = 4;

}  // namespace

/// Bodies that do not touch yet may meet elsewhere than where they face each other (meeting.hpp), or not at
/// all in this step, whatever becomes of them: those contacts are left out.
///
/// Most of a crowd touch, or stand beside each other: a kernel tells the others from these.
template <class Real>
void Gaps<Real>::look_at(std::size_t first, std::size_t last) {
    static_assert(QuestionGaps<Real>::kContacts == kRowPadding);
    std::uint32_t left = in_.kernels.question_gaps(arguments(), first);
    // The kernel takes bodies to fly as they do: what is held flies otherwise, beside what stands.
    if (in_.flights.hold_any())
        for (std::size_t i = first; i < last; ++i)
            if (in_.world.bodies.stands(static_cast<std::size_t>(contacts_.b[i]))) left |= 1u << (i - first);
    if (last - first < kRowPadding) left &= (1u << (last - first)) - 1;
    for (; left != 0; left &= left - 1) look_at_one(first + static_cast<std::size_t>(std::countr_zero(left)));
}

template <class Real>
QuestionGaps<Real> Gaps<Real>::arguments() const {
    const Bodies<Real>& bodies = in_.world.bodies;
    const auto real = [](double value) { return static_cast<Real>(value); };
    return {contacts_.a.data(),
            contacts_.b.data(),
            bodies.velocity_x.data(),
            bodies.velocity_y.data(),
            bodies.has_rotation ? bodies.angular_velocity.data() : nullptr,
            bodies.radius.data(),
            bodies.radius.uniform_value(),
            contacts_.thickness.data(),
            contacts_.restitution.data(),
            contacts_.columns(),
            real(in_.dt),
            real(in_.near.share),
            real(in_.near.fall),
            real(kBeside),
            real(kFastThicknesses),
            real(kPassing),
            real(kFar)};
}

template <class Real>
void Gaps<Real>::look_at_one(std::size_t i) {
    const auto none = static_cast<Real>(kNoPoint);
    const Real gap = std::min(contacts_.separation1[i], contacts_.separation2[i]);
    if (are_corners_beside(i)) contacts_.separation1[i] = none;
    if (!(gap > 0) || !(contacts_.separation1[i] < none)) return;
    if (are_far_apart(i, gap) && !may_come_together(i)) {
        contacts_.separation1[i] = contacts_.separation2[i] = none;
        return;
    }
    const Manifold<double> facing = contacts_.manifold(i);
    const bool may_touch = find_meeting(i, static_cast<double>(gap)) || can_close(i);
    if (!may_touch || do_pass(i, facing)) contacts_.separation1[i] = contacts_.separation2[i] = none;
}

template <class Real>
bool Gaps<Real>::are_far_apart(std::size_t i, Real gap) const {
    const auto radius = [&](std::int32_t row) {
        return in_.world.bodies.radius[static_cast<std::size_t>(row)];
    };
    return gap > static_cast<Real>(kFar) * (radius(contacts_.a[i]) + radius(contacts_.b[i]));
}

/// Whether the discs around two bodies come together in the step if both keep their velocities or either of
/// them is stopped. One that something throws elsewhere may still hit the other, far from where it was: the
/// next step sees that.
template <class Real>
bool Gaps<Real>::may_come_together(std::size_t i) const {
    const Bodies<Real>& bodies = in_.world.bodies;
    const auto a = static_cast<std::size_t>(contacts_.a[i]), b = static_cast<std::size_t>(contacts_.b[i]);
    const Vec2 apart =
        Vec2{bodies.position_x[b], bodies.position_y[b]} - Vec2{bodies.position_x[a], bodies.position_y[a]};
    const double reach = static_cast<double>(bodies.radius[a]) + static_cast<double>(bodies.radius[b]) +
                         in_.near(static_cast<double>(contacts_.thickness[i])) +
                         static_cast<double>(in_.poses.way_of_motors(a, b));
    const auto meet_at = [&](Vec2 velocity) {
        const double closing = -dot(apart, velocity), squared = length_squared(velocity);
        if (!(closing > 0)) return false;
        const double time = std::fmin(in_.dt, closing / squared);
        return length_squared(apart + time * velocity) <= reach * reach;
    };
    const Vec2 of_a = velocity_of_a(i), of_b = velocity_of_b(i);
    return meet_at(of_b - of_a) || meet_at(of_b) || meet_at(-1.0 * of_a);
}

template <class Real>
bool Gaps<Real>::holds(std::size_t i) const {
    const Bodies<Real>& bodies = in_.world.bodies;
    const auto a = static_cast<std::size_t>(contacts_.a[i]), b = static_cast<std::size_t>(contacts_.b[i]);
    if (!bodies.stands(b)) return false;
    const Vec2 normal{contacts_.normal_x[i], contacts_.normal_y[i]},
        velocity{bodies.velocity_x[a], bodies.velocity_y[a]};
    const double gap = std::min(contacts_.separation1[i], contacts_.separation2[i]),
                 thickness = contacts_.thickness[i];
    return HeldFlights<Real>::comes_into(velocity, normal, gap, thickness, in_.dt) &&
           meets_face(flying_a(i), flying_b(i), normal, in_.dt, gap, thickness);
}

/// Whether a contact is one of a corner beside a corner. Only contacts of one point between shapes with sharp
/// corners are looked at, which are few.
template <class Real>
bool Gaps<Real>::are_corners_beside(std::size_t i) const {
    const auto none = static_cast<Real>(kNoPoint);
    if (contacts_.separation2[i] < none ||
        !(std::fabs(contacts_.separation1[i]) <= static_cast<Real>(kBeside) * contacts_.thickness[i]))
        return false;
    const WorldState<Real>& world = in_.world;
    const auto a = static_cast<std::size_t>(contacts_.a[i]), b = static_cast<std::size_t>(contacts_.b[i]);
    const std::int32_t of_a = shape_of(a, contacts_.item_a, i), of_b = shape_of(b, contacts_.item_b, i);
    if (world.shapes[of_a].radius > 0 || world.shapes[of_b].radius > 0) return false;
    return are_beside(flying_a(i), flying_b(i), contacts_.manifold(i), in_.dt,
                      static_cast<double>(contacts_.thickness[i]));
}

/// Whether the line that was found across the gap parts the bodies all through the step, as they fly: then
/// they do not meet, which meeting_manifold() takes ten times as long to find.
template <class Real>
bool Gaps<Real>::stay_parted(std::size_t i) const {
    const WorldState<Real>& world = in_.world;
    const Bodies<Real>& bodies = world.bodies;
    const Vec2 normal{contacts_.normal_x[i], contacts_.normal_y[i]};
    double gap = -kMeetingTarget * static_cast<double>(contacts_.thickness[i]);  // m, now, beyond the target
    double opening = 0;                                                          // m/s, at least
    const auto add = [&](std::size_t row, const Column<std::int32_t>& items, double side) {
        const ConvexShape<Real>& shape = world.shapes[shape_of(row, items, i)];
        const Real* pose = &in_.poses.pose[4 * row];
        const auto extent = static_cast<double>(shape.extent);
        const double reach = reach_along(shape, {pose[2], pose[3]}, -side * normal),
                     spin = bodies.has_rotation ? static_cast<double>(bodies.angular_velocity[row]) : 0;
        gap += side * dot({pose[0], pose[1]}, normal) - reach - kRoundingOfGaps<Real> * extent;
        opening +=
            side * dot({bodies.velocity_x[row], bodies.velocity_y[row]}, normal) - std::fabs(spin) * extent;
    };
    add(static_cast<std::size_t>(contacts_.a[i]), contacts_.item_a, -1);
    add(static_cast<std::size_t>(contacts_.b[i]), contacts_.item_b, 1);
    return gap > 0 && gap + in_.dt * opening > 0;
}

/// Whether the bodies pass each other in the step.
/// @param facing  how they face each other at its start
template <class Real>
bool Gaps<Real>::do_pass(std::size_t i, const Manifold<double>& facing) const {
    const double thickness = contacts_.thickness[i];
    const RelativeMotion motion{velocity_of_b(i) - velocity_of_a(i), spin_of(contacts_.a[i]),
                                spin_of(contacts_.b[i])};
    // Most planes hold nothing back, which is known without the shapes.
    return pass_plane(facing, motion, in_.dt, thickness) &&
           pass_each_other(flying_a(i), flying_b(i), facing, in_.dt, thickness);
}

/// @return whether the bodies meet later than at once
template <class Real>
bool Gaps<Real>::find_meeting(std::size_t i, double gap) {
    const Bodies<Real>& bodies = in_.world.bodies;
    const auto a = static_cast<std::size_t>(contacts_.a[i]), b = static_cast<std::size_t>(contacts_.b[i]);
    const Vec2 dv = velocity_of_b(i) - velocity_of_a(i);
    const double way =
        in_.dt * (std::sqrt(length_squared(dv)) + std::fabs(spin_of(contacts_.a[i])) * bodies.radius[a] +
                  std::fabs(spin_of(contacts_.b[i])) * bodies.radius[b]);
    const double thickness = contacts_.thickness[i];
    if (!(way > kFastThicknesses * thickness) || !(way > gap)) return false;
    if (stay_parted(i)) return false;
    Manifold<double> met{};
    const bool meets = meeting_manifold(flying_a(i), flying_b(i), in_.dt, thickness, met);
    if (meets) contacts_.set_manifold(i, met);
    return meets;
}

/// Whether a gap may close in the step. What flies may keep its velocity, be stopped or come back with its
/// restitution: a contact of two bodies that fly side by side counts only once one of them may be stopped.
template <class Real>
bool Gaps<Real>::can_close(std::size_t i) const {
    const WorldState<Real>& world = in_.world;
    const Bodies<Real>& bodies = world.bodies;
    const auto a = static_cast<std::size_t>(contacts_.a[i]), b = static_cast<std::size_t>(contacts_.b[i]);
    const Real nx = contacts_.normal_x[i], ny = contacts_.normal_y[i], e = contacts_.restitution[i];
    const Real va = bodies.velocity_x[a] * nx + bodies.velocity_y[a] * ny,
               vb = bodies.velocity_x[b] * nx + bodies.velocity_y[b] * ny;
    const Real wa = bodies.has_rotation ? bodies.angular_velocity[a] : Real(0),
               wb = bodies.has_rotation ? bodies.angular_velocity[b] : Real(0);
    const auto towards = [&](Real speed) { return std::max(speed, -e * speed); };
    const Real reach = static_cast<Real>(in_.near(static_cast<double>(contacts_.thickness[i]))) +
                       in_.poses.way_of_motors(a, b);
    const auto closes = [&](Real separation, Real lever_a, Real lever_b) {
        return separation <=
               reach + static_cast<Real>(in_.dt) * (towards(va + wa * lever_a) + towards(-vb - wb * lever_b));
    };
    return closes(contacts_.separation1[i], contacts_.lever_a1[i], contacts_.lever_b1[i]) ||
           closes(contacts_.separation2[i], contacts_.lever_a2[i], contacts_.lever_b2[i]);
}

template class Gaps<float>;
template class Gaps<double>;

}  // namespace carom
