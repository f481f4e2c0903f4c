#include "constraints/joints/joint_system.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "constraints/joints/gear_value.hpp"
#include "constraints/joints/joint_laws.hpp"

namespace carom {
namespace {

/// Springs without damping have no compliance; this takes its place.
constexpr double kLeastGamma = 1e-12;

}  // namespace

void JointSystem::plan() {
    std::vector<std::vector<std::int32_t>> joints_of(bodies.size());
    const auto has_rows = [&](std::size_t j) {
        const StoredJoint& joint = *joints[j].joint;
        return joint.type != JointType::target && (joint.type != JointType::distance || joint.is_held);
    };
    // A gear over more than two bodies has no place in a tree.
    const auto fits_tree = [&](std::size_t j) { return has_rows(j) && joints[j].gear < 0; };
    for (std::size_t j = 0; j < joints.size(); ++j) {
        joints_of[static_cast<std::size_t>(joints[j].a)].push_back(static_cast<std::int32_t>(j));
        joints_of[static_cast<std::size_t>(joints[j].b)].push_back(static_cast<std::int32_t>(j));
    }
    links_.clear(), loops_.clear();
    std::vector<std::uint8_t> is_seen(bodies.size(), 0), is_used(joints.size(), 0);
    const auto moves = [&](std::size_t body) { return bodies[body].inverse_mass > 0; };
    std::size_t next = 0;
    const auto visit = [&](std::int32_t parent) {
        for (const std::int32_t j : joints_of[static_cast<std::size_t>(parent)]) {
            const auto joint = static_cast<std::size_t>(j);
            const std::int32_t child = joints[joint].a == parent ? joints[joint].b : joints[joint].a;
            const auto body = static_cast<std::size_t>(child);
            if (is_used[joint] || !fits_tree(joint) || !moves(body) || is_seen[body]) continue;
            is_used[joint] = is_seen[body] = 1;
            Link link;
            link.body = child, link.joint = j, link.parent = parent;
            link.is_b = joints[joint].b == child;
            link.parent_moves = moves(static_cast<std::size_t>(parent));
            links_.push_back(link);
        }
    };
    const auto drain = [&] {
        for (; next < links_.size(); ++next) visit(links_[next].body);
    };
    for (std::size_t body = 0; body < bodies.size(); ++body)
        if (!moves(body)) is_seen[body] = 1, visit(static_cast<std::int32_t>(body));
    drain();
    for (std::size_t body = 0; body < bodies.size(); ++body) {
        if (is_seen[body]) continue;
        is_seen[body] = 1;
        Link root;
        root.body = static_cast<std::int32_t>(body);
        links_.push_back(root);
        drain();
    }
    loop_rows_ = drive_rows_ = 0;
    closes_loops_ = false;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const StoredJoint& joint = *joints[j].joint;
        if (has_rows(j) && !is_used[j]) {
            loops_.push_back(static_cast<std::int32_t>(j));
            closes_loops_ = closes_loops_ || joints[j].gear < 0;
            const JointRows rows = rows_of(joint, bodies[static_cast<std::size_t>(joints[j].a)].pose,
                                           bodies[static_cast<std::size_t>(joints[j].b)].pose);
            loop_rows_ += joints[j].gear < 0 ? static_cast<std::size_t>(rows.firm) : 1;
        }
        drive_rows_ += std::size_t{joint.has_motor} + (joint.has_lower || joint.has_upper);
    }
    rows_.resize(joints.size()), softness_.resize(joints.size()), pull_.resize(joints.size());
    rhs_.resize(joints.size()), answer_.resize(joints.size()), pulled_.resize(joints.size());
    stiffness_.resize(bodies.size()), weight_.assign(bodies.size(), 1);
    moved_.resize(bodies.size()), inertia_.resize(bodies.size());
    pushed_.resize(bodies.size()), change_.resize(bodies.size());
}

void JointSystem::add_gear(std::size_t joint, std::int32_t first, std::int32_t second) {
    Member& member = joints[joint];
    member.gear = static_cast<std::int32_t>(gears_.size());
    const auto coordinate = [&](std::int32_t of, std::int32_t body) {
        if (of < 0) return Coordinate{-1, 0, body, {}};
        const Member& coupled = joints[static_cast<std::size_t>(of)];
        return Coordinate{of, coupled.a, coupled.b, {}};
    };
    gears_.push_back(
        {static_cast<std::int32_t>(joint), {coordinate(first, member.a), coordinate(second, member.b)}});
}

/// Its row takes the place of one of two bodies, that of its second coordinate.
void JointSystem::measure_gear(Gear& gear) {
    const auto pose_of = [&](std::int32_t body) -> const JointPose& {
        return bodies[static_cast<std::size_t>(body)].pose;
    };
    for (Coordinate& of : gear.coordinates)
        of.row = of.joint < 0 ? coordinate_of_body(pose_of(of.b))
                              : coordinate_of(*joints[static_cast<std::size_t>(of.joint)].joint,
                                              pose_of(of.a), pose_of(of.b));
    JointRows& rows = rows_[static_cast<std::size_t>(gear.joint)];
    rows = {};
    const JointRow& second = gear.coordinates[1].row;
    rows.add(second.n, second.ja, second.jb, value_of_gear(gear, pose_of), RowLaw::hold, 0);
}

void JointSystem::set_substep(double h) {
    h_ = h;
    extras_.clear();
    has_springs_ = false;
    for (Member& member : joints) {
        if (!member.joint->is_spring()) continue;
        has_springs_ = true;
        member.whole =
            spring_terms(member.joint->frequency, member.joint->damping_ratio, h, member.least_gamma);
        member.half = half_of(member.whole);
    }
}

JointSystem::Vector JointSystem::row_of_body(std::size_t joint, int number, bool of_b) const {
    const JointRow& row = rows_[joint].row[static_cast<std::size_t>(number)];
    return of_b ? Vector{row.n.x, row.n.y, row.jb} : Vector{-row.n.x, -row.n.y, -row.ja};
}

void JointSystem::measure_rows() {
    largest_error_ = 0;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        Member& member = joints[j];
        const SystemBody &a = bodies[static_cast<std::size_t>(member.a)],
                         &b = bodies[static_cast<std::size_t>(member.b)];
        if (member.gear < 0)
            rows_[j] = rows_of(*member.joint, a.pose, b.pose, until_end_);
        else
            measure_gear(gears_[static_cast<std::size_t>(member.gear)]);
        const SpringTerms& terms = part_ == Part::half ? member.half : member.whole;
        for (int k = 0; k < rows_[j].count; ++k) {
            const auto i = static_cast<std::size_t>(k);
            const JointRow& row = rows_[j].row[i];
            softness_[j][i] = pull_[j][i] = 0;
            const bool is_angle = row.n == Vec2{};
            if (row.law == RowLaw::hold) {
                const double arm =
                    is_angle ? std::sqrt(length_squared(b.pose.position - a.pose.position)) : 1;
                largest_error_ = std::fmax(largest_error_, arm * std::fabs(row.value));
            }
            if (row.law != RowLaw::spring) continue;
            const double of_row = length_squared(row.n) * (a.inverse_mass + b.inverse_mass) +
                                  a.inverse_inertia * row.ja * row.ja + b.inverse_inertia * row.jb * row.jb;
            if (!(of_row > 0)) continue;
            softness_[j][i] = of_row / std::fmax(terms.gamma, kLeastGamma);
            pull_[j][i] = terms.alpha * row.value / of_row;
        }
    }
}

void JointSystem::prepare(Part part, bool keeps) {
    const double share_before = part_ == Part::half ? 0.5 : 1;
    part_ = part;
    measure_rows();
    stiffen(share_before);
    for (const std::int32_t loop : loops_) {
        const auto j = static_cast<std::size_t>(loop);
        for (std::size_t k = 0; k < pulled_[j].size(); ++k)
            pulled_[j][k] = joints[j].impulse[k] / (keeps ? 1 : share_before);
    }
    if (!keeps)
        for (Member& member : joints) member.impulse = {};
    factor_tree();
    if (keeps) kept_extras_ = extras_;
    list_extras();
    couple_extras();
    if (keeps) recall_extras();
    limit_pulls();
    held_before_ = held_;
}

/// Rows that were there before have the impulses that they had.
void JointSystem::recall_extras() {
    for (Extra& extra : extras_)
        for (const Extra& old : kept_extras_)
            if (old.joint == extra.joint && old.row == extra.row) extra.impulse = old.impulse;
}

void JointSystem::give_impulses() {
    for (std::size_t j = 0; j < joints.size(); ++j)
        for (int k = 0; k < rows_[j].firm; ++k) {
            const double impulse = joints[j].impulse[static_cast<std::size_t>(k)];
            for_each_part(j, k, [&](std::size_t number, const Vector& row) {
                SystemBody& body = bodies[number];
                body.velocity += (impulse * body.inverse_mass) * Vec2{row[0], row[1]};
                body.spin += impulse * body.seen_inverse_inertia * row[2];
            });
        }
}

void JointSystem::forget_impulses() {
    for (Member& member : joints) {
        // What draws a body to a target is in its force at once.
        if (member.joint->type == JointType::target)
            member.force -= Vec2{member.impulse[0], member.impulse[1]};
        member.impulse = {};
    }
    for (Extra& extra : extras_) extra.impulse = 0;
    held_ = held_before_;
}

double JointSystem::row_velocity(std::size_t joint, int number) const {
    if (joints[joint].gear >= 0) {
        double sum = 0;
        for_each_part(joint, number, [&](std::size_t body, const Vector& row) {
            sum += dot3(row, {bodies[body].velocity.x, bodies[body].velocity.y, bodies[body].spin});
        });
        return sum;
    }
    const JointRow& row = rows_[joint].row[static_cast<std::size_t>(number)];
    const SystemBody &a = bodies[static_cast<std::size_t>(joints[joint].a)],
                     &b = bodies[static_cast<std::size_t>(joints[joint].b)];
    return dot(row.n, b.velocity - a.velocity) + row.jb * b.spin - row.ja * a.spin;
}

void JointSystem::pull() {
    for (Member& member : joints) {
        if (member.joint->type != JointType::target) continue;
        SystemBody& body = bodies[static_cast<std::size_t>(member.b)];
        const Vec2 arm = rotate(body.pose.turn, member.joint->anchor_b);
        const Vec2 off = body.pose.position + arm - member.joint->target;
        const bool is_half = part_ == Part::half;
        const Vec2 impulse =
            target_impulse(*member.joint, {body.velocity, body.spin, body.inverse_mass, body.inverse_inertia},
                           arm, off, is_half ? member.half : member.whole, is_half ? h_ / 2 : h_);
        body.velocity += body.inverse_mass * impulse;
        body.spin += body.inverse_inertia * cross(arm, impulse);
        member.impulse = {impulse.x, impulse.y, 0};
        member.force += impulse;
    }
}

/// @param share  of a whole substep's impulses that the joints have
void JointSystem::stiffen(double share) {
    std::fill(stiffness_.begin(), stiffness_.end(), 0);
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const Member& member = joints[j];
        if (member.joint->type == JointType::target) continue;
        const Vec2 pull = impulse_on_b(rows_[j], member.impulse);
        const Vec2 arm_a =
                       rotate(bodies[static_cast<std::size_t>(member.a)].pose.turn, member.joint->anchor_a),
                   arm_b =
                       rotate(bodies[static_cast<std::size_t>(member.b)].pose.turn, member.joint->anchor_b);
        stiffness_[static_cast<std::size_t>(member.b)] += dot(arm_b, pull);
        stiffness_[static_cast<std::size_t>(member.a)] -= dot(arm_a, pull);
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        SystemBody& body = bodies[i];
        body.seen_inverse_inertia = body.inverse_inertia;
        const double least = h_ * stiffness_[i] / share;  // h² k, as k = stiffness / h
        if (least * body.inverse_inertia > 1) body.seen_inverse_inertia = 1 / least;
    }
}

Vec2 JointSystem::impulse_on_b(const JointRows& rows, const std::array<double, 3>& impulse) {
    Vec2 sum;
    for (int k = 0; k < rows.firm; ++k)
        sum += impulse[static_cast<std::size_t>(k)] * rows.row[static_cast<std::size_t>(k)].n;
    return sum;
}

void JointSystem::add_force(std::size_t joint, const JointRow& row, double impulse) {
    Member& member = joints[joint];
    const Vec2 arm = rotate(bodies[static_cast<std::size_t>(member.b)].pose.turn, member.joint->anchor_b);
    member.force += impulse * row.n;
    member.torque += impulse * (row.jb - cross(arm, row.n));
}

void JointSystem::scale(double share) {
    for (Member& member : joints)
        for (double& impulse : member.impulse) impulse *= share;
    for (Extra& extra : extras_) extra.impulse *= share;
}

void JointSystem::note_forces() {
    for (std::size_t j = 0; j < joints.size(); ++j)
        for (std::size_t k = 0; k < static_cast<std::size_t>(rows_[j].firm); ++k)
            add_force(j, rows_[j].row[k], joints[j].impulse[k]);
    for (const Extra& extra : extras_) {
        const auto j = static_cast<std::size_t>(extra.joint);
        const JointRow& row = row_of(extra);
        if (row.slot == kNoSlot) add_force(j, row, extra.impulse);
    }
}

void JointSystem::note_answer() {
    for (const Link& link : links_) {
        if (link.joint < 0) continue;
        const auto j = static_cast<std::size_t>(link.joint);
        for (std::size_t k = 0; k < static_cast<std::size_t>(link.rows); ++k)
            add_force(j, rows_[j].row[k], answer_[j][k]);
    }
    for (std::size_t e = 0; e < extras_.size(); ++e)
        add_force(static_cast<std::size_t>(extras_[e].joint), row_of(extras_[e]), solution_[e]);
}

void JointSystem::advance() {
    for (SystemBody& body : bodies) {
        body.pose.position += h_ * body.velocity;
        turn_pose(body.pose, h_ * body.spin);
    }
}

std::size_t JointSystem::bytes() const {
    std::size_t bytes =
        links_.capacity() * sizeof(Link) + joints.capacity() * sizeof(Member) +
        rows_.capacity() * (sizeof(JointRows) + 2 * sizeof(softness_[0]) + 3 * sizeof(Vector)) +
        bodies.capacity() * (sizeof(SystemBody) + sizeof(JointPose) + sizeof(Symmetric) + 2 * sizeof(Vector) +
                             2 * sizeof(double));
    for (const std::vector<double>* values :
         {&columns_.values, &answers_.values, &half_way_, &held_back_, &unfiltered_, &matrix_, &alone_})
        bytes += values->capacity() * sizeof(double);
    for (const Factors& factors : factors_) bytes += factors.softened.bytes() + factors.filtered.bytes();
    return bytes + asked_.capacity() * sizeof(std::size_t) + parts_.capacity() * sizeof(RowPart) +
           first_part_.capacity() * sizeof(std::size_t) + taut_.capacity() * sizeof(TautLoop);
}

}  // namespace carom
