#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "kernels/contacts/contact_arguments.hpp"
#include "math/vec2_math.hpp"
#include "state/world_state.hpp"

namespace carom {

/// The bodies of a substep whose contacts are solved, before they move.
template <class Real>
struct SubstepBodies {
    std::size_t count;         ///< rows below it have records, those beyond sleep
    const Real* origin;        ///< [rows][4]: x, y [m] at the start of the step, and two numbers more
    Real* velocity;            ///< [rows][4], at the end of the substep
    StartColumns<Real> start;  ///< velocities at the start of the substep
    Real* displacement;        ///< [rows][2], m, until the start of the substep
    Real* turn;                ///< m, at the rim, until the start of the substep; null without rotation
    double h, elapsed;         ///< s: the substep's length, and the step's time at its start
    Real gain_x, gain_y;       ///< m/s, what gravity adds in a substep
    Real decay, spin_decay;    ///< what drag leaves in a substep
};

/// What a substep does to a velocity [m/s].
template <class Real>
struct VelocityChange {
    Real x, y;            ///< with contacts
    Real fall_x, fall_y;  ///< without

    /// Whether the body goes by the mean of its velocities; else by that of the end.
    bool is_smooth() const { return x * x + y * y <= (fall_x * fall_x + fall_y * fall_y) * Real(1.0001); }
};

/// How a body moves through a substep: by what kernels/contacts/advance_bodies.hpp will move it. A cache
/// line.
struct alignas(64) Mover {
    Vec2 x, v, acceleration;    // m, m/s, m/s², at the start of the substep
    double radius = 0;          // m
    std::uint32_t impacts = 0;  // ever: what was foreseen with another number is void
    std::uint32_t substep = 0;  // for which this holds

    Vec2 position_at(double t) const { return x + t * v + (0.5 * t * t) * acceleration; }
    Vec2 velocity_at(double t) const { return v + t * acceleration; }
};
/// Speed below which the approach of two surfaces is round-off [m/s].
template <class Real>
double noise_of(Vec2 a, Vec2 b) {
    constexpr double kUnits = 8;  // in the last place, of the speeds that are subtracted
    return kUnits * std::numeric_limits<Real>::epsilon() *
           (std::fabs(a.x) + std::fabs(a.y) + std::fabs(b.x) + std::fabs(b.y));
}

/// The paths of bodies through a substep, and how an impact changes them (impacts.hpp). The records of the
/// bodies are the state; what is kept here is read from them when it is asked for.
template <class Real>
class ImpactPaths {
  public:
    /// Forgets the paths of the substep before.
    /// @param joined  [rows], above zero for bodies that have joints; null where there are none
    /// @param gravity  m/s², as drag lets it act
    void begin_substep(const WorldState<Real>& world, const SubstepBodies<Real>& bodies, const Real* joined,
                       Vec2 gravity);

    /// The path of a body that is awake.
    const Mover& of(std::int32_t row);
    /// The path of any body: one that sleeps has no record, and stands.
    Mover of_any(std::int32_t row);
    /// How far a body has moved since the start of the step [m], at a time in the substep.
    Vec2 displacement_of(std::int32_t row, double time);
    /// Impacts that a body has had, ever: what was foreseen with another number is void.
    std::uint32_t impacts_of(std::int32_t row) const {
        return movers_[static_cast<std::size_t>(row)].impacts;
    }

    /// Its velocity record at a time in the substep; zeros if it sleeps. A body that joints hold moves
    /// straight, with the velocity of the middle of the substep (direct_joints.hpp), one that contacts push
    /// with that of its end: before it lacks what gravity gives until then, or an impact would turn this,
    /// too, and a body that bounces would gain its weight times the way that it makes in the rest of the
    /// substep.
    std::array<double, 4> record_of(std::int32_t row, const Mover& mover, double time) const;
    /// Gives a body its new velocity at a time in the substep: the records are of the substep's end, and the
    /// displacement makes up for the time in which the body did not have it yet.
    /// @param added  m/s: vx, vy, rim speed
    /// @return J, what gravity does to the velocity that was added until the end of the substep, or until its
    /// middle
    double change(std::int32_t row, const std::array<double, 3>& added, double time);

    std::size_t bytes() const { return movers_.capacity() * sizeof(Mover); }

  private:
    Mover path_of(std::size_t row) const;
    VelocityChange<Real> change_of(std::size_t row) const;
    /// Whether a body that has no joints moves by its velocity at the end of the substep.
    bool goes_straight(std::size_t row) const {
        return bodies_->velocity[4 * row + 3] != 0 && !change_of(row).is_smooth();
    }
    bool is_joined(std::size_t row) const { return joined_ && joined_[row] > 0; }

    const WorldState<Real>* world_ = nullptr;
    const SubstepBodies<Real>* bodies_ = nullptr;
    const Real* joined_ = nullptr;
    Vec2 gravity_;
    std::vector<Mover> movers_;
    std::uint32_t substep_ = 0;
};

extern template class ImpactPaths<float>;
extern template class ImpactPaths<double>;

}  // namespace carom
