#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec2_math.hpp"
#include "solvers/soft/joints/soft_joints.hpp"

namespace carom {

/// The row of what nothing moves.
inline constexpr std::int32_t kNothing = -1;

/// Share of the impulse that would stop two bodies above which the impulse that a contact had in a substep
/// [N s / N s] presses it: it stays a contact. Below, what comes is a blow, and the force of before nothing
/// beside it. A tenth: a force of the weight of a few bodies, at speeds that are no rest.
inline constexpr double kLightPress = 0.1;

/// Impacts of bodies that joints hold.
///
/// A blow on a body that hangs on joints is answered by all of its group at once. The impact of two free
/// bodies would give it a velocity that its joints take back afterwards, and with it energy: a cradle whose
/// balls meet a little beside their lowest points lost half of its energy in 20 s.
///
/// A unit impulse along each direction of the contact, its normal at each point, its tangent, its rolling,
/// changes the velocities of all bodies concerned by a field R_i that the joints allow. The impact is that of
/// these fields alone: with the masses M of the bodies, K_ij = R_i·M R_j is the contact's inverse mass and
/// u_i = R_i·M v its velocity, and the impulses j follow from the laws of Newton, Coulomb and rolling
/// resistance for K and u. They change the kinetic energy by exactly j·(u + K j / 2), which is restitution
/// and friction; joints do no work of their own. u is the velocity with what joints do not allow taken out:
/// in a substep paths are chords, so it may differ from the velocity of the surfaces in the first order of
/// the substep.
///
/// Cost: about .3 us a joint and direction. Source: docs/decisions/0059-impacts-on-joints.md.
template <class Real>
class HeldImpacts {
  public:
    static constexpr std::size_t kMostDirections = 3;
    using Values = std::array<double, kMostDirections>;  // by direction
    using Change = std::array<double, 3>;                // m/s: vx, vy, rim speed

    enum class Law : std::uint8_t {
        normal,    ///< pushes only, and leaves at restitution times the speed it came with
        friction,  ///< stops, with at most friction times the normal impulses
        rolling,   ///< stops, with at most its coefficient times the normal impulses
    };
    /// A direction of a contact: what a unit impulse gives its bodies.
    struct Direction {
        Law law;
        Vec2 impulse;         // on b, and minus that on a
        double rim_a, rim_b;  // what their rims are given: effects/contact_law.hpp
        double surface;       // m/s, velocity along it of what nothing moves; 0 where both can be moved
    };
    /// Two bodies by their rows; one of them may be kNothing.
    struct Pair {
        std::int32_t a, b;
    };
    struct Materials {
        double restitution, friction, rolling;
    };

    /// The world has no joints as far as is known.
    void begin_step() { joints_ = nullptr; }
    void begin_joints(SoftJoints<Real>& joints) { joints_ = &joints; }
    /// [rows], above zero for bodies that have joints; null where there are none.
    const Real* joined() const { return joints_ ? joints_->joined() : nullptr; }
    bool holds(std::int32_t row) const { return joints_of(row) > 0; }
    /// How many joints answer a blow on a body; 0: it is that of a free body.
    std::size_t joints_of(std::int32_t row) const {
        const DirectJoints<Real>* group = joints_ ? joints_->small_group_of(row) : nullptr;
        return group ? group->joints() : 0;
    }

    /// Finds the impulses of an impact of bodies of which joints hold one at least.
    /// @param directions  normals first
    /// @param record_of  fn(row): a body's velocity record at the moment: vx, vy, rim speed, inverse mass
    /// with a sign
    /// @return whether bodies come to each other along what joints allow, and with hardly any velocity that
    /// these do not; if not, nothing is found
    template <class RecordOf>
    bool solve(Pair bodies, std::span<const Direction> directions, const Materials& materials,
               const RecordOf& record_of) {
        bodies_ = bodies, directions_.assign(directions.begin(), directions.end());
        answers_.clear(), masses_ = {}, velocity_ = {};
        for (std::size_t i = 0; i < directions_.size(); ++i) {
            velocity_[i] = directions_[i].surface;
            if (bodies.a != kNothing) strike(i, bodies.a, record_of(bodies.a)[3], -1);
            if (bodies.b != kNothing) strike(i, bodies.b, record_of(bodies.b)[3], 1);
        }
        for (Answer& answer : answers_) add_body(answer, record_of(answer.row));
        double free = 0;  // 1/kg, what bodies answer with that no joint holds
        for (const std::int32_t row : {bodies.a, bodies.b})
            if (row != kNothing) free += std::fabs(record_of(row)[3]);
        for (std::size_t i = 0; i < directions_.size(); ++i) {
            const Direction& d = directions_[i];
            if (d.law != Law::normal) continue;
            if (!(masses_[i][i] > kLeastAnswer * free)) return false;
            double surfaces = d.surface;
            if (bodies.a != kNothing) surfaces += part_of(d, record_of(bodies.a), -1, d.rim_a);
            if (bodies.b != kNothing) surfaces += part_of(d, record_of(bodies.b), 1, d.rim_b);
            if (std::fabs(velocity_[i] - surfaces) > kLargestLack * std::fabs(surfaces)) return false;
        }
        return solve_impulses(materials);
    }
    const Values& impulses() const { return impulses_; }  ///< N s
    /// J, the work of the impulses that follow a law.
    double work_of(Law law) const;
    /// The impact takes place.
    /// @param fn  fn(row, Change) is called for each body concerned
    /// @return N s, that joints have taken up from what nothing moves
    template <class Fn>
    Vec2 carry_out(const Fn& fn) {
        note_forces(bodies_.a, -1), note_forces(bodies_.b, 1);
        Vec2 momentum;
        for (const Answer& answer : answers_) {
            Change by{};
            for (std::size_t i = 0; i < directions_.size(); ++i)
                for (std::size_t k = 0; k < by.size(); ++k) by[k] += impulses_[i] * answer.by[i][k];
            momentum += answer.mass * Vec2{by[0], by[1]};
            fn(answer.row, by);
        }
        for (std::size_t i = 0; i < directions_.size(); ++i) {
            if (bodies_.a == kNothing) momentum -= impulses_[i] * directions_[i].impulse;
            if (bodies_.b == kNothing) momentum += impulses_[i] * directions_[i].impulse;
        }
        return momentum;
    }

    std::size_t bytes() const {
        return answers_.capacity() * sizeof(Answer) + directions_.capacity() * sizeof(Direction);
    }

  private:
    /// A body that an impact concerns, and what unit impulses change it by.
    struct Answer {
        std::int32_t row;
        double mass = 0;  // kg
        std::array<Change, kMostDirections> by{};
    };

    /// Share of the velocity of surfaces that joints may not allow. Where they allow less the group is in the
    /// midst of a crowd, and joints and contacts are not solved yet: energy would go round between them.
    static constexpr double kLargestLack = 0.1;
    /// Share of what free bodies would answer with below which joints let nothing move: it is the round-off
    /// of bodies that are held from two sides, and a moving surface would be answered by any impulse.
    static constexpr double kLeastAnswer = 1e-9;
    /// A body's part in the velocity along a direction [m/s].
    static double part_of(const Direction& d, const std::array<double, 4>& record, double sign, double rim) {
        return sign * dot(d.impulse, Vec2{record[0], record[1]}) + rim * record[2];
    }
    void strike(std::size_t direction, std::int32_t row, double inverse_mass, double sign);
    void add_body(Answer& answer, const std::array<double, 4>& record);
    double velocity_after(std::size_t direction) const;
    double coefficient_of(std::size_t direction, const Materials& materials) const {
        return directions_[direction].law == Law::friction ? materials.friction : materials.rolling;
    }
    /// Which of its laws' cases each direction is in. Normals: 1 pushes, 0 lets go. Others: 0 sticks, 1 and
    /// -1 slide, with an impulse of that sign.
    using Cases = std::array<int, kMostDirections>;
    bool solve_case(const Materials& materials, std::size_t points, std::size_t count, const Cases& cases);
    bool find_case(const Materials& materials, std::size_t points, std::size_t count);
    void solve_normals(std::size_t points, double restitution);
    void solve_laws(const Materials& materials, bool has_friction);
    bool solve_impulses(const Materials& materials);
    void note_forces(std::int32_t row, double sign);

    SoftJoints<Real>* joints_ = nullptr;
    Pair bodies_{kNothing, kNothing};
    std::vector<Direction> directions_;
    std::vector<Answer> answers_;
    std::array<Values, kMostDirections> masses_{};  // 1/kg: inverse masses
    Values velocity_{}, impulses_{};                // m/s, N s
};

extern template class HeldImpacts<float>;
extern template class HeldImpacts<double>;

}  // namespace carom
