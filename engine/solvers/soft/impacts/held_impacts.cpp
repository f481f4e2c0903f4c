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

/// The impulses of one case of the laws, which is linear: what pushes leaves as Newton's law says, what
/// sticks stops, what slides has what Coulomb's law allows.
/// @param points, count  directions that are normals, and all of them
/// @return whether the laws hold so; if not, the impulses say nothing
template <class Real>
bool HeldImpacts<Real>::solve_case(const Materials& materials, std::size_t points, std::size_t count,
                                   const Cases& cases) {
    const auto slides = [&](std::size_t i) { return i >= points && cases[i] != 0; };
    const auto wanted = [&](std::size_t i) {  // m/s, velocity afterwards
        return i < points ? -materials.restitution * std::fmin(velocity_[i], 0) : 0;
    };
    std::array<std::size_t, kMostDirections> asked{};  // directions whose impulses are unknown
    std::size_t unknowns = 0;
    for (std::size_t i = 0; i < count; ++i)
        if (i < points ? cases[i] == 1 : !slides(i)) asked[unknowns++] = i;
    // What slides has a share of the normal impulses: it is in the columns of these.
    std::array<std::array<double, kMostDirections + 1>, kMostDirections> m{};
    for (std::size_t r = 0; r < unknowns; ++r) {
        const std::size_t i = asked[r];
        for (std::size_t c = 0; c < unknowns; ++c) {
            m[r][c] = masses_[i][asked[c]];
            for (std::size_t k = points; k < count && asked[c] < points; ++k)
                m[r][c] += cases[k] * coefficient_of(k, materials) * masses_[i][k];
        }
        m[r][unknowns] = wanted(i) - velocity_[i];
    }
    for (std::size_t r = 0; r < unknowns; ++r) {
        if (!(m[r][r] > kSingular * masses_[asked[r]][asked[r]])) return false;
        for (std::size_t below = r + 1; below < unknowns; ++below) {
            const double share = m[below][r] / m[r][r];
            for (std::size_t c = r; c <= unknowns; ++c) m[below][c] -= share * m[r][c];
        }
    }
    impulses_ = {};
    for (std::size_t r = unknowns; r-- > 0;) {
        double left = m[r][unknowns];
        for (std::size_t c = r + 1; c < unknowns; ++c) left -= m[r][c] * impulses_[asked[c]];
        impulses_[asked[r]] = left / m[r][r];
    }
    double pressed = 0, speed = 0;  // N s, m/s
    for (std::size_t i = 0; i < points; ++i) pressed += impulses_[i];
    for (std::size_t i = points; i < count; ++i)
        if (slides(i)) impulses_[i] = cases[i] * coefficient_of(i, materials) * pressed;
    for (std::size_t i = 0; i < count; ++i) speed = std::fmax(speed, std::fabs(velocity_[i]));
    const double noise = kConverged * speed;
    for (std::size_t i = 0; i < count; ++i) {
        if (i < points
                ? !(impulses_[i] >= 0)
                : !(std::fabs(impulses_[i]) <= (1 + kConverged) * coefficient_of(i, materials) * pressed))
            return false;
        if (i < points && cases[i] == 0 && !(velocity_after(i) >= wanted(i) - noise)) return false;
        if (slides(i) && !(cases[i] * velocity_after(i) <= noise)) return false;
    }
    return true;
}

/// Looks for the case in which the laws hold: all that touches pushes and nothing slides, to begin with.
template <class Real>
bool HeldImpacts<Real>::find_case(const Materials& materials, std::size_t points, std::size_t count) {
    constexpr std::array<int, 3> kOfRough{0, 1, -1};
    constexpr std::array<std::array<int, 2>, 3> kOfPoints{{{1, 1}, {1, 0}, {0, 1}}};
    const std::size_t rough = count - points;
    for (std::size_t p = 0; p < (points > 1 ? kOfPoints.size() : 1); ++p)
        for (std::size_t first = 0; first < (rough > 0 ? kOfRough.size() : 1); ++first)
            for (std::size_t second = 0; second < (rough > 1 ? kOfRough.size() : 1); ++second) {
                Cases cases{};
                for (std::size_t i = 0; i < points; ++i) cases[i] = kOfPoints[p][i];
                if (rough > 0) cases[points] = kOfRough[first];
                if (rough > 1) cases[points + 1] = kOfRough[second];
                if (solve_case(materials, points, count, cases)) return true;
            }
    return false;
}

/// The laws of all directions: the case in which they hold, or else, where points move as one, one after the
/// other in turns until all hold.
template <class Real>
void HeldImpacts<Real>::solve_laws(const Materials& materials, bool has_friction) {
    std::size_t points = 0;
    while (points < directions_.size() && directions_[points].law == Law::normal) ++points;
    if (find_case(materials, points, has_friction ? directions_.size() : points)) return;
    impulses_ = {};
    for (int round = 0; round < kMostRounds; ++round) {
        const Values before = impulses_;
        solve_normals(points, materials.restitution);
        const double pressed = impulses_[0] + (points > 1 ? impulses_[1] : 0);
        for (std::size_t i = points; i < directions_.size() && has_friction; ++i) {
            if (!(masses_[i][i] > 0)) continue;
            const double coefficient = coefficient_of(i, materials);
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
