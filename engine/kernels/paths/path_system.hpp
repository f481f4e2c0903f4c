#pragma once

#include <algorithm>

#include "kernels/paths/path_lanes.hpp"

// Contacts of convex shapes along paths, 16 paths side by side. A contact has two normal rows and one row of
// friction; along a path it couples with the contact before it and the one behind it through the body between
// them, so all rows of a path are a block tridiagonal system. It is solved exactly, with an active set: which
// points push, which contacts slip. docs/decisions/0027-paths-of-contacts.md has the derivation.

namespace carom {
namespace {

/// Diagonals grow by this share, so that contacts which hold a body twice have a solution.
constexpr double kRegularisation = 1e-5;
/// Contacts change no velocity by more than so many times the largest relative speed there is: rows that are
/// nearly alike have solutions that would, and would make energy of round-off.
/// Nor does an impulse change by more than would do that to all bodies of the path together, each taken for
/// as heavy as the heaviest: a squeeze between two things that nothing moves has no solution, and that of a
/// matrix which is regularised is as large as the regularisation is small. docs/decisions/0040-squeezes.md.
constexpr double kMostChange = 64;
/// Nor does a path that a kinematic body drives change a velocity by more than so many times the speed of
/// that body, or the largest relative speed there is: what it pushes may have nowhere to go. What gravity
/// adds to all of its bodies in a substep it may always take up.
constexpr double kMostChangeOfDriven = 1.1;
/// And less where the path ends at something else that nothing moves, as a squeeze does.
/// docs/decisions/0068-what-stirs-shapes.md.
constexpr double kMostChangeOfSqueezed = 0.5;
/// By which friction may be beyond its limit, in shares of what a normal impulse may pull by: what a contact
/// holds beyond its limit never slides.
constexpr double kFrictionTolerance = 0.1;
/// Links of a piece of a path that does not settle as a whole.
constexpr std::size_t kPiece = 8;
/// Up to this iteration the worst row of each piece of a path changes, later that of four pieces: rows so far
/// from each other hardly turn each other round.
constexpr int kIterationsByPieces = 16;
constexpr std::size_t kLongPiece = 4 * kPiece;
/// Speeds that no solution reaches [m/s]: an iteration that does is void.
constexpr double kUnsound = 1e15;

/// A link while its path is solved.
template <class Lanes>
struct LinkScratch {
    using F = typename Lanes::Batch;
    using Mask = typename Lanes::Mask;
    PathBody<Lanes> body;  // the far one
    F w, w2;               // its masses
    F v1, v2, vt, floor1, floor2;
    LinkMass<F> mass;           // with what the diagonal grows by
    F next[9];                  // coupling with the next link: rows of this one, columns of that one
    F upper[9], right[3];       // the eliminated system: x[i] = right - upper x[i + 1]
    F change[3];                // of the impulses
    F dvx, dvy, du;             // of the far body's velocity
    Mask pushes1, pushes2;      // the active set
    Mask slips_up, slips_down;  // the tangential impulse is at its limit, with + and with - friction
    Mask would_slip_up;         // if it slipped now
};

/// Gives a body its change of velocity.
template <class Lanes>
void store_changed(typename Lanes::Number* velocity, const std::int32_t* rows, typename Lanes::Mask where,
                   const LinkScratch<Lanes>& s) {
    using F = typename Lanes::Batch;
    auto record = s.body.record;
    record[0] += simd::select(where, s.dvx, F(0)), record[1] += simd::select(where, s.dvy, F(0));
    record[2] += simd::select(where, s.du, F(0));
    Lanes::store_rows4(velocity, rows, record);
}

/// The coupling of a link with the next one, through the body between them.
/// @param w, w2  its inverse masses
template <class Lanes, class Real>
void couple(const LinkLanes<Lanes, Real>& l, const LinkLanes<Lanes, Real>& q, typename Lanes::Batch w,
            typename Lanes::Batch w2, typename Lanes::Batch next[9]) {
    using F = typename Lanes::Batch;
    const F nn = -w * (l.nx * q.nx + l.ny * q.ny), nt = -w * (l.ny * q.nx - l.nx * q.ny), c1 = -w2 * l.far1,
            c2 = -w2 * l.far2, ct = -w2 * l.far_t;
    next[0] = nn + c1 * q.near1, next[1] = nn + c1 * q.near2, next[2] = nt + c1 * q.near_t;
    next[3] = nn + c2 * q.near1, next[4] = nn + c2 * q.near2, next[5] = nt + c2 * q.near_t;
    next[6] = -nt + ct * q.near1, next[7] = -nt + ct * q.near2, next[8] = nn + ct * q.near_t;
}

/// Masses and couplings of the links, their relative velocities and a first guess of the active set.
/// @param restless  becomes what SolvePaths::restless says of each lane
/// @param inverse_mass  becomes that of the heaviest body of each lane [1/kg]
/// @param drive  becomes the largest speed of what drives each lane, as nothing moves it; 0: nothing does
/// [m/s]
/// @return the largest relative speed of each lane [m/s]
template <class Lanes, class Real>
typename Lanes::Batch begin_paths(const PathBatch<Real>& p, LinkScratch<Lanes>* scratch,
                                  typename Lanes::Batch& restless, typename Lanes::Batch& inverse_mass,
                                  typename Lanes::Batch& drive) {
    using F = typename Lanes::Batch;
    const SolvePaths<Real>& k = p.k;
    const F zero(0), tolerance(k.velocity_tolerance);
    const F one(1), grown(static_cast<Real>(1 + kRegularisation)),
        thinnest(static_cast<Real>(1e-30));  // m
    F fastest(0);
    restless = zero;
    PathBody<Lanes> a{Lanes::load_rows4(k.velocity, p.head)};
    LinkScratch<Lanes>& head = scratch[p.length];
    head.body = a, head.w = a.inverse_mass(), head.w2 = a.inverse_rim_mass();
    const F no_mass(static_cast<Real>(1e30));  // 1/kg
    const auto note_mass = [&](F w) {
        inverse_mass = simd::min(inverse_mass, simd::select(w > zero, w, no_mass));
    };
    inverse_mass = no_mass, note_mass(head.w);
    const auto note_drive = [&](const PathBody<Lanes>& body, F w) {
        const F speed = simd::abs(body.record[0]) + simd::abs(body.record[1]) + simd::abs(body.record[2]);
        drive = simd::max(drive, simd::select(w > zero, zero, speed));
    };
    drive = zero, note_drive(a, head.w);
    for (std::size_t i = 0; i < p.length; ++i) {
        const PathLink<Real>& link = p.link[i];
        LinkScratch<Lanes>& s = scratch[i];
        const LinkLanes<Lanes, Real> l(link, p.lane);
        const PathBody<Lanes> b{Lanes::load_rows4(k.velocity, p.far_rows(i))};
        s.body = b, s.w = b.inverse_mass(), s.w2 = b.inverse_rim_mass();
        s.mass = LinkMass<F>(l, a.inverse_mass(), a.inverse_rim_mass(), s.w, s.w2);
        s.mass.k11 *= grown, s.mass.k22 *= grown, s.mass.ktt *= grown;
        if (i > 0)
            couple(LinkLanes<Lanes, Real>(p.link[i - 1], p.lane), l, scratch[i - 1].w, scratch[i - 1].w2,
                   scratch[i - 1].next);
        note_mass(s.w), note_drive(b, s.w);
        l.relative(b.record[0] - a.record[0], b.record[1] - a.record[1], a.record[2], b.record[2], s.v1, s.v2,
                   s.vt);
        s.floor1 = Lanes::load(link.floor1 + p.lane), s.floor2 = Lanes::load(link.floor2 + p.lane);
        const F old1 = Lanes::load(link.normal1 + p.lane), old2 = Lanes::load(link.normal2 + p.lane),
                old_t = Lanes::load(link.tangent + p.lane);
        s.pushes1 = (old1 > zero) | (s.v1 < s.floor1 - tolerance);
        s.pushes2 = (old2 > zero) | (s.v2 < s.floor2 - tolerance);
        const F limit = Lanes::load(link.friction + p.lane) * (old1 + old2);
        const auto is_idle = !(s.pushes1 | s.pushes2);
        const auto slips = (simd::abs(old_t) >= limit * F(Real(.999999))) & (old_t * s.vt < zero);
        s.slips_up = is_idle | (slips & (old_t > zero)), s.slips_down = (!is_idle) & slips & (old_t < zero);
        const F speed = simd::max(simd::max(simd::abs(s.v1), simd::abs(s.v2)), simd::abs(s.vt)),
                thickness = simd::max(Lanes::load(link.thickness + p.lane), thinnest);
        fastest = simd::max(fastest, speed);
        restless = simd::max(restless, speed * simd::max(F(k.resting_thickness) / thickness, one));
        a = b;
    }
    for (F& e : scratch[p.length - 1].next) e = zero;
    return fastest;
}

/// Eliminates the impulses of the links, from link `from` to the last.
/// @param from  no link before it has changed its active set since it was eliminated
template <class Lanes, class Real>
void eliminate(const PathBatch<Real>& p, LinkScratch<Lanes>* scratch, std::size_t from) {
    using F = typename Lanes::Batch;
    using simd::select;
    const F zero(0), one(1);
    F lower[9], upper[9], right[3];  // lower: rows of this link, columns of the one before
    for (int e = 0; e < 9; ++e) lower[e] = upper[e] = zero;
    for (int e = 0; e < 3; ++e) right[e] = zero;
    const auto couple_with = [&](const LinkScratch<Lanes>& before) {
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) lower[3 * r + c] = before.next[3 * c + r];
    };
    if (from > 0) {
        const LinkScratch<Lanes>& before = scratch[from - 1];
        std::copy_n(before.upper, 9, upper), std::copy_n(before.right, 3, right);
        couple_with(before);
    }
    for (std::size_t i = from; i < p.length; ++i) {
        const PathLink<Real>& link = p.link[i];
        LinkScratch<Lanes>& s = scratch[i];
        F m[9] = {s.mass.k11, s.mass.k12, s.mass.k1t, s.mass.k12, s.mass.k22,
                  s.mass.k2t, s.mass.k1t, s.mass.k2t, s.mass.ktt};
        F b[3] = {s.floor1 - s.v1, s.floor2 - s.v2, -s.vt};
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c)
                m[3 * r + c] -= lower[3 * r] * upper[c] + lower[3 * r + 1] * upper[3 + c] +
                                lower[3 * r + 2] * upper[6 + c];
            b[r] -= lower[3 * r] * right[0] + lower[3 * r + 1] * right[1] + lower[3 * r + 2] * right[2];
        }
        F right_side[9];
        const F old1 = Lanes::load(link.normal1 + p.lane), old2 = Lanes::load(link.normal2 + p.lane),
                old_t = Lanes::load(link.tangent + p.lane), friction = Lanes::load(link.friction + p.lane);
        // A point that does not push: its impulse becomes zero.
        m[0] = select(s.pushes1, m[0], one), m[1] = select(s.pushes1, m[1], zero);
        m[2] = select(s.pushes1, m[2], zero), b[0] = select(s.pushes1, b[0], -old1);
        m[4] = select(s.pushes2, m[4], one), m[3] = select(s.pushes2, m[3], zero);
        m[5] = select(s.pushes2, m[5], zero), b[1] = select(s.pushes2, b[1], -old2);
        // A contact that slips: its tangential impulse goes with the normal ones.
        const auto slips = s.slips_up | s.slips_down;
        const F slope = select(s.slips_up, friction, -friction);
        m[6] = select(slips, -slope, m[6]), m[7] = select(slips, -slope, m[7]),
        m[8] = select(slips, one, m[8]);
        b[2] = select(slips, slope * (old1 + old2) - old_t, b[2]);
        for (int c = 0; c < 3; ++c) {
            right_side[c] = select(s.pushes1, s.next[c], zero);
            right_side[3 + c] = select(s.pushes2, s.next[3 + c], zero);
            right_side[6 + c] = select(slips, zero, s.next[6 + c]);
        }
        const F c0 = m[4] * m[8] - m[5] * m[7], c1 = m[5] * m[6] - m[3] * m[8],
                c2 = m[3] * m[7] - m[4] * m[6];
        const F d = one / (m[0] * c0 + m[1] * c1 + m[2] * c2);
        const F inverse[9] = {c0 * d, (m[2] * m[7] - m[1] * m[8]) * d, (m[1] * m[5] - m[2] * m[4]) * d,
                              c1 * d, (m[0] * m[8] - m[2] * m[6]) * d, (m[2] * m[3] - m[0] * m[5]) * d,
                              c2 * d, (m[1] * m[6] - m[0] * m[7]) * d, (m[0] * m[4] - m[1] * m[3]) * d};
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c)
                s.upper[3 * r + c] = upper[3 * r + c] = inverse[3 * r] * right_side[c] +
                                                        inverse[3 * r + 1] * right_side[3 + c] +
                                                        inverse[3 * r + 2] * right_side[6 + c];
            s.right[r] = right[r] =
                inverse[3 * r] * b[0] + inverse[3 * r + 1] * b[1] + inverse[3 * r + 2] * b[2];
        }
        couple_with(s);
    }
}

/// A contact of which no point pushes has no friction: its tangential impulse is at its limit, which is zero.
/// One that begins to push sticks.
template <class Lanes>
[[gnu::always_inline]] inline void free_idle(LinkScratch<Lanes>& s, typename Lanes::Mask was_idle) {
    const auto is_idle = !(s.pushes1 | s.pushes2);
    s.slips_up = (s.slips_up & !was_idle) | is_idle;
    s.slips_down = s.slips_down & !(was_idle | is_idle);
}

/// Turns one row of the active set round in the lanes where `row` is of this link.
/// @param first  number of the link's first row
template <class Lanes>
void change_row(LinkScratch<Lanes>& s, typename Lanes::Batch row, typename Lanes::Number first) {
    using F = typename Lanes::Batch;
    const auto turn_round = [&](auto& mask, auto where) {
        const auto is_off = !mask;
        mask = (mask & (!where)) | (is_off & where);
    };
    const auto was_idle = !(s.pushes1 | s.pushes2);
    turn_round(s.pushes1, row == F(first)), turn_round(s.pushes2, row == F(first + 1));
    const auto tangent = row == F(first + 2);
    const auto slips = s.slips_up | s.slips_down;
    const auto breaks = tangent & (!slips);
    s.slips_up = (s.slips_up & !tangent) | (breaks & s.would_slip_up);
    s.slips_down = (s.slips_down & !tangent) | (breaks & !s.would_slip_up);
    free_idle<Lanes>(s, was_idle);
}

/// The impulses from the last link to the first, what they do to the bodies, and the next active set.
/// @param by_speed, by_impulse  tolerances [m/s], the second of impulse times inverse mass
/// @param most  m/s: no body's velocity changes by more, nor an impulse times `inverse_mass`
/// @param inverse_mass  1/kg, of the whole path at least
/// @param stretch  links of which the active set of each lane changes in one row alone, the one that is
/// farthest from its law: where many change at once they may do so for ever; 0: all that are wrong change
/// @param first_changed  becomes a link before which no active set has changed; `length`: none has
/// @return lanes that are not solved yet
template <class Lanes, class Real>
typename Lanes::Mask substitute(const PathBatch<Real>& p, LinkScratch<Lanes>* scratch,
                                typename Lanes::Batch by_speed, typename Lanes::Batch by_impulse,
                                typename Lanes::Batch most, typename Lanes::Batch inverse_mass,
                                std::size_t stretch, std::size_t& first_changed) {
    using F = typename Lanes::Batch;
    using simd::select;
    first_changed = p.length;
    const F zero(0), by_friction = F(static_cast<Real>(kFrictionTolerance)) * by_impulse;
    auto bad = zero < zero;
    F worst = zero, worst_row(Real(-1));  // of a stretch: m/s; 3 link + row of the link
    F largest = zero;                     // m/s, change of a body's velocity
    F strongest = zero;                   // N s, change of an impulse
    // Change of velocity of the far body of the link that is looked at, and of its near body.
    F far_x = zero, far_y = zero, far_u = zero;
    const auto check = [&](std::size_t i, F near_x, F near_y, F near_u) {
        const PathLink<Real>& link = p.link[i];
        LinkScratch<Lanes>& s = scratch[i];
        const LinkLanes<Lanes, Real> l(link, p.lane);
        F v1, v2, vt;
        l.relative(far_x - near_x, far_y - near_y, near_u, far_u, v1, v2, vt);
        v1 += s.v1, v2 += s.v2, vt += s.vt;
        const F w = s.w + (i == 0 ? scratch[p.length].w : scratch[i - 1].w);
        const F new1 = Lanes::load(link.normal1 + p.lane) + s.change[0],
                new2 = Lanes::load(link.normal2 + p.lane) + s.change[1],
                new_t = Lanes::load(link.tangent + p.lane) + s.change[2],
                limit = Lanes::load(link.friction + p.lane) * (new1 + new2);
        const auto off1 = s.pushes1 & (new1 * w < -by_impulse),
                   on1 = (!s.pushes1) & (v1 - s.floor1 < -by_speed),
                   off2 = s.pushes2 & (new2 * w < -by_impulse),
                   on2 = (!s.pushes2) & (v2 - s.floor2 < -by_speed);
        const auto sticks = !(s.slips_up | s.slips_down);
        const auto breaks = sticks & ((simd::abs(new_t) - limit) * w > by_friction);
        const auto was_idle = !(s.pushes1 | s.pushes2);
        const auto holds = (!was_idle) & ((s.slips_up & (vt > by_speed)) | (s.slips_down & (vt < -by_speed)));
        s.would_slip_up = new_t > zero;
        if (stretch > 0) {
            const auto compare = [&](F miss, std::size_t row) {
                const auto is_worse = miss > worst;
                worst = select(is_worse, miss, worst);
                worst_row = select(is_worse, F(static_cast<Real>(3 * i + row)), worst_row);
            };
            compare(select(off1, -new1 * w, select(on1, s.floor1 - v1, zero)), 0);
            compare(select(off2, -new2 * w, select(on2, s.floor2 - v2, zero)), 1);
            compare(select(breaks, (simd::abs(new_t) - limit) * w, select(holds, simd::abs(vt), zero)), 2);
            if (i % stretch == 0) {
                if (simd::any(worst_row >= zero)) first_changed = i;
                for (std::size_t j = i; j < p.length && j < i + stretch; ++j)
                    change_row<Lanes>(scratch[j], worst_row, static_cast<Real>(3 * j));
                worst = zero, worst_row = F(Real(-1));
            }
        } else {
            s.pushes1 = (s.pushes1 & !off1) | on1, s.pushes2 = (s.pushes2 & !off2) | on2;
            s.slips_up = (s.slips_up & !holds) | (breaks & s.would_slip_up);
            s.slips_down = (s.slips_down & !holds) | (breaks & !s.would_slip_up);
            free_idle<Lanes>(s, was_idle);
            if (simd::any(off1 | on1 | off2 | on2 | breaks | holds)) first_changed = i;
        }
        const auto is_sound = simd::abs(v1) + simd::abs(v2) + simd::abs(vt) < F(static_cast<Real>(kUnsound));
        bad = bad | off1 | on1 | off2 | on2 | breaks | holds | !is_sound;
        largest =
            simd::max(largest, simd::max(simd::max(simd::abs(far_x), simd::abs(far_y)), simd::abs(far_u)));
    };
    F x0 = zero, x1 = zero, x2 = zero, jx_next = zero, jy_next = zero, spin_next = zero;
    for (std::size_t i = p.length; i-- > 0;) {
        const PathLink<Real>& link = p.link[i];
        LinkScratch<Lanes>& s = scratch[i];
        const LinkLanes<Lanes, Real> l(link, p.lane);
        const F y0 = s.right[0] - (s.upper[0] * x0 + s.upper[1] * x1 + s.upper[2] * x2),
                y1 = s.right[1] - (s.upper[3] * x0 + s.upper[4] * x1 + s.upper[5] * x2),
                y2 = s.right[2] - (s.upper[6] * x0 + s.upper[7] * x1 + s.upper[8] * x2);
        x0 = s.change[0] = y0, x1 = s.change[1] = y1, x2 = s.change[2] = y2;
        F jx, jy;
        l.impulse(x0 + x1, x2, jx, jy);
        strongest = simd::max(strongest, simd::max(simd::abs(x0), simd::abs(x1)));
        s.dvx = s.w * (jx - jx_next), s.dvy = s.w * (jy - jy_next);
        s.du = s.w2 * (l.far1 * x0 + l.far2 * x1 + l.far_t * x2 - spin_next);
        if (i + 1 < p.length) check(i + 1, s.dvx, s.dvy, s.du);
        far_x = s.dvx, far_y = s.dvy, far_u = s.du;
        jx_next = jx, jy_next = jy, spin_next = l.near1 * x0 + l.near2 * x1 + l.near_t * x2;
    }
    LinkScratch<Lanes>& head = scratch[p.length];
    head.dvx = -head.w * jx_next, head.dvy = -head.w * jy_next, head.du = -head.w2 * spin_next;
    check(0, head.dvx, head.dvy, head.du);
    return bad | (largest > most) | (strongest * inverse_mass > most);
}

/// Gives the bodies and the links the changes, of the lanes in `where` alone.
template <class Lanes, class Real>
void apply_changes(const PathBatch<Real>& p, const LinkScratch<Lanes>* scratch, typename Lanes::Mask where) {
    using F = typename Lanes::Batch;
    using simd::select;
    const F zero(0);
    store_changed<Lanes>(p.k.velocity, p.head, where, scratch[p.length]);
    for (std::size_t i = 0; i < p.length; ++i) {
        PathLink<Real>& link = p.link[i];
        const LinkScratch<Lanes>& s = scratch[i];
        store_changed<Lanes>(p.k.velocity, p.far_rows(i), where, s);
        const F old1 = Lanes::load(link.normal1 + p.lane), old2 = Lanes::load(link.normal2 + p.lane),
                old_t = Lanes::load(link.tangent + p.lane);
        const F new1 = simd::max(old1 + s.change[0], zero), new2 = simd::max(old2 + s.change[1], zero),
                limit = Lanes::load(link.friction + p.lane) * (new1 + new2),
                new_t = simd::min(simd::max(old_t + s.change[2], -limit), limit);
        Lanes::store(link.normal1 + p.lane, select(where, new1, old1));
        Lanes::store(link.normal2 + p.lane, select(where, new2, old2));
        Lanes::store(link.tangent + p.lane, select(where, new_t, old_t));
    }
}

/// By how much an exact solve may change velocities [m/s].
/// @param fastest, drive  as begin_paths() found them
template <class Lanes, class Real>
typename Lanes::Batch most_change(const PathBatch<Real>& p, const LinkScratch<Lanes>* scratch,
                                  typename Lanes::Batch fastest, typename Lanes::Batch drive) {
    using F = typename Lanes::Batch;
    const auto times = [](double count) { return F(static_cast<Real>(count)); };
    const F zero(0);
    const LinkScratch<Lanes>&head = scratch[p.length], &tail = scratch[p.length - 1];
    F apart = zero;  // m/s, of the two ends
    for (std::size_t i = 0; i < 3; ++i) apart += simd::abs(head.body.record[i] - tail.body.record[i]);
    const auto is_squeezed = (head.w <= zero) & (tail.w <= zero) & (apart > zero);
    const F load = times(static_cast<double>(p.length + 1)) * F(p.k.fall),  // of the path's own weight
        of_drive = simd::select(is_squeezed, times(kMostChangeOfSqueezed), times(kMostChangeOfDriven)) *
                   simd::max(fastest, drive);
    const F most = times(kMostChange) * (fastest + F(p.k.velocity_tolerance));
    return simd::select(drive > zero, simd::min(most, simd::max(of_drive, load)), most);
}

/// Solves the paths of a batch, or pieces of them, exactly; the lanes in `where` alone take the solution.
/// @param restless  becomes what SolvePaths::restless says of each lane
/// @return lanes whose active set did not settle
template <class Lanes, class Real>
typename Lanes::Mask solve_exactly(const PathBatch<Real>& p, LinkScratch<Lanes>* scratch, int most_iterations,
                                   typename Lanes::Mask where, typename Lanes::Batch& restless) {
    using F = typename Lanes::Batch;
    const SolvePaths<Real>& k = p.k;
    F heaviest, drive;  // 1/kg, m/s
    const F fastest = begin_paths<Lanes>(p, scratch, restless, heaviest, drive);
    const F inverse_mass = heaviest / F(static_cast<Real>(p.length + 1));
    // Round-off of velocities, in shares of the largest.
    const F by_speed = F(k.velocity_tolerance) + fastest * F(static_cast<Real>(4e-6)),
            by_impulse = F(k.velocity_tolerance) + fastest * F(static_cast<Real>(1e-6)),
            most = most_change<Lanes>(p, scratch, fastest, drive);
    auto bad = F(0) <= F(0);
    std::size_t from = 0;  // where nothing changes, the next iteration would come to the same
    for (int i = 0; i < most_iterations && from < p.length && simd::any(bad & where); ++i) {
        eliminate<Lanes>(p, scratch, from);
        const std::size_t stretch = i < k.bold_iterations ? 0 : i < kIterationsByPieces ? kPiece : kLongPiece;
        bad = substitute<Lanes>(p, scratch, by_speed, by_impulse, most, inverse_mass, stretch, from);
    }
    apply_changes<Lanes>(p, scratch, where & !bad);
    return bad & where;
}

}  // namespace
}  // namespace carom
