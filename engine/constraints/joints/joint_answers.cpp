#include <algorithm>

#include "constraints/joints/joint_system.hpp"

// What impulses of others do to a system of joints.

namespace carom {

void JointSystem::list_motors(std::vector<Motor>& motors) const {
    motors.clear();
    for (std::size_t e = 0; e < extras_.size(); ++e) {
        const Extra& extra = extras_[e];
        if (row_of(extra).law != RowLaw::motor) continue;
        const auto joint = static_cast<std::size_t>(extra.joint);
        motors.push_back({e, extra.impulse, extra.low, extra.high,
                          joints[joint].joint->motor_speed - row_velocity(joint, extra.row), alone_[e]});
    }
}

void JointSystem::push_motor(const Motor& motor, double impulse, std::vector<Blow>& blows) const {
    const Extra& extra = extras_[motor.extra];
    for_each_part(static_cast<std::size_t>(extra.joint), extra.row,
                  [&](std::size_t body, const Vector& part) {
                      blows.push_back({body, {impulse * part[0], impulse * part[1], impulse * part[2]}});
                  });
}

void JointSystem::answer(std::span<const Blow> blows, Drives drives) {
    for (Vector& rhs : rhs_) rhs = {};
    const auto solve = [&](bool with_extras) {
        std::fill(pushed_.begin(), pushed_.end(), Vector{});
        for (const Blow& blow : blows)
            for (std::size_t c = 0; c < 3; ++c) pushed_[blow.body][c] += blow.impulse[c];
        for (std::size_t i = 0; with_extras && i < extras_.size(); ++i) push_row(i, solution_[i]);
        solve_tree();
    };
    solve(false);
    if (extras_.empty()) return;
    kept_state_ = state_;
    for (std::size_t i = 0; i < extras_.size(); ++i) {
        const bool is_held = holds(i, drives),
                   stops = row_of(extras_[i]).law == RowLaw::stop && state_[i] == End::none;
        low_[i] = is_held ? -kUnbounded : 0, high_[i] = is_held || stops ? kUnbounded : 0;
        state_[i] = is_held || stops ? End::none : End::low;
        extra_rhs_[i] = -change_of_row(i);
    }
    solve_bounded(Use::answer);
    if (std::ranges::any_of(solution_, [](double impulse) { return impulse != 0; })) solve(true);
    state_ = kept_state_;
}

/// Rows that hold while impulses are answered.
bool JointSystem::holds(std::size_t extra, Drives drives) const {
    const RowLaw law = row_of(extras_[extra]).law;
    return law == RowLaw::hold || law == RowLaw::spring ||
           (state_[extra] == End::none &&
            (drives == Drives::as_solved || (drives == Drives::no_motors && law == RowLaw::stop)));
}

bool JointSystem::answers_hold() const {
    std::size_t found = 0;
    for (std::size_t e = 0; e < extras_.size(); ++e) {
        if (!holds(e, Drives::no_motors)) continue;
        if (found == answered_with_.size() || answered_with_[found] != e) return false;
        ++found;
    }
    return found == answered_with_.size();
}

void JointSystem::find_answers(std::span<const std::size_t> asked, Drives drives) {
    asked_.assign(asked.begin(), asked.end());
    std::size_t sides = 3 * asked.size();
    const auto is_motor = [&](std::size_t e) { return row_of(extras_[e]).law == RowLaw::motor; };
    free_.clear();
    for (std::size_t e = 0; e < extras_.size(); ++e) {
        if (holds(e, drives)) free_.push_back(e);
        if (drives == Drives::no_motors && is_motor(e)) ++sides;
    }
    answered_with_ = free_;
    answers_.reset(bodies.size(), sides);
    for (std::size_t i = 0; i < asked.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) answers_.of(asked[i])[c * sides + 3 * i + c] = 1;
    std::size_t side = 3 * asked.size();
    for (std::size_t e = 0; side < sides && e < extras_.size(); ++e) {
        if (!is_motor(e)) continue;
        for (const RowPart& part : parts_of(e)) {
            answers_.add(part.body, side, part.row);
            asked_.push_back(part.body);
        }
        ++side;
    }
    solve_tree_of(answers_);
    if (free_.empty() || sides == 0) return;

    // What rows hold they take back.
    held_back_.assign(free_.size() * sides, 0);
    for (std::size_t i = 0; i < free_.size(); ++i)
        for (const RowPart& part : parts_of(free_[i])) {
            const double *x = answers_.of(part.body), *y = x + sides, *spin = y + sides;
            double* row = &held_back_[i * sides];
            for (std::size_t s = 0; s < sides; ++s) row[s] -= dot3(part.row, {x[s], y[s], spin[s]});
        }
    const Factors& factors = factor_free(Use::answer);
    factors.softened.solve(held_back_, sides);
    if (!factors.softened.are_independent()) filter(factors, held_back_, sides);
    std::sort(asked_.begin(), asked_.end());
    asked_.erase(std::unique(asked_.begin(), asked_.end()), asked_.end());
    for (const std::size_t body : asked_)
        for (std::size_t c = 0; c < 3; ++c) {
            double* change = answers_.of(body) + c * sides;
            for (std::size_t i = 0; i < free_.size(); ++i) {
                const double by = columns_.of(body)[c * extras_.size() + free_[i]];
                const double* row = &held_back_[i * sides];
                for (std::size_t s = 0; s < sides; ++s) change[s] += by * row[s];
            }
        }
}

double JointSystem::answer_to(std::size_t side, const Motor& motor) const {
    double sum = 0;
    for (const RowPart& part : parts_of(motor.extra)) sum += dot3(part.row, answers_.at(part.body, side));
    return sum;
}

}  // namespace carom
