#include "constraints/joints/joint_system.hpp"

#include <algorithm>
#include <cmath>

// Rows of a system of joints that are no part of its tree: loops, motors and limits.

namespace carom {
namespace {

/// Share of the diagonal that keeps the complement of loops regular where their rows say the same twice.
constexpr double kLoopSoftness = 1e-9;
/// A row whose pivot is little more than what softness leaves of it says what others say, and pushes nothing:
/// else what bends make of the difference would become large impulses against each other, which move nothing
/// but count as a pull (decision 0026, geometric stiffness).
constexpr double kDependent = 3;
/// Rows are eliminated in another order if one is dependent, or a pivot below this share of its own diagonal.
constexpr double kPoor = 1e-6;
constexpr double kNeverGivesWay = 1e30;  // pivot of such a row, in its own diagonals

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
                                     ? joints[j].joint->upper - joints[j].joint->lower
                                     : 0;
            if (row.value > 2 * h_ * speed + 0.02 * range) continue;
            extras_.push_back({static_cast<std::int32_t>(j), k, 0, kUnbounded});
        }
    const std::size_t count = extras_.size();
    if (count == 0) return;
    extra_rhs_.assign(count, 0), low_.assign(count, 0), high_.assign(count, 0);
    state_.assign(count, End::none);
    matrix_.assign(count * count, 0), alone_.assign(count, 1);
    if (columns_.size() < count) columns_.resize(count);
    for (Vector& rhs : rhs_) rhs = {};
    for (std::size_t i = 0; i < count; ++i) add_column(i);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < count; ++k)
            matrix_[i * count + k] = change_of_row(extras_[i], columns_[k]);
    for (std::size_t i = 0; i < count; ++i) {
        const Extra& extra = extras_[i];
        const auto j = static_cast<std::size_t>(extra.joint);
        double alone = 0;
        for_each_part(j, extra.row, [&](std::size_t body, const Vector& part) {
            alone += bodies[body].inverse_mass * (part[0] * part[0] + part[1] * part[1]) +
                     bodies[body].inverse_inertia * part[2] * part[2];
        });
        matrix_[i * count + i] += kLoopSoftness * alone + softness_[j][static_cast<std::size_t>(extra.row)];
        if (alone > 0)
            alone_[i] = alone;
        else
            matrix_[i * count + i] = 1;
    }
}

void JointSystem::push_row(const Extra& extra, double impulse) {
    for_each_part(static_cast<std::size_t>(extra.joint), extra.row,
                  [&](std::size_t body, const Vector& part) {
                      for (std::size_t c = 0; c < 3; ++c) pushed_[body][c] += impulse * part[c];
                  });
}

void JointSystem::add_column(std::size_t extra) {
    std::fill(pushed_.begin(), pushed_.end(), Vector{});
    push_row(extras_[extra], 1);
    solve_tree();
    columns_[extra] = change_;
}

/// change holds nothing for bodies that do not move.
double JointSystem::change_of_row(const Extra& extra, const std::vector<Vector>& change) const {
    double sum = 0;
    for_each_part(static_cast<std::size_t>(extra.joint), extra.row,
                  [&](std::size_t body, const Vector& part) {
                      if (bodies[body].inverse_mass > 0) sum += dot3(part, change[body]);
                  });
    return sum;
}

/// The impulses x of the extra rows, low <= x <= high, where their residual A x - b is zero between the ends,
/// >= 0 at the low and <= 0 at the high one: block principal pivoting (Júdice & Pires 1994), one row at a
/// time once blocks have not come to an end. Projected sweeps over this matrix do not converge.
void JointSystem::solve_bounded() {
    constexpr int kMostRounds = 64, kBlockRounds = 12;
    const std::size_t count = extras_.size();
    solution_.assign(count, 0);
    for (int round = 0; round < kMostRounds; ++round) {
        solve_free();
        bool any = false;
        for (std::size_t i = 0; i < count && !(any && round >= kBlockRounds); ++i) {
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
        if (!any) return;
    }
    for (std::size_t i = 0; i < count; ++i)  // a cycle: what is there, within its ends
        solution_[i] = std::clamp(solution_[i], low_[i], high_[i]);
}

/// Those that are at no end, by L D L^T.
void JointSystem::solve_free() {
    const std::size_t count = extras_.size();
    free_.clear();
    for (std::size_t i = 0; i < count; ++i) {
        if (state_[i] == End::none)
            free_.push_back(i);
        else
            solution_[i] = state_[i] == End::low ? low_[i] : high_[i];
    }
    if (!factor_free()) order_free(), factor_free();
    const std::size_t m = free_.size();
    residual_.resize(m);
    for (std::size_t i = 0; i < m; ++i) {
        double rest = extra_rhs_[free_[i]];
        for (std::size_t k = 0; k < count; ++k)
            if (state_[k] != End::none) rest -= matrix_[free_[i] * count + k] * solution_[k];
        residual_[i] = rest;
    }
    for (std::size_t i = 0; i < m; ++i)
        for (std::size_t k = 0; k < i; ++k) residual_[i] -= factor_[i * m + k] * residual_[k];
    for (std::size_t i = 0; i < m; ++i) residual_[i] /= factor_[i * m + i];
    for (std::size_t i = m; i-- > 0;) {
        for (std::size_t k = i + 1; k < m; ++k) residual_[i] -= factor_[k * m + i] * residual_[k];
        solution_[free_[i]] = residual_[i];
    }
}

void JointSystem::read_free() {
    const std::size_t count = extras_.size(), m = free_.size();
    factor_.resize(m * m);
    for (std::size_t i = 0; i < m; ++i)
        for (std::size_t k = 0; k < m; ++k) factor_[i * m + k] = matrix_[free_[i] * count + free_[k]];
}

/// L below the diagonal, D on it, of the rows in the order of free_. Those that depend on the ones before get
/// no part in it. @return whether all pivots were good
bool JointSystem::factor_free() {
    read_free();
    const std::size_t m = free_.size();
    by_softness_.resize(m);
    bool is_good = true;
    for (std::size_t c = 0; c < m; ++c) {
        for (std::size_t k = 0; k < c; ++k) {
            const double f = factor_[c * m + k] * factor_[k * m + k];
            for (std::size_t r = c; r < m; ++r) factor_[r * m + c] -= factor_[r * m + k] * f;
        }
        double& pivot = factor_[c * m + c];
        const double alone = alone_[free_[c]];
        by_softness_[c] = kLoopSoftness * alone;
        for (std::size_t k = 0; k < c; ++k)
            by_softness_[c] += factor_[c * m + k] * factor_[c * m + k] * by_softness_[k];
        is_good = is_good && pivot > std::fmax(kPoor * alone, kDependent * by_softness_[c]);
        if (!(pivot > kDependent * by_softness_[c])) pivot = kNeverGivesWay * alone;
        for (std::size_t r = c + 1; r < m; ++r) factor_[r * m + c] /= pivot;
    }
    return is_good;
}

/// Sorts free_ so that the row with the largest share of its own diagonal left comes next: a row of which
/// little is left, for lack of a lever, would make what depends on it soft.
void JointSystem::order_free() {
    read_free();
    const std::size_t m = free_.size();
    for (std::size_t c = 0; c < m; ++c) {
        std::size_t best = c;
        const auto left = [&](std::size_t i) { return factor_[i * m + i] / alone_[free_[i]]; };
        for (std::size_t i = c + 1; i < m; ++i)
            if (left(i) > left(best)) best = i;
        if (!(left(best) > 0)) return;
        std::swap(free_[c], free_[best]);
        for (std::size_t k = 0; k < m; ++k) std::swap(factor_[c * m + k], factor_[best * m + k]);
        for (std::size_t r = 0; r < m; ++r) std::swap(factor_[r * m + c], factor_[r * m + best]);
        for (std::size_t r = c + 1; r < m; ++r) {
            const double f = factor_[r * m + c] / factor_[c * m + c];
            for (std::size_t k = c + 1; k < m; ++k) factor_[r * m + k] -= f * factor_[c * m + k];
        }
    }
}

/// change_, answer_ and solution_ of the whole system from rhs_, extra_rhs_, low_ and high_: of the tree
/// alone first, then with what the extra rows push.
void JointSystem::solve_all() {
    std::fill(pushed_.begin(), pushed_.end(), Vector{});
    solve_tree();
    if (extras_.empty()) return;
    for (std::size_t i = 0; i < extras_.size(); ++i) extra_rhs_[i] -= change_of_row(extras_[i], change_);
    solve_bounded();
    std::fill(pushed_.begin(), pushed_.end(), Vector{});
    for (std::size_t i = 0; i < extras_.size(); ++i) push_row(extras_[i], solution_[i]);
    solve_tree();
}

}  // namespace carom
