// Contacts of two bodies with a gap between them: where they meet, if they do, and whether they can in the
// step.
#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/manifolds/manifolds.hpp"
#include "solvers/manifolds/meeting.hpp"

namespace carom {
namespace {

/// Share of how far a shape reaches by which a gap may be off through rounding.
template <class Real>
constexpr double kRoundingOfGaps = 16 * static_cast<double>(std::numeric_limits<Real>::epsilon());

}  // namespace

/// Bodies that do not touch yet may meet elsewhere than where they face each other (meeting.hpp), or not at
/// all in this step, whatever becomes of them: those contacts are left out.
template <class Real>
void Manifolds<Real>::look_at_gaps(const WorldState<Real>& world, double dt, const ContactDistance& near,
                                   std::size_t first, std::size_t last) {
    const auto none = static_cast<Real>(kNoPoint);
    for (std::size_t i = first; i < last; ++i) {
        const Real gap = std::min(bodies_.separation1[i], bodies_.separation2[i]);
        if (!(gap > 0) || !(gap < none)) continue;
        if (!find_meeting(world, dt, i, static_cast<double>(gap)) && !can_close(world, dt, near, i))
            bodies_.separation1[i] = bodies_.separation2[i] = none;
    }
}

/// Whether the line that was found across the gap parts the bodies all through the step, as they fly: then
/// they do not meet, which meeting_manifold() takes ten times as long to find.
template <class Real>
bool Manifolds<Real>::stay_parted(const WorldState<Real>& world, double dt, std::size_t i) const {
    const Bodies<Real>& bodies = world.bodies;
    const Vec2 normal{bodies_.normal_x[i], bodies_.normal_y[i]};
    double gap = -kMeetingTarget * static_cast<double>(bodies_.thickness[i]);  // m, now, beyond the target
    double opening = 0;                                                        // m/s, at least
    const auto add = [&](std::int32_t number, const Column<std::int32_t>& items, double side) {
        const auto row = static_cast<std::size_t>(number);
        const ConvexShape<Real>& shape =
            world.shapes[shape_of_item(world, row, items_.empty() ? number : items[i])];
        const Real* pose = &poses_.pose[4 * row];
        const auto extent = static_cast<double>(shape.extent);
        const double reach = reach_along(shape, {pose[2], pose[3]}, -side * normal),
                     spin = bodies.has_rotation ? static_cast<double>(bodies.angular_velocity[row]) : 0;
        gap += side * dot({pose[0], pose[1]}, normal) - reach - kRoundingOfGaps<Real> * extent;
        opening +=
            side * dot({bodies.velocity_x[row], bodies.velocity_y[row]}, normal) - std::fabs(spin) * extent;
    };
    add(bodies_.a[i], bodies_.item_a, -1), add(bodies_.b[i], bodies_.item_b, 1);
    return gap > 0 && gap + dt * opening > 0;
}

/// @return whether the bodies meet later than at once
template <class Real>
bool Manifolds<Real>::find_meeting(const WorldState<Real>& world, double dt, std::size_t i, double gap) {
    const Bodies<Real>& bodies = world.bodies;
    const auto turns = [&](std::size_t row) {
        return bodies.has_rotation ? static_cast<double>(bodies.angular_velocity[row]) : 0;
    };
    const auto a = static_cast<std::size_t>(bodies_.a[i]), b = static_cast<std::size_t>(bodies_.b[i]);
    const Vec2 dv{static_cast<double>(bodies.velocity_x[b]) - static_cast<double>(bodies.velocity_x[a]),
                  static_cast<double>(bodies.velocity_y[b]) - static_cast<double>(bodies.velocity_y[a])};
    const double way = dt * (std::sqrt(length_squared(dv)) + std::fabs(turns(a)) * bodies.radius[a] +
                             std::fabs(turns(b)) * bodies.radius[b]);
    const double thickness = bodies_.thickness[i];
    if (!(way > kFastThicknesses * thickness) || !(way > gap)) return false;
    if (stay_parted(world, dt, i)) return false;
    Manifold<double> met{};
    const auto moving = [&](std::size_t row, const Column<std::int32_t>& items) {
        if (items_.empty()) return moving_row(world, row, bodies.shape[row]);
        return moving_row(world, row, shape_of(world, static_cast<std::int32_t>(row), items[i]));
    };
    const bool meets =
        meeting_manifold(moving(a, bodies_.item_a), moving(b, bodies_.item_b), dt, thickness, met);
    if (meets) bodies_.set_manifold(i, met);
    return meets;
}

/// Whether a gap may close in the step. What flies may keep its velocity, be stopped or come back with its
/// restitution: a contact of two bodies that fly side by side counts only once one of them may be stopped.
template <class Real>
bool Manifolds<Real>::can_close(const WorldState<Real>& world, double dt, const ContactDistance& near,
                                std::size_t i) const {
    const Bodies<Real>& bodies = world.bodies;
    const auto a = static_cast<std::size_t>(bodies_.a[i]), b = static_cast<std::size_t>(bodies_.b[i]);
    const Real nx = bodies_.normal_x[i], ny = bodies_.normal_y[i], e = bodies_.restitution[i];
    const Real va = bodies.velocity_x[a] * nx + bodies.velocity_y[a] * ny,
               vb = bodies.velocity_x[b] * nx + bodies.velocity_y[b] * ny;
    const Real wa = bodies.has_rotation ? bodies.angular_velocity[a] : Real(0),
               wb = bodies.has_rotation ? bodies.angular_velocity[b] : Real(0);
    const auto towards = [&](Real speed) { return std::max(speed, -e * speed); };
    const auto reach = static_cast<Real>(near(static_cast<double>(bodies_.thickness[i])));
    const auto closes = [&](Real separation, Real lever_a, Real lever_b) {
        return separation <=
               reach + static_cast<Real>(dt) * (towards(va + wa * lever_a) + towards(-vb - wb * lever_b));
    };
    return closes(bodies_.separation1[i], bodies_.lever_a1[i], bodies_.lever_b1[i]) ||
           closes(bodies_.separation2[i], bodies_.lever_a2[i], bodies_.lever_b2[i]);
}

template void Manifolds<float>::look_at_gaps(const WorldState<float>&, double, const ContactDistance&,
                                             std::size_t, std::size_t);
template bool Manifolds<float>::stay_parted(const WorldState<float>&, double, std::size_t) const;
template bool Manifolds<float>::find_meeting(const WorldState<float>&, double, std::size_t, double);
template bool Manifolds<float>::can_close(const WorldState<float>&, double, const ContactDistance&,
                                          std::size_t) const;
template void Manifolds<double>::look_at_gaps(const WorldState<double>&, double, const ContactDistance&,
                                              std::size_t, std::size_t);
template bool Manifolds<double>::stay_parted(const WorldState<double>&, double, std::size_t) const;
template bool Manifolds<double>::find_meeting(const WorldState<double>&, double, std::size_t, double);
template bool Manifolds<double>::can_close(const WorldState<double>&, double, const ContactDistance&,
                                           std::size_t) const;

}  // namespace carom
