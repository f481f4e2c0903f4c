#include "solvers/soft/impacts/shape_impacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace carom {
namespace {

/// Rounds over all contacts in a substep: what a blow sets in motion may hit the next body in the same one.
constexpr int kRounds = 8;
/// Slower than so many times what gravity adds in a substep is no impact but a contact.
constexpr double kRestFalls = 2;

/// A body of an impact.
template <class Real>
struct StruckBody {
    std::int32_t row;
    double w, w2;          // 1/kg: what an impulse changes the velocity, and one at the rim the rim speed by
    Vec2 start, foreseen;  // m/s, at the start of the substep and, if nothing happens, at its end
    Vec2 free;             // m/s, at its end in free flight
    double start_rim, foreseen_rim, free_rim;

    /// @param half_kick  m/s: a body that joints hold has the velocity of the middle of the substep before,
    /// to which this is to be added; zero of others
    StruckBody(const BodyRecords<Real>& records, std::int32_t number, Vec2 half_kick,
               const SubstepTerms& terms)
        : row(number) {
        const Real* record = &records.velocity[4 * static_cast<std::size_t>(row)];
        const double mass = record[3];
        w = std::fabs(mass), w2 = 2 * std::fmax(mass, 0);
        foreseen = {record[0], record[1]}, foreseen_rim = record[2];
        start = free = foreseen, start_rim = free_rim = foreseen_rim;
        if (static_cast<std::size_t>(row) >= records.count()) return;  // nothing moves it
        const auto [x, y, rim] = records.start_of_substep(row);
        start = Vec2{x, y} + half_kick, start_rim = rim;
        const auto [free_x, free_y, free_turn] = records.free_flight(row, terms);
        free = {free_x, free_y}, free_rim = free_turn;
    }
    /// Its velocity becomes that of a later time. What joints and contacts have given it so far counts for
    /// the whole substep in the books, whatever it meets in between, so it is not in that velocity: else an
    /// impact would change the energy by what they have given up to its time.
    /// @param share  of the substep
    void go_on(double share) { start += share * (free - start), start_rim += share * (free_rim - start_rim); }
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
double time_to_close(double gap, double velocity, double soon, double h) {
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
        const StruckBody<Real> body(records, row, half_kick_of(held, row, terms), terms);
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

/// What becomes of a contact in a substep.
enum class Outcome : std::uint8_t {
    none,
    comes,  ///< fast, but not near enough yet
    met     ///< there was an impact
};

/// Whether no point of a contact can be fast, whatever joints hold: of nearly all contacts of what rests.
template <class Real>
bool is_slow(const PathContact<Real>& contact, const SubstepTerms& terms, const BodyRecords<Real>& records) {
    const auto count = static_cast<std::int32_t>(records.count());
    if (contact.near >= count || contact.far >= count) return false;  // nothing moves one of them
    const auto a = records.start_of_substep(contact.near), b = records.start_of_substep(contact.far);
    const auto arm = [&](const auto& first, const auto& second) {
        return std::fmax(std::fabs(static_cast<double>(first[contact.lane])),
                         std::fabs(static_cast<double>(second[contact.lane])));
    };
    const PathLink<Real>& link = contact.link;
    const double most = std::fabs(b[0] - a[0]) + std::fabs(b[1] - a[1]) +
                        std::fabs(a[2]) * arm(link.near1, link.near2) +
                        std::fabs(b[2]) * arm(link.far1, link.far2);
    return most <= (kRestFalls - 1) * terms.fall_speed();  // half a kick of gravity may come to each
}

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
          first_a(of_bodies, of.near, half_kick_of(held, of.near, of_substep), of_substep),
          first_b(of_bodies, of.far, half_kick_of(held, of.far, of_substep), of_substep),
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
        bool comes = false, is_free = true;
        find_velocities();
        time = h;
        for (std::size_t k = 0; k < 2; ++k) {
            if (k == 1 && !(link.separation2[lane] < static_cast<Real>(kNoPoint))) break;
            const double gap =
                static_cast<double>(k == 0 ? link.separation1[lane] : link.separation2[lane]) +
                relative(come(contact.near), turned(contact.near), come(contact.far), turned(contact.far), k);
            const double soon = relative(a.foreseen, a.foreseen_rim, b.foreseen, b.foreseen_rim, k);
            const bool is_fast = v[k] < -rest_speed, touches = gap + h * soon < 0;
            meets[k] = is_fast && touches, comes = comes || is_fast, is_free = is_free && !touches;
            if (meets[k]) time = std::fmin(time, time_to_close(gap - bend, v[k], soon, h));
        }
        const double pressing =
            static_cast<double>(link.normal1[lane]) + static_cast<double>(link.normal2[lane]);
        if (pressing > kLightPress * std::fmax(-v[0], -v[1]) / (a.w + b.w)) return Outcome::none;
        if (meets[0] || meets[1]) return Outcome::met;
        return comes && is_free ? Outcome::comes : Outcome::none;
    }

    /// Velocities and levers become those of a time.
    /// @param shares  whether the levers are about points that both bodies share
    /// @return whether the bodies still meet then
    bool go_to(double then, bool shares) {
        time = then, a = first_a, b = first_b, lever_a = own_a, lever_b = own_b;
        const double share = time / terms.substep_dt;
        a.go_on(share), b.go_on(share);
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

/// An impact changes what its bodies, and what joints hold them with, meet from then on: other contacts are
/// not looked at again.
template <class Real>
std::int64_t ShapeImpacts<Real>::carry_out(PathSolver<Real>& paths, const SubstepTerms& terms,
                                           const Bodies<Real>& bodies, BodyRecords<Real>& records,
                                           HeldImpacts<Real>& held, Books& books, double& gravity_work) {
    deflected_.clear(), bouncing_.clear();
    std::size_t number = 0;
    paths.for_each([&](const PathContact<Real>& contact) {
        if (contact.restitution > 0) bouncing_.push_back({number, contact.near, contact.far});
        ++number;
    });
    paths.unhide();
    changed_.assign(records.rows(), 0);
    std::uint32_t look = 0;
    const auto note_changed = [&](std::int32_t row) { changed_[static_cast<std::size_t>(row)] = look; };
    std::int64_t impacts = 0;
    bool goes_on = true;
    const auto look_at = [&](Bouncing& bouncing, const PathContact<Real>& contact) {
        bouncing.looked = ++look, bouncing.comes = false;
        if (is_slow(contact, terms, records)) return;
        const Outcome outcome =
            carry_out_one(contact, terms, bodies, records, held, books, gravity_work, note_changed);
        bouncing.comes = outcome == Outcome::comes;
        if (outcome != Outcome::met) return;
        ++impacts, goes_on = true;
        for (const std::int32_t row : {contact.near, contact.far})
            if (static_cast<std::size_t>(row) < bodies.moving() &&
                bodies.is_disc(static_cast<std::size_t>(row)))
                deflected_.push_back(row);
    };
    for (int round = 0; round < kRounds && goes_on; ++round) {
        goes_on = false;
        for (Bouncing& bouncing : bouncing_) {
            const std::uint32_t changed = std::max(changed_[static_cast<std::size_t>(bouncing.near)],
                                                   changed_[static_cast<std::size_t>(bouncing.far)]);
            if (changed >= bouncing.looked)
                paths.for_each_of(bouncing.number, bouncing.number + 1,
                                  [&](const PathContact<Real>& contact) { look_at(bouncing, contact); });
        }
    }
    if (!goes_on)  // else what was seen in the last round no longer holds
        for (const Bouncing& bouncing : bouncing_)
            if (bouncing.comes)
                paths.for_each_of(bouncing.number, bouncing.number + 1,
                                  [&](const PathContact<Real>& contact) { paths.hide(contact); });
    records.put_off_delays();
    return impacts;
}

template class ShapeImpacts<float>;
template class ShapeImpacts<double>;

}  // namespace carom
