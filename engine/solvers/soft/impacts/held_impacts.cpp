#include "solvers/soft/impacts/held_impacts.hpp"

#include <algorithm>

#include "effects/restitution.hpp"

namespace carom {
namespace {

/// Rounds over the laws of an impact, at most, and the share of the normal impulse below which a change of
/// one is none.
constexpr int kMostRounds = 100;
constexpr double kConverged = 1e-13;
/// Share of the diagonal below which the determinant of two points is that of one.
constexpr double kSingular = 1e-6;

}  // namespace

/// Adds what a unit impulse along a direction changes by way of one of the two bodies.
/// @param sign  1: of b, -1: of a
template <class Real>
void HeldImpacts<Real>::strike(std::size_t direction, std::int32_t row, double inverse_mass, double sign) {
    const auto add = [&](std::int32_t of, const Change& by) {
        auto answer = std::find_if(answers_.begin(), answers_.end(),
                                   [&](const Answer& known) { return known.row == of; });
        if (answer == answers_.end()) answer = answers_.insert(answers_.end(), Answer{of});
        for (std::size_t k = 0; k < by.size(); ++k) answer->by[direction][k] += by[k];
    };
    const Direction& d = directions_[direction];
    const Vec2 impulse = sign * d.impulse;
    const double at_rim = sign < 0 ? d.rim_a : d.rim_b;
    if (DirectJoints<Real>* group = joints_->small_group_of(row))
        return group->answer({row, impulse, at_rim}, JointSystem::Drives::in_a_blow, add);
    const double w = std::fabs(inverse_mass);
    add(row, {w * impulse.x, w * impulse.y, 2 * std::fmax(inverse_mass, 0) * at_rim});
}

/// Adds a body's part to masses_ and velocity_. Half of its mass, at the rim, has its inertia.
template <class Real>
void HeldImpacts<Real>::add_body(Answer& answer, const std::array<double, 4>& record) {
    answer.mass = record[3] != 0 ? 1 / std::fabs(record[3]) : 0;
    const std::array<double, 3> masses{answer.mass, answer.mass, record[3] > 0 ? answer.mass / 2 : 0};
    for (std::size_t i = 0; i < directions_.size(); ++i)
        for (std::size_t k = 0; k < masses.size(); ++k) {
            const double weighted = masses[k] * answer.by[i][k];
            velocity_[i] += weighted * record[k];
            for (std::size_t j = 0; j < directions_.size(); ++j) masses_[i][j] += weighted * answer.by[j][k];
        }
}

template <class Real>
double HeldImpacts<Real>::velocity_after(std::size_t direction) const {
    double v = velocity_[direction];
    for (std::size_t k = 0; k < directions_.size(); ++k) v += masses_[direction][k] * impulses_[k];
    return v;
}

/// Newton's law at one point or at both, which come first among the directions, for the other impulses as
/// they are.
/// @param points  1 or 2
template <class Real>
void HeldImpacts<Real>::solve_normals(std::size_t points, double restitution) {
    const auto wanted = [&](std::size_t i) {  // m/s, that both points are to be given
        return -restitution * std::fmin(velocity_[i], 0) - velocity_after(i);
    };
    impulses_[0] = 0;
    if (points == 1) {
        impulses_[0] = std::fmax(wanted(0) / masses_[0][0], 0);
        return;
    }
    impulses_[1] = 0;
    const double k11 = masses_[0][0], k12 = masses_[0][1], k22 = masses_[1][1], b1 = wanted(0),
                 b2 = wanted(1);
    const double n1 = k22 * b1 - k12 * b2, n2 = k11 * b2 - k12 * b1, determinant = k11 * k22 - k12 * k12;
    // Points that joints let move as one: what one is given the other has, too.
    const bool are_two = determinant > kSingular * k11 * k22;
    if (are_two && n1 >= 0 && n2 >= 0)
        impulses_[0] = n1 / determinant, impulses_[1] = n2 / determinant;
    else if (are_two ? n2 <= 0 : b1 * std::sqrt(k22) >= b2 * std::sqrt(k11))
        impulses_[0] = std::fmax(b1 / k11, 0);
    else
        impulses_[1] = std::fmax(b2 / k22, 0);
}

/// The laws of all directions in turns, until all hold.
template <class Real>
void HeldImpacts<Real>::solve_laws(const Materials& materials, bool has_friction) {
    impulses_ = {};
    std::size_t points = 0;
    while (points < directions_.size() && directions_[points].law == Law::normal) ++points;
    for (int round = 0; round < kMostRounds; ++round) {
        const Values before = impulses_;
        solve_normals(points, materials.restitution);
        const double pressed = impulses_[0] + (points > 1 ? impulses_[1] : 0);
        for (std::size_t i = points; i < directions_.size() && has_friction; ++i) {
            if (!(masses_[i][i] > 0)) continue;
            const double coefficient =
                directions_[i].law == Law::friction ? materials.friction : materials.rolling;
            impulses_[i] = std::clamp(impulses_[i] - velocity_after(i) / masses_[i][i],
                                      -coefficient * pressed, coefficient * pressed);
        }
        double change = 0;
        for (std::size_t i = 0; i < impulses_.size(); ++i)
            change = std::fmax(change, std::fabs(impulses_[i] - before[i]));
        if (points == directions_.size() || change <= kConverged * pressed) break;
    }
}

template <class Real>
double HeldImpacts<Real>::work_of(Law law) const {
    double work = 0;
    for (std::size_t i = 0; i < directions_.size(); ++i)
        if (directions_[i].law == law) work += impact_work(impulses_[i], velocity_[i], velocity_after(i));
    return work;
}

/// @return whether there is an impact
template <class Real>
bool HeldImpacts<Real>::solve_impulses(const Materials& materials) {
    bool comes = false;
    for (std::size_t i = 0; i < directions_.size() && directions_[i].law == Law::normal; ++i)
        comes = comes || velocity_[i] < 0;
    if (!comes) return false;
    solve_laws(materials, true);
    // Where joints couple the normal to the tangent these laws together can give energy (Kane 1984): then
    // there is no friction.
    if (work_of(Law::friction) + work_of(Law::rolling) > 0 || work_of(Law::normal) > 0)
        solve_laws(materials, false);
    return true;
}

/// What joints give in answer to the whole impact, to their forces.
template <class Real>
void HeldImpacts<Real>::note_forces(std::int32_t row, double sign) {
    DirectJoints<Real>* group = row == kNothing ? nullptr : joints_->small_group_of(row);
    if (!group) return;
    Vec2 impulse;
    double at_rim = 0;
    for (std::size_t i = 0; i < directions_.size(); ++i) {
        const Direction& d = directions_[i];
        impulse += (sign * impulses_[i]) * d.impulse, at_rim += impulses_[i] * (sign < 0 ? d.rim_a : d.rim_b);
    }
    group->answer({row, impulse, at_rim}, JointSystem::Drives::in_a_blow, [](std::int32_t, const Change&) {});
    group->note_answer();
}

template class HeldImpacts<float>;
template class HeldImpacts<double>;

}  // namespace carom
