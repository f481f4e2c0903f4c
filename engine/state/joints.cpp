#include "state/joints.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "math/rotation.hpp"

namespace carom {
namespace {

std::uint64_t pair_of(BodyId a, BodyId b) {
    const auto low = std::min(a.index, b.index), high = std::max(a.index, b.index);
    return std::uint64_t{low} << 32 | high;
}

/// What is of a hinge, slider, weld or wheel alike: anchors at a point of the world.
template <class Kind>
void place(StoredJoint& stored, const Kind& kind, const JointBody& a, const JointBody& b, bool is_b_world) {
    const Vec2 anchor = kind.anchor.value_or(is_b_world ? a.position : b.position);
    stored.anchor_a = rotate_back(rotation_by(a.angle), anchor - a.position);
    stored.anchor_b = rotate_back(rotation_by(b.angle), anchor - b.position);
    stored.angle = b.angle - a.angle;
    stored.frequency = kind.frequency, stored.damping_ratio = kind.damping_ratio;
}

void limit(StoredJoint& stored, const std::optional<double>& lower, const std::optional<double>& upper) {
    stored.has_lower = lower.has_value(), stored.has_upper = upper.has_value();
    stored.lower.put(lower.value_or(0)), stored.upper.put(upper.value_or(0));
}

void drive(StoredJoint& stored, const std::optional<double>& speed, double most) {
    stored.has_motor = speed.has_value() && most > 0;
    stored.motor_speed = speed.value_or(0), stored.max_motor = most;
}

void set_axis(StoredJoint& stored, Vec2 axis, const JointBody& a) {
    const double length = std::sqrt(length_squared(axis));
    stored.axis = rotate_back(rotation_by(a.angle), {axis.x / length, axis.y / length});
}

struct Describe {
    StoredJoint& stored;
    const JointBody &a, &b;
    bool is_b_world;

    void operator()(const DistanceJoint& kind) const {
        stored.type = JointType::distance;
        stored.anchor_a = kind.anchor_a, stored.anchor_b = kind.anchor_b;
        const Vec2 from = a.position + rotate(rotation_by(a.angle), kind.anchor_a),
                   to = b.position + rotate(rotation_by(b.angle), kind.anchor_b);
        stored.length = kind.length.value_or(std::sqrt(length_squared(to - from)));
        limit(stored, kind.min, kind.max);
        stored.frequency = kind.frequency, stored.damping_ratio = kind.damping_ratio;
        stored.is_held = (!kind.min && !kind.max) || kind.frequency > 0;
    }
    void operator()(const RevoluteJoint& kind) const {
        stored.type = JointType::revolute;
        place(stored, kind, a, b, is_b_world);
        limit(stored, kind.lower, kind.upper);
        drive(stored, kind.motor_speed, kind.max_motor_torque);
    }
    void operator()(const PrismaticJoint& kind) const {
        stored.type = JointType::prismatic;
        place(stored, kind, a, b, is_b_world);
        set_axis(stored, kind.axis, a);
        limit(stored, kind.lower, kind.upper);
        drive(stored, kind.motor_speed, kind.max_motor_force);
    }
    void operator()(const WeldJoint& kind) const {
        stored.type = JointType::weld;
        place(stored, kind, a, b, is_b_world);
    }
    void operator()(const WheelJoint& kind) const {
        stored.type = JointType::wheel;
        place(stored, kind, a, b, is_b_world);
        set_axis(stored, kind.axis, a);
        drive(stored, kind.motor_speed, kind.max_motor_torque);
    }
    void operator()(const TargetJoint& kind) const {
        stored.type = JointType::target;
        stored.anchor_b = kind.anchor, stored.target = kind.target, stored.max_force = kind.max_force;
        stored.frequency = kind.frequency, stored.damping_ratio = kind.damping_ratio;
    }
    void operator()(const GearJoint& kind) const {
        stored.type = JointType::gear;
        stored.ratio = kind.ratio;
        stored.angle = b.angle - kind.ratio * a.angle;
        if (kind.first) stored.first = kind.first->index;
        if (kind.second) stored.second = kind.second->index;
    }
};

}  // namespace

/// A joint of a body and the world has the body as b: what is counted of b against a then turns its sign.
StoredJoint stored_joint(const Joint& joint, const JointBody& a, const JointBody& b) {
    StoredJoint stored;
    std::visit(Describe{stored, a, b, !joint.b}, joint.kind);
    stored.a = joint.a.value_or(BodyId{}), stored.b = joint.b.value_or(BodyId{});
    if (!joint.b && stored.type != JointType::gear) {
        stored.is_exchanged = true;
        std::swap(stored.a, stored.b);
        std::swap(stored.anchor_a, stored.anchor_b);
        stored.axis = rotate(rotation_by(a.angle), stored.axis);
        stored.angle = -stored.angle;
        if (stored.turns_sign()) {
            std::swap(stored.has_lower, stored.has_upper);
            const double low = -stored.upper.at, high = -stored.lower.at;
            stored.lower.put(low), stored.upper.put(high);
        }
        stored.motor_speed = stored.as_kept(stored.motor_speed);
    }
    stored.collide = joint.collide;
    stored.break_force = joint.break_force, stored.break_torque = joint.break_torque;
    return stored;
}

JointId JointStore::add(const StoredJoint& joint) {
    ++count_, ++version;
    std::size_t slot = slots_.size();
    if (free_.empty()) {
        slots_.push_back({joint, 0, true});
    } else {
        slot = free_.back();
        free_.pop_back();
        slots_[slot].joint = joint, slots_[slot].is_used = true;
    }
    if (!joint.collide && !joint.is_on_world()) {
        // In order where joints are added in it, which is how scenes mostly are.
        const std::uint64_t pair = pair_of(joint.a, joint.b);
        excluded_.insert(std::upper_bound(excluded_.begin(), excluded_.end(), pair), pair);
        const std::size_t end = static_cast<std::size_t>(pair >> 32) + 1;  // of its lower body's pairs
        if (end >= first_excluded_.size())
            first_excluded_.resize(end + 1, static_cast<std::uint32_t>(excluded_.size()) - 1);
        for (std::size_t body = end; body < first_excluded_.size(); ++body) ++first_excluded_[body];
    }
    added_.push_back(static_cast<std::uint32_t>(slot));
    return id_of(slot);
}

void JointStore::remove(std::size_t slot) {
    --count_, ++version;
    slots_[slot].is_used = false, ++slots_[slot].generation;
    slots_[slot].joint = {};
    free_.push_back(static_cast<std::uint32_t>(slot));
    std::erase(moving_, slot);
    for (std::size_t other = 0; other < slots_.size(); ++other) {
        const StoredJoint& gear = slots_[other].joint;
        if (slots_[other].is_used && gear.type == JointType::gear &&
            (gear.first == slot || gear.second == slot))
            remove(other);
    }
    if (count_ == 0) added_.clear(), built_in_.clear();
    list_excluded();
}

void JointStore::set_limits(std::size_t slot, double low, double high) {
    StoredJoint& joint = slots_[slot].joint;
    ++settings;
    if (joint.turns_sign()) low = -std::exchange(high, -low);
    const auto set = [&](bool& has, JointLimit& limit, double value) {
        if (has)
            limit.at = value;
        else
            limit.put(value), ++version;
        has = true;
    };
    set(joint.has_lower, joint.lower, low), set(joint.has_upper, joint.upper, high);
    if (joint.type == JointType::distance && joint.is_held && !joint.is_spring())
        joint.is_held = false, ++version;
    if (!std::exchange(joint.is_listed, true)) moving_.push_back(static_cast<std::uint32_t>(slot));
}

void JointStore::begin_limits(double dt) {
    for (const std::uint32_t slot : moving_)
        for (JointLimit* limit : {&slots_[slot].joint.lower, &slots_[slot].joint.upper})
            limit->begin_step(dt);
}

void JointStore::end_limits(double dt) {
    std::erase_if(moving_, [&](std::uint32_t slot) {
        StoredJoint& joint = slots_[slot].joint;
        const bool lower = joint.lower.end_step(dt), upper = joint.upper.end_step(dt);
        joint.is_listed = lower || upper;
        return !joint.is_listed;
    });
}

void JointStore::remove_of(BodyId body) {
    let_touch([&](const BuiltInPair& pair) { return pair.a == body || pair.b == body; });
    for (std::size_t slot = 0; slot < slots_.size() && count_ > 0; ++slot)
        if (slots_[slot].is_used && (slots_[slot].joint.a == body || slots_[slot].joint.b == body))
            remove(slot);
}

void JointStore::add_built_in(std::span<const BuiltInPair> pairs) {
    built_in_.insert(built_in_.end(), pairs.begin(), pairs.end());
    list_excluded();
}

std::size_t JointStore::slot_of(JointId id, std::string_view where) const {
    if (is_alive(id)) return id.index;
    throw Error(ErrorCode::stale_handle,
                std::string(where) + ": joint handle " + std::to_string(id.index) + " (generation " +
                    std::to_string(id.generation) +
                    ") names no joint of this world; it was removed, broke, went with a body, or comes from "
                    "another world. Keep the handle that Scene::add or World::add returned.");
}

void JointStore::list_excluded() {
    excluded_.clear();
    for_each([&](std::size_t, const StoredJoint& joint) {
        if (!joint.collide && !joint.is_on_world()) excluded_.push_back(pair_of(joint.a, joint.b));
    });
    for (const BuiltInPair& pair : built_in_) excluded_.push_back(pair_of(pair.a, pair.b));
    std::sort(excluded_.begin(), excluded_.end());
    first_excluded_.clear();
    for (std::size_t i = 0; i < excluded_.size(); ++i) {
        const auto lower = static_cast<std::size_t>(excluded_[i] >> 32);
        if (lower >= first_excluded_.size()) first_excluded_.resize(lower + 1, static_cast<std::uint32_t>(i));
    }
    first_excluded_.push_back(static_cast<std::uint32_t>(excluded_.size()));
}

bool JointStore::excludes(BodyId a, BodyId b) const {
    const std::size_t lower = std::min(a.index, b.index);
    if (lower + 1 >= first_excluded_.size()) return false;
    const auto first = excluded_.begin();
    const auto end = first + first_excluded_[lower + 1];
    return std::find(first + first_excluded_[lower], end, pair_of(a, b)) != end;
}

std::size_t JointStore::bytes() const {
    return slots_.capacity() * sizeof(Slot) +
           (free_.capacity() + added_.capacity() + moving_.capacity()) * sizeof(std::uint32_t) +
           built_in_.capacity() * sizeof(BuiltInPair) + excluded_.capacity() * sizeof(std::uint64_t) +
           first_excluded_.capacity() * sizeof(std::uint32_t) + broken.capacity() * sizeof(JointBreak);
}

}  // namespace carom
