#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/impacts/held_impacts.hpp"

// The impact of two shapes: which of its points meet in a substep, when, and the impulses of that.

namespace carom {

/// Slower than so many times what gravity adds in a substep is no impact but a contact.
inline constexpr double kRestFalls = 2;

/// A body of an impact.
template <class Real>
struct StruckBody {
    std::int32_t row;
    double w, w2;          // 1/kg: what an impulse changes the velocity, and one at the rim the rim speed by
    Vec2 start, foreseen;  // m/s, at the start of the substep and, if nothing happens, at its end
    double start_rim, foreseen_rim;

    /// @param half_kick  m/s: a body that joints hold has the velocity of the middle of the substep before,
    /// to which this is to be added; zero of others
    StruckBody(const BodyRecords<Real>& records, std::int32_t number, Vec2 half_kick) : row(number) {
        const Real* record = &records.velocity[4 * static_cast<std::size_t>(row)];
        const double mass = record[3];
        w = std::fabs(mass), w2 = 2 * std::fmax(mass, 0);
        foreseen = {record[0], record[1]}, foreseen_rim = record[2];
        start = foreseen, start_rim = foreseen_rim;
        if (static_cast<std::size_t>(row) >= records.count()) return;  // nothing moves it
        const auto [x, y, rim] = records.start_of_substep(row);
        start = Vec2{x, y} + half_kick, start_rim = rim;
    }
    /// Its velocity becomes that of a later time. What joints and contacts have given it so far counts for
    /// the whole substep in the books, whatever it meets in between, so it is not in that velocity: else an
    /// impact would change the energy by what they have given up to its time.
    /// @param share  of the substep
    void go_on(double share, const BodyRecords<Real>& records, const SubstepTerms& terms) {
        Vec2 free = foreseen;  // m/s, at the end of the substep in free flight
        double free_rim = foreseen_rim;
        if (static_cast<std::size_t>(row) < records.count()) {
            const auto [x, y, rim] = records.free_flight(row, terms);
            free = {x, y}, free_rim = rim;
        }
        start += share * (free - start), start_rim += share * (free_rim - start_rim);
    }
};

/// How far the points of a body that turns come off the ways that a contact knows of, at most [m].
/// @param rim_speed  m/s  @param time  s, for which it turns
template <class Real>
double bend_of(const Bodies<Real>& bodies, std::int32_t number, double rim_speed, double time) {
    const auto row = static_cast<std::size_t>(number);
    if (row >= bodies.count || rim_speed == 0) return 0;
    const double angle = time * rim_speed / static_cast<double>(bodies.rim(row));
    return 0.5 * angle * angle * static_cast<double>(bodies.radius[row]);
}

/// The time [s] at which a gap closes that has a velocity now and another one after h.
inline double time_to_close(double gap, double velocity, double soon, double h) {
    if (!(gap > 0)) return 0;
    const double change = (soon - velocity) / h, root = velocity * velocity - 2 * change * gap;
    return std::fmin(h, 2 * gap / (-velocity + std::sqrt(std::fmax(root, 0))));
}

template <class Real>
Vec2 half_kick_of(const HeldImpacts<Real>& held, std::int32_t row, const SubstepTerms& terms) {
    return held.holds(row) ? 0.5 * terms.gravity_change : Vec2{};
}

/// Levers of a contact's two points, then of both for friction, in rims of the body.
using Levers = std::array<double, 3>;

/// Shifts the levers of two bodies that move so that both are about one point of the world, half way between
/// where each body has carried the point since the contact was found. An impulse along one line gives the two
/// no angular momentum; about a point of each body it gives them the impulse times the way that the points
/// have gone apart, which is of the order of the step.
/// @param come  m, of b against a up to the impact
template <class Real>
void share_points(const Bodies<Real>& bodies, const BodyRecords<Real>& records,
                  const PathContact<Real>& contact, Vec2 come, Vec2 n, Vec2 t, Levers& lever_a,
                  Levers& lever_b) {
    const auto row_a = static_cast<std::size_t>(contact.near), row_b = static_cast<std::size_t>(contact.far);
    const auto place = [&](std::size_t row) {
        return Vec2{static_cast<double>(bodies.position_x[row]) + records.displacement[2 * row],
                    static_cast<double>(bodies.position_y[row]) + records.displacement[2 * row + 1]};
    };
    const Vec2 apart = place(row_b) - place(row_a) + come;
    const double rim_a = bodies.rim(row_a), rim_b = bodies.rim(row_b);
    // r x n = -(r . t), r . n: from a's points to b's.
    const double along = dot(apart, t) - (rim_b * lever_b[0] - rim_a * lever_a[0]),
                 above = dot(apart, n) + (rim_b * lever_b[2] - rim_a * lever_a[2]);
    for (std::size_t k = 0; k < 2; ++k) lever_a[k] -= 0.5 * along / rim_a, lever_b[k] += 0.5 * along / rim_b;
    lever_a[2] += 0.5 * above / rim_a, lever_b[2] -= 0.5 * above / rim_b;
}

/// What the impulses of an impact are, and their work [J].
struct PointImpulses {
    std::array<double, 2> x{};  // N s, along the normal at each point
    double y = 0;               // N s, along the tangent
    double by_normal = 0, by_friction = 0;
    bool is_given = false;  // bodies have them already
};

/// The impact of two shapes that fly: Newton's law of both points at once, then Coulomb's.
/// @param v  m/s, normal velocities of the two points
template <class Real>
PointImpulses solve_free(const StruckBody<Real>& a, const StruckBody<Real>& b, Vec2 t, const Levers& lever_a,
                         const Levers& lever_b, const std::array<bool, 2>& meets, double e, double friction,
                         const std::array<double, 2>& v) {
    PointImpulses found;
    std::array<double, 2>& x = found.x;
    const double w = a.w + b.w;
    const auto mass = [&](std::size_t i, std::size_t k) {
        return (i < 2) == (k < 2) ? w + a.w2 * lever_a[i] * lever_a[k] + b.w2 * lever_b[i] * lever_b[k]
                                  : a.w2 * lever_a[i] * lever_a[k] + b.w2 * lever_b[i] * lever_b[k];
    };
    const double k11 = mass(0, 0), k12 = mass(0, 1), k22 = mass(1, 1);
    // Newton's law of what is met: each point leaves at e times the speed it came with, or faster.
    const double b1 = (1 + e) * v[0], b2 = (1 + e) * v[1];
    if (!meets[1]) {
        x = {-b1 / k11, 0};
    } else if (!meets[0]) {
        x = {0, -b2 / k22};
    } else {
        const double n1 = k12 * b2 - k22 * b1, n2 = k12 * b1 - k11 * b2, determinant = k11 * k22 - k12 * k12;
        if (n1 >= 0 && n2 >= 0 && determinant > 0)
            x = {n1 / determinant, n2 / determinant};
        else
            x = n2 <= 0 ? std::array<double, 2>{-b1 / k11, 0} : std::array<double, 2>{0, -b2 / k22};
    }
    // Work: x . (v + v') / 2, v' = v + K x.
    found.by_normal =
        x[0] * (v[0] + 0.5 * (k11 * x[0] + k12 * x[1])) + x[1] * (v[1] + 0.5 * (k12 * x[0] + k22 * x[1]));
    const double sum = x[0] + x[1];
    const double vt = dot(b.start - a.start, t) + b.start_rim * lever_b[2] - a.start_rim * lever_a[2] +
                      mass(0, 2) * x[0] + mass(1, 2) * x[1],
                 ktt = mass(2, 2), limit = friction * sum;
    found.y = std::fmin(std::fmax(-vt / ktt, -limit), limit);
    found.by_friction = found.y * (vt + 0.5 * ktt * found.y);
    return found;
}

/// What becomes of a contact in a substep.
enum class Outcome : std::uint8_t {
    none,
    comes,  ///< fast, but not near enough yet
    met     ///< there was an impact
};

/// An impact as it is worked out: what meets, when, and with what velocities.
template <class Real>
struct Meeting {
    const PathContact<Real>& contact;
    const SubstepTerms& terms;
    const Bodies<Real>& bodies;
    const BodyRecords<Real>& records;
    const Vec2 n, t;                          // normal, from near to far; tangent
    const StruckBody<Real> first_a, first_b;  // at the start of the substep
    const Levers own_a, own_b;                // about the points that each has carried
    StruckBody<Real> a = first_a, b = first_b;
    Levers lever_a = own_a, lever_b = own_b;
    std::array<double, 2> v{};    // m/s, normal velocities of the points
    std::array<bool, 2> meets{};  // what is not met yet has an impact of its own, later
    double time = 0;              // s, from the start of the substep

    Meeting(const PathContact<Real>& of, const SubstepTerms& of_substep, const Bodies<Real>& all,
            BodyRecords<Real>& of_bodies, const HeldImpacts<Real>& held)
        : contact(of),
          terms(of_substep),
          bodies(all),
          records(of_bodies),
          n{of.link.normal_x[of.lane], of.link.normal_y[of.lane]},
          t{-n.y, n.x},
          first_a(of_bodies, of.near, half_kick_of(held, of.near, of_substep)),
          first_b(of_bodies, of.far, half_kick_of(held, of.far, of_substep)),
          own_a{of.link.near1[of.lane], of.link.near2[of.lane], of.link.near_t[of.lane]},
          own_b{of.link.far1[of.lane], of.link.far2[of.lane], of.link.far_t[of.lane]} {}

    bool both_move() const { return a.w > 0 && b.w > 0; }
    double closing() const { return std::fmax(meets[0] ? -v[0] : 0, meets[1] ? -v[1] : 0); }
    /// The velocity of b against a at a point [m/s], along the normal; for the third lever along the tangent.
    /// Displacements in place of velocities give the way [m].
    double relative(Vec2 va, double ua, Vec2 vb, double ub, std::size_t k) const {
        return dot(vb - va, k < 2 ? n : t) + ub * lever_b[k] - ua * lever_a[k];
    }
    void find_velocities() {
        for (std::size_t k = 0; k < 2; ++k) v[k] = relative(a.start, a.start_rim, b.start, b.start_rim, k);
    }

    /// Finds which points meet in the substep, and when the first one does.
    Outcome look() {
        const PathLink<Real>& link = contact.link;
        const std::size_t lane = contact.lane;
        const double rest_speed = kRestFalls * terms.fall_speed(), h = terms.substep_dt;
        const bool has_two = link.separation2[lane] < static_cast<Real>(kNoPoint);
        find_velocities();
        const std::array<bool, 2> is_fast{v[0] < -rest_speed, has_two && v[1] < -rest_speed};
        if (!is_fast[0] && !is_fast[1]) return Outcome::none;
        const double pressing =
            static_cast<double>(link.normal1[lane]) + static_cast<double>(link.normal2[lane]);
        if (pressing > kLightPress * std::fmax(-v[0], -v[1]) / (a.w + b.w)) return Outcome::none;
        const auto come = [&](std::int32_t row) {
            const auto r = static_cast<std::size_t>(row);
            return Vec2{records.displacement[2 * r], records.displacement[2 * r + 1]};
        };
        const auto turned = [&](std::int32_t row) {
            return static_cast<double>(records.turn()[static_cast<std::size_t>(row)]);
        };
        // Bodies that turn are struck earlier by what bends their ways since the contact was found, so that
        // they do not end in each other, where they would be pushed apart.
        const double since = terms.elapsed + h, bend = bend_of(bodies, a.row, a.start_rim, since) +
                                                       bend_of(bodies, b.row, b.start_rim, since);
        bool is_free = true;
        time = h;
        for (std::size_t k = 0; k < (has_two ? 2 : 1); ++k) {
            const double gap =
                static_cast<double>(k == 0 ? link.separation1[lane] : link.separation2[lane]) +
                relative(come(contact.near), turned(contact.near), come(contact.far), turned(contact.far), k);
            const double soon = relative(a.foreseen, a.foreseen_rim, b.foreseen, b.foreseen_rim, k);
            const bool touches = gap + h * soon < 0;
            meets[k] = is_fast[k] && touches, is_free = is_free && !touches;
            if (meets[k]) time = std::fmin(time, time_to_close(gap - bend, v[k], soon, h));
        }
        if (meets[0] || meets[1]) return Outcome::met;
        return is_free ? Outcome::comes : Outcome::none;
    }

    /// Velocities and levers become those of a time.
    /// @param shares  whether the levers are about points that both bodies share
    /// @return whether the bodies still meet then
    bool go_to(double then, bool shares) {
        time = then, a = first_a, b = first_b, lever_a = own_a, lever_b = own_b;
        const double share = time / terms.substep_dt;
        a.go_on(share, records, terms), b.go_on(share, records, terms);
        if (shares)
            share_points(bodies, records, contact, time * (b.start - a.start), n, t, lever_a, lever_b);
        find_velocities();
        const std::array<bool, 2> still_meets{meets[0] && v[0] < 0, meets[1] && v[1] < 0};
        if (!still_meets[0] && !still_meets[1]) return false;
        meets = still_meets;
        return true;
    }
    /// If the bodies part already, about shared points or since what makes them meet is not in free flight:
    /// the paths know the points of each alone at the start, and would take the approach that they see
    /// without restitution.
    void go_to_meeting(double then) {
        if (!go_to(then, both_move()) && !(both_move() && go_to(0, true))) go_to(0, false);
    }

    PointImpulses solve() const {
        return solve_free(a, b, t, lever_a, lever_b, meets, contact.restitution,
                          static_cast<double>(contact.link.friction[contact.lane]), v);
    }
    /// What impulses change the rim speed of a body by [m/s]. @param sign  -1 of a, 1 of b
    double change_of_rim(const StruckBody<Real>& body, double sign, const Levers& lever,
                         const PointImpulses& by) const {
        return sign * body.w2 * (lever[0] * by.x[0] + lever[1] * by.x[1] + lever[2] * by.y);
    }
    /// Solves the impact of bodies that fly. They are struck earlier by what will bend their ways until
    /// contacts are found anew, for the reason of look().
    PointImpulses strike() {
        const PointImpulses found = solve();
        if (!(time > 0)) return found;
        const double left = terms.dt - terms.elapsed,
                     later =
                         bend_of(bodies, a.row, a.start_rim + change_of_rim(a, -1, lever_a, found), left) +
                         bend_of(bodies, b.row, b.start_rim + change_of_rim(b, 1, lever_b, found), left);
        if (!(later > 0)) return found;
        go_to_meeting(std::fmax(0, time - later / closing()));
        return solve();
    }
};

}  // namespace carom
