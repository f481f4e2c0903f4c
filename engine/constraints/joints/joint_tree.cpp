#include "constraints/joints/joint_system.hpp"

#include <algorithm>
#include <cmath>

// The tree of a system of joints: elimination, leaves first.

namespace carom {
namespace {

/// A pivot below this share of its diagonal is that of a row which says what others say.
constexpr double kRedundant = 1e-12;
/// What a body is along one direction, beside the diagonal that the bodies it carries give it: less is
/// round-off, which may be zero or below where they are 1e15 times as heavy as it.
constexpr double kLeastPivot = 1e-15;

std::size_t index_of(std::int32_t body) {
    return static_cast<std::size_t>(body);
}

}  // namespace

/// By elimination, xx first; a body that nothing turns has an infinite zz.
JointSystem::Symmetric JointSystem::inverse_of(const Symmetric& m) {
    const double l1 = m.xy / m.xx, l2 = m.xz / m.xx, d1 = std::max(m.yy - l1 * m.xy, kLeastPivot * m.yy),
                 e = m.yz - l2 * m.xy, l3 = e / d1,
                 d2 = std::max(m.zz - l2 * m.xz - l3 * e, kLeastPivot * m.zz);
    const double i0 = 1 / m.xx, i1 = 1 / d1, i2 = 1 / d2, m2 = l1 * l3 - l2;
    return {
        i0 + l1 * l1 * i1 + m2 * m2 * i2, -l1 * i1 - m2 * l3 * i2, m2 * i2, i1 + l3 * l3 * i2, -l3 * i2, i2};
}

void JointSystem::factor_link(Link& link) {
    const auto j = static_cast<std::size_t>(link.joint);
    link.rows = rows_[j].firm;
    for (int k = 0; k < link.rows; ++k) {
        const auto i = static_cast<std::size_t>(k);
        link.own[i] = row_of_body(j, k, link.is_b), link.others[i] = row_of_body(j, k, !link.is_b);
        link.reach[i] = times(link.inverse, link.own[i]);
    }
    const auto entry = [&](std::size_t i, std::size_t k) { return dot3(link.own[i], link.reach[k]); };
    link.inverse_d = {};
    const auto pivot = [&](std::size_t i, double value, double full) {
        link.inverse_d[i] = value > kRedundant * full ? 1 / value : 0;
    };
    const double d0 = entry(0, 0) + softness_[j][0];
    pivot(0, d0, d0);
    if (link.rows == 1) return;
    link.l10 = entry(1, 0) * link.inverse_d[0];
    const double k11 = entry(1, 1) + softness_[j][1], d1 = k11 - link.l10 * link.l10 * d0;
    pivot(1, d1, k11);
    if (link.rows == 2) return;
    link.l20 = entry(2, 0) * link.inverse_d[0];
    const double off = entry(2, 1) - link.l20 * link.l10 * d0;
    link.l21 = off * link.inverse_d[1];
    const double k22 = entry(2, 2) + softness_[j][2];
    pivot(2, k22 - link.l20 * link.l20 * d0 - link.l21 * off, k22);
}

/// J_p^T (L D L^T)^-1 J_p = sum of z z^T / d over the rows z of L^-1 J_p.
void JointSystem::add_to_parent(const Link& link) {
    Symmetric& to = inertia_[static_cast<std::size_t>(link.parent)];
    std::array<Vector, 3> z = link.others;
    for (std::size_t c = 0; c < 3; ++c) {
        if (link.rows > 1) z[1][c] -= link.l10 * z[0][c];
        if (link.rows > 2) z[2][c] -= link.l20 * z[0][c] + link.l21 * z[1][c];
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(link.rows); ++i) {
        const double d = link.inverse_d[i];
        to.xx += d * z[i][0] * z[i][0], to.xy += d * z[i][0] * z[i][1], to.xz += d * z[i][0] * z[i][2];
        to.yy += d * z[i][1] * z[i][1], to.yz += d * z[i][1] * z[i][2], to.zz += d * z[i][2] * z[i][2];
    }
}

void JointSystem::factor_tree() {
    constexpr double kNeverTurns = 1e30;  // m², inertia over mass of a body of fixed rotation
    for (const Link& link : links_) {
        const SystemBody& body = bodies[static_cast<std::size_t>(link.body)];
        const double mass = 1 / body.inverse_mass, inertia = body.seen_inverse_inertia > 0
                                                                 ? 1 / body.seen_inverse_inertia
                                                                 : kNeverTurns * mass;
        const double weight = weight_[static_cast<std::size_t>(link.body)];
        inertia_[static_cast<std::size_t>(link.body)] = {weight * mass, 0, 0,
                                                         weight * mass, 0, weight * inertia};
    }
    for (std::size_t i = links_.size(); i-- > 0;) {
        Link& link = links_[i];
        link.inverse = inverse_of(inertia_[static_cast<std::size_t>(link.body)]);
        if (link.joint < 0) continue;
        factor_link(link);
        if (link.parent_moves) add_to_parent(link);
    }
}

template <int kRows>
void JointSystem::solve_block(const Link& link, Vector& e) {
    if constexpr (kRows > 1) e[1] -= link.l10 * e[0];
    if constexpr (kRows > 2) e[2] -= link.l20 * e[0] + link.l21 * e[1];
    for (std::size_t i = 0; i < kRows; ++i) e[i] *= link.inverse_d[i];
    if constexpr (kRows > 2) e[1] -= link.l21 * e[2], e[0] -= link.l20 * e[2];
    if constexpr (kRows > 1) e[0] -= link.l10 * e[1];
}

/// What a body hands on to its parent: its joint's answer, were the parent to stand still.
template <int kRows>
void JointSystem::go_in(Link& link) {
    const Vector& own = pushed_[static_cast<std::size_t>(link.body)];
    Vector e = rhs_[static_cast<std::size_t>(link.joint)];
    for (std::size_t i = 0; i < kRows; ++i) e[i] -= dot3(link.reach[i], own);
    solve_block<kRows>(link, e);
    link.half_way = e;
    if (!link.parent_moves) return;
    Vector& to = pushed_[static_cast<std::size_t>(link.parent)];
    for (std::size_t i = 0; i < kRows; ++i)
        for (std::size_t c = 0; c < 3; ++c) to[c] += link.others[i][c] * e[i];
}

/// What it answers when the parent has moved.
template <int kRows>
void JointSystem::go_out(Link& link) {
    Vector total = pushed_[static_cast<std::size_t>(link.body)], answer = link.half_way;
    if (link.parent_moves) {
        const Vector& parent = change_[static_cast<std::size_t>(link.parent)];
        Vector e{};
        for (std::size_t i = 0; i < kRows; ++i) e[i] = dot3(link.others[i], parent);
        solve_block<kRows>(link, e);
        for (std::size_t i = 0; i < kRows; ++i) answer[i] -= e[i];
    }
    for (std::size_t i = 0; i < kRows; ++i)
        for (std::size_t c = 0; c < 3; ++c) total[c] += link.own[i][c] * answer[i];
    answer_[static_cast<std::size_t>(link.joint)] = answer;
    change_[static_cast<std::size_t>(link.body)] = times(link.inverse, total);
}

void JointSystem::solve_tree() {
    for (std::size_t q = links_.size(); q-- > 0;) {
        Link& link = links_[q];
        if (link.joint < 0) continue;
        if (link.rows == 1) go_in<1>(link);
        if (link.rows == 2) go_in<2>(link);
        if (link.rows == 3) go_in<3>(link);
    }
    for (Link& link : links_) {
        if (link.joint < 0)
            change_[static_cast<std::size_t>(link.body)] =
                times(link.inverse, pushed_[static_cast<std::size_t>(link.body)]);
        else if (link.rows == 1)
            go_out<1>(link);
        else if (link.rows == 2)
            go_out<2>(link);
        else
            go_out<3>(link);
    }
}

/// What one body hands on to its parent, for all sides. Its half way is kept by row and side.
template <int kRows>
void JointSystem::go_in_sides(const Link& link, double* half_way, Sides& sides) {
    const Link at = link;  // a copy, so that what is written is no part of it
    const std::size_t n = sides.count;
    const double *x = sides.of(index_of(at.body)), *y = x + n, *spin = y + n;
    for (std::size_t s = 0; s < n; ++s) {
        Vector e{};
        for (std::size_t i = 0; i < kRows; ++i) e[i] = -dot3(at.reach[i], {x[s], y[s], spin[s]});
        solve_block<kRows>(at, e);
        for (std::size_t i = 0; i < kRows; ++i) half_way[i * n + s] = e[i];
    }
    if (!at.parent_moves) return;
    double *to_x = sides.of(index_of(at.parent)), *to_y = to_x + n, *to_spin = to_y + n;
    for (std::size_t s = 0; s < n; ++s)
        for (std::size_t i = 0; i < kRows; ++i) {
            const double e = half_way[i * n + s];
            to_x[s] += at.others[i][0] * e, to_y[s] += at.others[i][1] * e, to_spin[s] += at.others[i][2] * e;
        }
}

/// What it answers when the parent has moved.
template <int kRows>
void JointSystem::go_out_sides(const Link& link, double* half_way, Sides& sides) {
    const Link at = link;
    const std::size_t n = sides.count;
    if (at.parent_moves) {
        const double *x = sides.of(index_of(at.parent)), *y = x + n, *spin = y + n;
        for (std::size_t s = 0; s < n; ++s) {
            Vector e{};
            for (std::size_t i = 0; i < kRows; ++i) e[i] = dot3(at.others[i], {x[s], y[s], spin[s]});
            solve_block<kRows>(at, e);
            for (std::size_t i = 0; i < kRows; ++i) half_way[i * n + s] -= e[i];
        }
    }
    double *x = sides.of(index_of(at.body)), *y = x + n, *spin = y + n;
    for (std::size_t s = 0; s < n; ++s) {
        Vector total{x[s], y[s], spin[s]};
        for (std::size_t i = 0; i < kRows; ++i) {
            const double answer = half_way[i * n + s];
            for (std::size_t c = 0; c < 3; ++c) total[c] += at.own[i][c] * answer;
        }
        const Vector change = times(at.inverse, total);
        x[s] = change[0], y[s] = change[1], spin[s] = change[2];
    }
}

/// solve_tree for all sides at once, of which rows lack nothing: what pushes bodies becomes what changes
/// their velocities. Loops run over sides, which lie side by side.
void JointSystem::solve_tree_of(Sides& sides) {
    const std::size_t n = sides.count;
    // Never less: what resize adds it clears, and sides are now more, now fewer.
    half_way_.resize(std::max(half_way_.size(), links_.size() * 3 * n));
    for (std::size_t q = links_.size(); q-- > 0;) {
        const Link& link = links_[q];
        double* half_way = &half_way_[q * 3 * n];
        if (link.joint < 0) continue;
        if (link.rows == 1) go_in_sides<1>(link, half_way, sides);
        if (link.rows == 2) go_in_sides<2>(link, half_way, sides);
        if (link.rows == 3) go_in_sides<3>(link, half_way, sides);
    }
    for (std::size_t q = 0; q < links_.size(); ++q) {
        const Link& link = links_[q];
        double* half_way = &half_way_[q * 3 * n];
        if (link.joint < 0)
            go_out_sides<0>(link, half_way, sides);
        else if (link.rows == 1)
            go_out_sides<1>(link, half_way, sides);
        else if (link.rows == 2)
            go_out_sides<2>(link, half_way, sides);
        else
            go_out_sides<3>(link, half_way, sides);
    }
}

}  // namespace carom
