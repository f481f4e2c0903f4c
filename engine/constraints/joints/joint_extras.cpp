#include "constraints/joints/joint_system.hpp"

#include <algorithm>
#include <cmath>

// Rows of a system of joints that are no part of its tree: loops, motors and limits.

namespace carom {
namespace {

/// Share of the diagonal that keeps the complement of loops regular where their rows say the same twice.
constexpr double kLoopSoftness = 1e-9;
/// Rows may say what others say if softness may be more than FreeRows::kLittle of a pivot. What bends of a
/// substep make of the difference then becomes large impulses against each other, which move nothing but
/// count as a pull (decision 0026, geometric stiffness): they are replaced by those that move the rows alike
/// by way of this softness, which has none of them.
constexpr double kFilter = 1e-5;
/// A loop is taut if a push of its last joint along some direction moves that by less than this share of what
/// it would if the joint's two bodies were alone: a chain between two points as far apart as it is long.
constexpr double kTaut = 1e-3;
/// Softness of a taut loop in the unit of that: a spring of 1 / (softness (substep)²) times the reduced mass.
constexpr double kSoftnessOfTaut = 3e-3;

}  // namespace

/// Motors and limits that may act in this substep; rows of loops always.
void JointSystem::list_extras() {
    extras_.clear();
    for (const std::int32_t joint : loops_)
        for (int row = 0; row < rows_[static_cast<std::size_t>(joint)].firm; ++row)
            extras_.push_back({joint, row, -kUnbounded, kUnbounded});
    for (std::size_t j = 0; j < joints.size(); ++j)
        for (int k = rows_[j].firm; k < rows_[j].count; ++k) {
            const JointRow& row = rows_[j].row[static_cast<std::size_t>(k)];
            const double most = joints[j].joint->max_motor * (part_ == Part::half ? h_ / 2 : h_);
            if (row.law == RowLaw::motor) {
                extras_.push_back({static_cast<std::int32_t>(j), k, -most, most});
                continue;
            }
            // A stop that is far from being reached in this substep is left out.
            const double speed = std::fabs(row_velocity(j, k));
            const double range = joints[j].joint->has_lower && joints[j].joint->has_upper
                                     ? joints[j].joint->upper.at - joints[j].joint->lower.at
                                     : 0;
            if (row.rate == 0 && row.value > 2 * h_ * speed + 0.02 * range) continue;
            extras_.push_back({static_cast<std::int32_t>(j), k, 0, kUnbounded});
        }
}

/// The matrix of the extra rows by way of the tree, as it is factored now.
void JointSystem::couple_extras() {
    const std::size_t count = extras_.size();
    taut_.clear();
    for (Factors& factors : factors_) factors.are_known = factors.is_filter_known = false;
    if (count == 0) return;
    extra_rhs_.assign(count, 0), low_.assign(count, 0), high_.assign(count, 0);
    state_.assign(count, End::none);
    matrix_.assign(count * count, 0), alone_.assign(count, 1);
    list_parts();
    find_columns();
    // Row i of it is what columns change row i by; what is before the diagonal is after it, too.
    for (std::size_t i = 0; i < count; ++i) {
        double* row = &matrix_[i * count];
        for (const RowPart& part : parts_of(i)) {
            const double *x = columns_.of(part.body), *y = x + count, *spin = y + count;
            for (std::size_t k = 0; k <= i; ++k) row[k] += dot3(part.row, {x[k], y[k], spin[k]});
        }
        for (std::size_t k = 0; k < i; ++k) matrix_[k * count + i] = row[k];
    }
    for (std::size_t i = 0; i < count; ++i) {
        const Extra& extra = extras_[i];
        const auto j = static_cast<std::size_t>(extra.joint);
        double alone = 0;
        for_each_part(j, extra.row, [&](std::size_t body, const Vector& part) {
            alone += (bodies[body].inverse_mass * (part[0] * part[0] + part[1] * part[1]) +
                      bodies[body].inverse_inertia * part[2] * part[2]) /
                     weight_[body];
        });
        matrix_[i * count + i] += softness_[j][static_cast<std::size_t>(extra.row)];
        if (alone > 0)
            alone_[i] = alone;
        else
            matrix_[i * count + i] = 1;
    }
    if (!is_rigid_) soften_taut_loops();
}

/// A chain that is held straight between two points could carry no weight but by a pull without bound: its
/// bodies would fall, be drawn back by corrections, and gain energy by that. So a loop is a stiff spring
/// along the direction in which it is taut, as far as it is taut there.
void JointSystem::soften_taut_loops() {
    const std::size_t count = extras_.size();
    std::size_t first = 0;
    for (const std::int32_t joint : loops_) {
        const JointRows& rows = rows_[static_cast<std::size_t>(joint)];
        const auto firm = static_cast<std::size_t>(rows.firm);
        std::size_t of_points = 0;  // rows that hold points: they come before those of angles
        while (of_points < firm && rows.row[of_points].law == RowLaw::hold && rows.row[of_points].n != Vec2{})
            ++of_points;
        TautLoop loop{first, std::min<std::size_t>(of_points, 2), {1, 0}, 0, 0};
        first += firm;
        if (of_points == 0 || joints[static_cast<std::size_t>(joint)].gear >= 0) continue;
        double* block = &matrix_[loop.first * count + loop.first];
        double least = block[0], alone = alone_[loop.first];
        if (loop.rows == 2) {  // the smaller of the two eigenvalues, and its direction
            const double xx = block[0], xy = block[1], yy = block[count + 1], half = 0.5 * (xx - yy),
                         apart = std::sqrt(half * half + xy * xy);
            least = 0.5 * (xx + yy) - apart;
            loop.direction = half < 0 ? std::array{apart - half, -xy} : std::array{-xy, apart + half};
            const double length =
                std::sqrt(loop.direction[0] * loop.direction[0] + loop.direction[1] * loop.direction[1]);
            for (double& part : loop.direction) part = length > 0 ? part / length : std::sqrt(0.5);
            alone = std::fmax(alone, alone_[loop.first + 1]);
            // What nothing at all moves is no chain: the tree holds it by itself.
            if (xx + yy - least < kTaut * alone) continue;
        }
        loop.share = 1 - std::fmax(least, 0) / (kTaut * alone);
        if (!(loop.share > 0)) continue;
        loop.softness = loop.share * kSoftnessOfTaut * alone;
        for (std::size_t i = 0; i < loop.rows; ++i)
            for (std::size_t k = 0; k < loop.rows; ++k)
                block[i * count + k] += loop.softness * loop.direction[i] * loop.direction[k];
        taut_.push_back(loop);
    }
}

void JointSystem::list_parts() {
    parts_.clear(), first_part_.assign(1, 0);
    for (const Extra& extra : extras_) {
        for_each_part(static_cast<std::size_t>(extra.joint), extra.row,
                      [&](std::size_t body, const Vector& row) {
                          if (bodies[body].inverse_mass > 0) parts_.push_back({body, row});
                      });
        first_part_.push_back(parts_.size());
    }
}

/// To columns_ comes what an impulse of 1 of each extra row changes.
void JointSystem::find_columns() {
    columns_.reset(bodies.size(), extras_.size());
    for (std::size_t e = 0; e < extras_.size(); ++e)
        for (const RowPart& part : parts_of(e)) columns_.add(part.body, e, part.row);
    solve_tree_of(columns_);
}

void JointSystem::push_row(std::size_t extra, double impulse) {
    for (const RowPart& part : parts_of(extra))
        for (std::size_t c = 0; c < 3; ++c) pushed_[part.body][c] += impulse * part.row[c];
}

/// What change_ changes the velocity of an extra row by.
double JointSystem::change_of_row(std::size_t extra) const {
    double sum = 0;
    for (const RowPart& part : parts_of(extra)) sum += dot3(part.row, change_[part.body]);
    return sum;
}

/// A motor and a limit of its joint are one row, which cannot have the velocities that both ask for. Where
/// the limit is nearer than where the motor drives to, the limit decides and the motor pushes with all it
/// has; else the motor decides alone.
void JointSystem::part_motors_from_limits() {
    const std::size_t count = extras_.size();
    for (std::size_t motor = 0; motor < count; ++motor) {
        if (row_of(extras_[motor]).law != RowLaw::motor) continue;
        for (std::size_t limit = motor + 1; limit < count; ++limit) {
            if (extras_[limit].joint != extras_[motor].joint) break;
            if (state_[motor] != End::none || state_[limit] != End::none) continue;
            const double sign = matrix_[motor * count + limit] < 0 ? -1 : 1;
            const bool is_beyond = sign * extra_rhs_[motor] < extra_rhs_[limit];
            if (is_beyond)
                state_[motor] = sign < 0 ? End::high : End::low;
            else
                state_[limit] = End::low;
        }
    }
}

/// The impulses x of the extra rows, low <= x <= high, where their residual A x - b is zero between the ends,
/// >= 0 at the low and <= 0 at the high one: block principal pivoting (Júdice & Pires 1994), one row at a
/// time once blocks have not come to an end. Projected sweeps over this matrix do not converge.
///
/// Rows that are not independent may be at an end and not in turns for ever, since what is filtered is not
/// what was solved. Whole turns of such a cycle are left out: docs/decisions/0086-steps-that-stall.md.
void JointSystem::solve_bounded(Use use) {
    constexpr int kMostRounds = 64, kBlockRounds = 12;  // of all, and of whole blocks before them
    const std::size_t count = extras_.size();
    solution_.assign(count, 0);
    cycle_.begin();
    for (int round = 0; round < kMostRounds; ++round) {
        const bool is_of_blocks = round < kBlockRounds;
        if (round == kBlockRounds) cycle_.begin();
        part_motors_from_limits();
        solve_free(use);
        if (!change_ends(is_of_blocks)) return;
        round = cycle_.same_at(state_, round, (is_of_blocks ? kBlockRounds : kMostRounds) - 1);
    }
    // A cycle: what is beyond its ends is at them, and what has none is held all the same.
    for (std::size_t i = 0; i < count; ++i)
        if (solution_[i] < low_[i] || solution_[i] > high_[i])
            state_[i] = solution_[i] < low_[i] ? End::low : End::high;
    solve_free(use);
    for (std::size_t i = 0; i < count; ++i) solution_[i] = std::clamp(solution_[i], low_[i], high_[i]);
}

/// Rows that break their law go to an end, or leave it: all of them, or the first.
/// @return whether any does
bool JointSystem::change_ends(bool all) {
    const std::size_t count = extras_.size();
    bool any = false;
    for (std::size_t i = 0; i < count && (all || !any); ++i) {
        End next = state_[i];
        if (state_[i] == End::none) {
            if (solution_[i] < low_[i]) next = End::low;
            if (solution_[i] > high_[i]) next = End::high;
        } else {
            double off = -extra_rhs_[i];
            for (std::size_t k = 0; k < count; ++k) off += matrix_[i * count + k] * solution_[k];
            if (state_[i] == End::low ? off < 0 : off > 0) next = End::none;
            if (low_[i] == high_[i]) next = End::low;
        }
        any = any || next != state_[i];
        state_[i] = next;
    }
    return any;
}

/// Those that are at no end.
void JointSystem::solve_free(Use use) {
    const std::size_t count = extras_.size();
    free_.clear();
    for (std::size_t i = 0; i < count; ++i) {
        if (state_[i] == End::none)
            free_.push_back(i);
        else
            solution_[i] = state_[i] == End::low ? low_[i] : high_[i];
    }
    const std::size_t m = free_.size();
    residual_.resize(m);
    for (std::size_t i = 0; i < m; ++i) residual_[i] = extra_rhs_[free_[i]];
    for (std::size_t k = 0; k < count && m < count; ++k) {
        if (state_[k] == End::none || solution_[k] == 0) continue;
        for (std::size_t i = 0; i < m; ++i) residual_[i] -= matrix_[free_[i] * count + k] * solution_[k];
    }
    const Factors& factors = factor_free(use);
    factors.softened.solve(residual_, 1);
    if (!factors.softened.are_independent()) filter(factors, residual_, 1);
    for (std::size_t i = 0; i < m; ++i) solution_[free_[i]] = residual_[i];
}

/// The factors of the rows of free_. Those of the solve before are these where the matrix and the free rows
/// are the same: mostly in all solves of a substep.
const JointSystem::Factors& JointSystem::factor_free(Use use) {
    Factors& factors = factors_[static_cast<std::size_t>(use)];
    if (factors.are_known && std::ranges::equal(factors.softened.rows(), free_)) return factors;
    const std::size_t count = extras_.size();
    factors.softened.factor(matrix_, count, free_, alone_, kLoopSoftness, factors.are_known);
    factors.are_known = true;
    if (factors.softened.are_independent()) return factors;
    factors.filtered.factor(matrix_, count, free_, alone_, kFilter, factors.is_filter_known);
    factors.is_filter_known = true;
    return factors;
}

/// Solutions of rows that are not independent become those that move the rows alike without large impulses
/// against each other.
/// @param x  [free rows][sides]
void JointSystem::filter(const Factors& factors, std::vector<double>& x, std::size_t sides) {
    const std::size_t count = extras_.size(), m = free_.size();
    unfiltered_.assign(x.begin(), x.end());
    for (std::size_t i = 0; i < m; ++i) {
        double* row = &x[i * sides];
        std::fill(row, row + sides, 0);
        for (std::size_t k = 0; k < m; ++k) {
            const double by = matrix_[free_[i] * count + free_[k]];
            for (std::size_t s = 0; s < sides; ++s) row[s] += by * unfiltered_[k * sides + s];
        }
    }
    factors.filtered.solve(x, sides);
}

/// change_, answer_ and solution_ of the whole system from rhs_, extra_rhs_, low_ and high_: of the tree
/// alone first, then with what the extra rows push.
void JointSystem::solve_all() {
    std::fill(pushed_.begin(), pushed_.end(), Vector{});
    solve_tree();
    if (extras_.empty()) return;
    for (std::size_t i = 0; i < extras_.size(); ++i) extra_rhs_[i] -= change_of_row(i);
    solve_bounded(Use::solve);
    // Limits that are not reached push nothing: the tree answers as it did.
    if (std::ranges::all_of(solution_, [](double impulse) { return impulse == 0; })) return;
    std::fill(pushed_.begin(), pushed_.end(), Vector{});
    for (std::size_t i = 0; i < extras_.size(); ++i) push_row(i, solution_[i]);
    solve_tree();
}

}  // namespace carom
