#include <algorithm>
#include <cmath>
#include <utility>

#include "constraints/joints/gear_value.hpp"
#include "constraints/joints/joint_laws.hpp"
#include "constraints/joints/joint_system.hpp"

// How far a system of joints is off what it holds is taken away by displacements, which give no velocity.

namespace carom {
namespace {

/// Largest correction of a joint or displacement of a body at once, in lengths of the system; of turns in
/// radians.
constexpr double kLargestCorrection = 0.1;
/// Share of what a taut loop is too long by beyond the stretch of its spring that is corrected at once.
constexpr double kSlowly = 0.02;
/// Times that bodies which corrections would displace too far are made heavier.
constexpr int kMostWeightings = 4;
/// Displacements that are longer, in lengths of the system, bend rows; and times that they are halved at most
/// while they make errors larger.
constexpr double kBent = 1e-3;
constexpr int kMostHalvings = 5;
/// Joints of loops that were open by less, in lengths of the system, agree on what is rigid.
constexpr double kAgree = 1e-5;
/// Share of them that is taken where something heavy presses.
constexpr double kShareOfLoaded = 0.1;

}  // namespace

/// The least displacements, as masses count them, that take a share of all errors away.
void JointSystem::find_displacements(double share) {
    for (std::size_t j = 0; j < joints.size(); ++j)
        for (int k = 0; k < rows_[j].firm; ++k) {
            const JointRow& row = rows_[j].row[static_cast<std::size_t>(k)];
            rhs_[j][static_cast<std::size_t>(k)] = row.law == RowLaw::hold ? -share * row.value : 0;
        }
    for (std::size_t e = 0; e < extras_.size(); ++e) {
        const JointRow& row = row_of(extras_[e]);
        const bool is_firm = row.law == RowLaw::hold || row.law == RowLaw::spring;
        const bool acts = is_firm || (row.law == RowLaw::stop && row.value < 0);
        low_[e] = is_firm ? -kUnbounded : 0, high_[e] = acts ? kUnbounded : 0;
        extra_rhs_[e] = acts && row.law != RowLaw::spring ? -share * row.value : 0;
        state_[e] = acts ? End::none : End::low;
    }
    for (const TautLoop& loop : taut_) {
        const double rigid = 1 - loop.share, rate = kSlowly + (1 - kSlowly) * rigid * rigid * rigid * rigid,
                     error = along(loop, [&](std::size_t e) { return row_of(extras_[e]).value; }),
                     stretch = -h_ * loop.softness *
                               along(loop, [&](std::size_t e) { return pulled_of(extras_[e]); }),
                     left_to_spring = error - rate * (error - stretch);
        for (std::size_t k = 0; k < loop.rows; ++k)
            extra_rhs_[loop.first + k] += share * left_to_spring * loop.direction[k];
    }
    solve_all();
    if (!loads.empty()) press_loads();
}

/// What presses gives way to displacements, and holds what cannot do without it: to change_ come those by
/// pushes with which no body comes deeper into what presses on it.
void JointSystem::press_loads() {
    const std::size_t count = loads.size();
    alone_displacements_ = change_;
    const auto change_at = [&](const Load& load, const std::vector<Vector>& change) {
        return dot3(load.along, change[static_cast<std::size_t>(load.body)]);
    };
    pushes_.reset(count);
    bool is_pushed = false;
    for (std::size_t i = 0; i < count; ++i) {
        loads[i].push = 0;
        pushes_.lack[i] = -std::fmax(loads[i].separation, 0) - change_at(loads[i], alone_displacements_);
        is_pushed = is_pushed || pushes_.lack[i] > 0;
    }
    if (!is_pushed) return;
    loaded_.clear();
    for (const Load& load : loads) {
        const auto body = static_cast<std::size_t>(load.body);
        if (std::find(loaded_.begin(), loaded_.end(), body) == loaded_.end()) loaded_.push_back(body);
    }
    find_answers(loaded_, Drives::as_solved);
    const auto first_side_of = [&](const Load& load) {
        return static_cast<std::size_t>(
            3 * (std::find(loaded_.begin(), loaded_.end(), static_cast<std::size_t>(load.body)) -
                 loaded_.begin()));
    };
    for (std::size_t k = 0; k < count; ++k) {
        const Load& b = loads[k];
        const std::size_t side = first_side_of(b);
        for (std::size_t i = 0; i < count; ++i) {
            const Load& a = loads[i];
            double inverse = 0;
            for (std::size_t c = 0; c < 3; ++c)
                inverse += b.along[c] * dot3(a.along, answer_to(side + c, static_cast<std::size_t>(a.body)));
            if (a.other == b.other)
                inverse += a.inverse_mass *
                               (a.other_along[0] * b.other_along[0] + a.other_along[1] * b.other_along[1]) +
                           a.inverse_inertia * a.other_along[2] * b.other_along[2];
            pushes_.inverse_mass(i, k) = inverse;
        }
    }
    pushes_.solve([](std::size_t, double wanted) { return std::fmax(wanted, 0); }, 0);
    blows_.clear();
    for (std::size_t i = 0; i < count; ++i) {
        loads[i].push = pushes_.given[i];
        const auto [x, y, spin] = loads[i].along;
        if (const double push = loads[i].push; push > 0)
            blows_.push_back({static_cast<std::size_t>(loads[i].body), {push * x, push * y, push * spin}});
    }
    answer(blows_, Drives::as_solved);
    for (std::size_t body = 0; body < change_.size(); ++body)
        for (std::size_t c = 0; c < 3; ++c) change_[body][c] += alone_displacements_[body][c];
}

/// How far a body is displaced [m]; a turn counts as the way of a point at a distance of `length`.
double JointSystem::displacement_of(const Link& link, double length) const {
    const Vector& change = change_[static_cast<std::size_t>(link.body)];
    return std::fmax(std::fmax(std::fabs(change[0]), std::fabs(change[1])), length * std::fabs(change[2]));
}

/// Displacements that the rows at the present positions still hold for. A chain that is nearly straight is
/// shortened by a little way of the heavy body at its end, or by a long one of its light links across it, of
/// which the rows are untrue: what would be displaced too far counts as heavier, until all rows are kept by
/// displacements that are small. What is too far even then, as of rods that cannot all have their length, is
/// taken in part.
/// @param most  m  @param length  as displacement_of has it
/// @return the share of change_ to take
double JointSystem::find_small_displacements(double share, double most, double length) {
    find_displacements(share);
    double way = farthest_displacement(length);
    const bool is_far = way > most;
    for (int round = 0; round < kMostWeightings && way > most; ++round) {
        for (const Link& link : links_) {
            const double excess = displacement_of(link, length) / most;
            if (excess > 1) weight_[static_cast<std::size_t>(link.body)] *= excess * excess;
        }
        factor();
        find_displacements(share);
        way = farthest_displacement(length);
    }
    if (is_far) std::fill(weight_.begin(), weight_.end(), 1.0);
    is_weighted_ = is_far;
    return way > most ? most / way : 1;
}

double JointSystem::farthest_displacement(double length) const {
    double way = 0;
    for (const Link& link : links_) way = std::fmax(way, displacement_of(link, length));
    return way;
}

/// Displaces the bodies by a share of change_.
void JointSystem::displace(double share) {
    for (const Link& link : links_) {
        SystemBody& body = bodies[static_cast<std::size_t>(link.body)];
        const Vector& change = change_[static_cast<std::size_t>(link.body)];
        body.pose.position += share * Vec2{change[0], change[1]};
        turn_pose(body.pose, share * change[2]);
    }
}

/// The values of all rows where the bodies are now.
void JointSystem::measure_values() {
    std::array<double, 3> values;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const JointPose &a = bodies[static_cast<std::size_t>(joints[j].a)].pose,
                        &b = bodies[static_cast<std::size_t>(joints[j].b)].pose;
        JointRows& rows = rows_[j];
        if (joints[j].gear < 0)
            values_of(*joints[j].joint, a, b, rows, values);
        else
            values[0] = value_of_gear(gears_[static_cast<std::size_t>(joints[j].gear)],
                                      [&](std::int32_t body) -> const JointPose& {
                                          return bodies[static_cast<std::size_t>(body)].pose;
                                      });
        for (std::size_t k = 0; k < static_cast<std::size_t>(rows.firm); ++k) rows.row[k].value = values[k];
        if (rows.count == rows.firm) continue;
        const JointRows now = rows_of(*joints[j].joint, a, b, until_end_);
        for (std::size_t k = static_cast<std::size_t>(rows.firm); k < static_cast<std::size_t>(rows.count);
             ++k)
            rows.row[k].value = now.row[k].value;
    }
}

/// The sum of the squares of all errors of what is held, and of limits that are passed [m²]; an angle counts
/// with its arm.
double JointSystem::sum_of_errors() const {
    double sum = 0;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const double arm_squared =
            length_squared(bodies[static_cast<std::size_t>(joints[j].b)].pose.position -
                           bodies[static_cast<std::size_t>(joints[j].a)].pose.position);
        for (std::size_t k = 0; k < static_cast<std::size_t>(rows_[j].count); ++k) {
            const JointRow& row = rows_[j].row[k];
            const bool is_off = row.law == RowLaw::hold || (row.law == RowLaw::stop && row.value < 0);
            if (is_off) sum += (row.n == Vec2{} ? arm_squared : 1) * row.value * row.value;
        }
    }
    return sum;
}

/// Where joints that close loops were open, the rows of before the correction say of the loop what is not so
/// (docs/decisions/0072-welded-loops.md).
bool JointSystem::correct_positions(double least, double length) {
    if (!correct_once(least, length)) return false;
    if (closes_loops_ && largest_error_ > kAgree * length) measure_anew();
    return true;
}

/// Rows where the bodies are now, and their factors; impulses go on. The impulse of a joint that is still
/// open acts on both bodies half way between its anchors. At its own anchor on each it would be a couple,
/// which turns even what joints hold rigid, and the last joint of a loop seemed to have a lever to hold.
void JointSystem::measure_anew() {
    measure_rows();
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const JointType type = joints[j].joint->type;
        if (type != JointType::revolute && type != JointType::weld) continue;
        JointRows& rows = rows_[j];
        const Vec2 half = 0.5 * Vec2{rows.row[0].value, rows.row[1].value};
        for (JointRow& row : std::span(rows.row).first(2))
            row.ja += cross(half, row.n), row.jb -= cross(half, row.n);
    }
    factor_tree();
    kept_extras_ = extras_;
    list_extras();
    couple_extras();
    recall_extras();
    limit_pulls();
}

bool JointSystem::correct_once(double least, double length) {
    double worst = largest_error_;
    for (const Extra& extra : extras_) {
        const JointRow& row = row_of(extra);
        const double arm = row.n == Vec2{} ? length : 1;  // of an angle
        if (row.law == RowLaw::stop) worst = std::fmax(worst, -arm * row.value);
    }
    if (!(worst > least)) return false;
    const double most = kLargestCorrection * length;
    double share = find_small_displacements(std::fmin(1, most / worst), most, length);
    const bool may_bend = share * farthest_displacement(length) > kBent * length;
    if (may_bend && !loads.empty()) share = std::fmin(share, kShareOfLoaded);
    if (!may_bend) {
        displace(share);
        measure_values();
    } else {
        // The rows are untrue for long ways: what would make errors larger is too long.
        const double before = sum_of_errors();
        kept_poses_.clear();
        for (const SystemBody& body : bodies) kept_poses_.push_back(body.pose);
        for (int round = 0;; ++round) {
            displace(share);
            measure_values();
            if (!(sum_of_errors() > before) || round == kMostHalvings) break;
            for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].pose = kept_poses_[i];
            share *= 0.5;
        }
    }
    for (Load& load : loads) load.push *= share;
    // Paths begin where the bodies are now: else velocities would take the correction back.
    if (std::exchange(is_weighted_, false)) factor();
    std::fill(state_.begin(), state_.end(), End::none);
    return true;
}

}  // namespace carom
