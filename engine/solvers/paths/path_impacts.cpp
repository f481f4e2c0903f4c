#include "solvers/paths/path_impacts.hpp"

#include <array>
#include <cmath>

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
    double start_rim, foreseen_rim;

    StruckBody(BodyRecords<Real>& records, std::int32_t number) : row(number) {
        const Real* record = &records.velocity[4 * static_cast<std::size_t>(row)];
        const double mass = record[3];
        w = std::fabs(mass), w2 = 2 * std::fmax(mass, 0);
        foreseen = {record[0], record[1]}, foreseen_rim = record[2];
        start = foreseen, start_rim = foreseen_rim;
        if (static_cast<std::size_t>(row) >= records.count()) return;  // nothing moves it
        const auto [x, y, rim] = records.start_of_substep(row);
        start = {x, y}, start_rim = rim;
    }
};

/// @return whether there was an impact
template <class Real>
bool carry_out(const PathContact<Real>& contact, double rest_speed, double h, BodyRecords<Real>& records,
               Books& books) {
    const PathLink<Real>& link = contact.link;
    const std::size_t lane = contact.lane;
    const double e = contact.restitution;
    const StruckBody<Real> a(records, contact.near), b(records, contact.far);
    const Vec2 n{link.normal_x[lane], link.normal_y[lane]}, t{-n.y, n.x};
    const std::array<double, 3> lever_a{link.near1[lane], link.near2[lane], link.near_t[lane]},
        lever_b{link.far1[lane], link.far2[lane], link.far_t[lane]};
    const auto relative = [&](Vec2 va, double ua, Vec2 vb, double ub, std::size_t k) {
        return dot(vb - va, k < 2 ? n : t) + ub * lever_b[k] - ua * lever_a[k];
    };
    const bool has_two = link.separation2[lane] < static_cast<Real>(kNoPoint);
    const auto place_of_row = [&](std::int32_t row) {
        const auto r = static_cast<std::size_t>(row);
        return Vec2{records.displacement[2 * r], records.displacement[2 * r + 1]};
    };
    const auto turn_of = [&](std::int32_t row) {
        return static_cast<double>(records.turn()[static_cast<std::size_t>(row)]);
    };
    std::array<double, 2> v{};
    std::array<bool, 2> meets{};  // what is not met yet has an impact of its own, later
    for (std::size_t k = 0; k < 2; ++k) {
        v[k] = relative(a.start, a.start_rim, b.start, b.start_rim, k);
        if (k == 1 && !has_two) break;
        const double gap = static_cast<double>(k == 0 ? link.separation1[lane] : link.separation2[lane]) +
                           relative(place_of_row(contact.near), turn_of(contact.near),
                                    place_of_row(contact.far), turn_of(contact.far), k);
        const double soon = relative(a.foreseen, a.foreseen_rim, b.foreseen, b.foreseen_rim, k);
        meets[k] = v[k] < -rest_speed && gap + h * soon < 0;
    }
    if (!meets[0] && !meets[1]) return false;
    const double w = a.w + b.w;
    const auto mass = [&](std::size_t i, std::size_t k) {
        return (i < 2) == (k < 2) ? w + a.w2 * lever_a[i] * lever_a[k] + b.w2 * lever_b[i] * lever_b[k]
                                  : a.w2 * lever_a[i] * lever_a[k] + b.w2 * lever_b[i] * lever_b[k];
    };
    const double k11 = mass(0, 0), k12 = mass(0, 1), k22 = mass(1, 1);
    // Newton's law of what is met: each point leaves at e times the speed it came with, or faster.
    const double b1 = (1 + e) * v[0], b2 = (1 + e) * v[1];
    std::array<double, 2> x{};
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
    const double work =
        x[0] * (v[0] + 0.5 * (k11 * x[0] + k12 * x[1])) + x[1] * (v[1] + 0.5 * (k12 * x[0] + k22 * x[1]));
    const double sum = x[0] + x[1];
    const double vt = relative(a.start, a.start_rim, b.start, b.start_rim, 2) + mass(0, 2) * x[0] +
                      mass(1, 2) * x[1],
                 ktt = mass(2, 2), limit = static_cast<double>(link.friction[lane]) * sum;
    const double y = std::fmin(std::fmax(-vt / ktt, -limit), limit);
    const Vec2 impulse = sum * n + y * t;
    const auto give = [&](const StruckBody<Real>& body, double sign, const std::array<double, 3>& lever) {
        if (!(body.w > 0)) return;
        const Vec2 dv = (sign * body.w) * impulse;
        records.add_velocity(body.row, dv,
                             sign * body.w2 * (lever[0] * x[0] + lever[1] * x[1] + lever[2] * y));
    };
    give(a, -1, lever_a), give(b, 1, lever_b);
    if (contact.partner.is_wall()) books.wall_impulse += sum;
    if (!books.is_open) return true;
    books.restitution += work, books.friction += y * (vt + 0.5 * ktt * y);
    const bool is_far_moved = b.w > 0, is_near_moved = a.w > 0;
    if (is_far_moved && is_near_moved) return true;
    // What nothing moves: the energy that its own motion gives the other body comes from outside.
    const StruckBody<Real>& still = is_far_moved ? a : b;
    const std::array<double, 3>& lever = is_far_moved ? lever_a : lever_b;
    const Vec2 on_still = is_far_moved ? -impulse : impulse;
    const double spin = (is_far_moved ? -1 : 1) * (lever[0] * x[0] + lever[1] * x[1] + lever[2] * y);
    books.drive -= dot(on_still, still.start) + still.start_rim * spin;
    (contact.partner.is_wall() ? books.wall_momentum : books.immovable_momentum) -= on_still;
    return true;
}

}  // namespace

template <class Real>
std::int64_t carry_out_impacts(const PathSolver<Real>& paths, const SubstepTerms& terms,
                               BodyRecords<Real>& records, Books& books) {
    const double rest_speed = kRestFalls * terms.fall_speed();
    std::int64_t impacts = 0;
    bool goes_on = true;
    for (int round = 0; round < kRounds && goes_on; ++round) {
        goes_on = false;
        paths.for_each([&](const PathContact<Real>& contact) {
            const bool is_pressed =
                contact.link.normal1[contact.lane] + contact.link.normal2[contact.lane] > 0;
            if (!(contact.restitution > 0) || is_pressed) return;
            if (!carry_out(contact, rest_speed, terms.substep_dt, records, books)) return;
            ++impacts, goes_on = true;
        });
    }
    return impacts;
}

template std::int64_t carry_out_impacts(const PathSolver<float>&, const SubstepTerms&, BodyRecords<float>&,
                                        Books&);
template std::int64_t carry_out_impacts(const PathSolver<double>&, const SubstepTerms&, BodyRecords<double>&,
                                        Books&);

}  // namespace carom
