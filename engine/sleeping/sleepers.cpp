#include "sleeping/sleepers.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "effects/sleeping.hpp"
#include "math/vec2_math.hpp"

namespace carom {
namespace {

/// Islands are looked for at this interval while any body has been still for long enough.
constexpr double kLookInterval = kTimeToSleep / 4;  // s
/// Islands that could sleep wait until their bodies, added up over the looks, are this share of those awake:
/// when one falls asleep all pairs are found anew, which takes as long as about nine steps.
/// docs/decisions/0080-price-of-the-ledger.md.
constexpr double kShareToSleep = 0.5;

template <class Real>
Vec2 position_of(const Bodies<Real>& bodies, std::size_t row) {
    return {bodies.position_x[row], bodies.position_y[row]};
}

template <class Real>
Vec2 velocity_of(const Bodies<Real>& bodies, std::size_t row) {
    return {bodies.velocity_x[row], bodies.velocity_y[row]};
}

/// Whether a body can come near a sleeper: one that does not move on its own cannot.
template <class Real>
bool can_come(const Bodies<Real>& bodies, std::size_t row) {
    const std::uint8_t flags = bodies.flags_of(row);
    return (flags & (kDisabled | kEdges | kSensor)) == 0 &&
           ((flags & kImmovable) == 0 || (flags & kKinematic) != 0);
}

/// Calls fn(i) for every contact that carries an impulse.
template <class Real, class Fn>
void for_each_loaded(const ContactRows<Real>& contacts, const Fn& fn) {
    contacts.for_each([&](std::size_t i) {
        if (contacts.normal_impulse[i] > 0) fn(i);
    });
}

/// Whether a support stands still, so that one can sleep on it.
template <class Real>
bool is_steady(const WorldState<Real>& world, Partner support) {
    if (!support.is_body()) return true;
    const Bodies<Real>& bodies = world.bodies;
    const auto row = static_cast<std::size_t>(support.row());
    if ((bodies.flags_of(row) & kKinematic) == 0) return true;
    return bodies.velocity_x[row] == 0 && bodies.velocity_y[row] == 0 &&
           (!bodies.has_rotation || bodies.angular_velocity[row] == 0);
}

}  // namespace

template <class Real>
void Sleepers<Real>::find_pairs(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                const KernelTable<Real>& kernels, const Executor& executor) {
    if (pairs_of_rebuild_ == candidates.rebuild_count()) return;
    pairs_of_rebuild_ = candidates.rebuild_count();
    pairs_.clear();
    const Bodies<Real>& bodies = world.bodies;
    if (bodies.asleep == 0) return;
    grid_.build(world, kernels, executor);
    for (std::size_t row = 0; row < bodies.moving(); ++row) {
        if (!can_come(bodies, row)) continue;
        const double reach = static_cast<double>(candidates.reach()[row]) + candidates.largest_drift();
        for (const std::int32_t sleeper : grid_.near(world, position_of(bodies, row), reach))
            if ((bodies.flags_of(static_cast<std::size_t>(sleeper)) & kSensor) == 0)
                pairs_.push_back({static_cast<std::int32_t>(row), sleeper});
    }
}

template <class Real>
bool Sleepers<Real>::is_near_any(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                 std::span<const std::int32_t> rows) {
    for (const std::int32_t row : rows) {
        const auto i = static_cast<std::size_t>(row);
        if (can_come(world.bodies, i) &&
            !grid_
                 .near(world, position_of(world.bodies, i),
                       static_cast<double>(candidates.reach()[i]) + candidates.largest_drift())
                 .empty())
            return true;
    }
    return false;
}

template <class Real>
bool Sleepers<Real>::mark_hit(const WorldState<Real>& world, double dt, double substep) {
    const Bodies<Real>& bodies = world.bodies;
    const double gravity = std::sqrt(length_squared(world.gravity));
    for (const SleeperPair pair : pairs_) {
        const auto row = static_cast<std::size_t>(pair.row), sleeper = static_cast<std::size_t>(pair.sleeper);
        if (world.has_filters() && !world.may_collide(row, sleeper)) continue;
        const bool falls = !bodies.is_immovable(row);
        // What is no disc counts as the disc around it: that wakes some that would not be hit, but misses
        // none.
        const double radius = bodies.radius[row],
                     smaller = std::fmin(bodies.inradius(row), bodies.inradius(sleeper));
        const Vec2 d = position_of(bodies, sleeper) - position_of(bodies, row), v = velocity_of(bodies, row);
        const double rim = bodies.has_rotation ? std::fabs(bodies.angular_velocity[row]) * radius : 0;
        const double speed = std::sqrt(length_squared(v));
        const double slow = falls ? still_speed(gravity, substep, smaller) : 0;
        if (speed <= slow && (falls || rim == 0)) continue;  // if it presses, its impulse wakes
        // Speed that an impact would give the sleeper at most; a kinematic body gives its own.
        const double mass = bodies.mass[row], other = bodies.mass[sleeper];
        const double given = falls ? 2 * speed * mass / (mass + other) : speed;
        if (falls && given <= kWakingShare * still_speed(gravity, substep, bodies.inradius(sleeper)))
            continue;
        // Time at which it comes nearest, flying on as it does now; gravity can bring it as far again.
        const double squared = speed * speed;
        const double t = squared > 0 ? std::fmin(std::fmax(dot(d, v) / squared, 0), dt) : 0;
        const double reach = radius + static_cast<double>(bodies.radius[sleeper]) + kTouchingShare * smaller +
                             (falls ? 0.5 * gravity * dt * dt : 0);
        if (!(length_squared(d - t * v) < reach * reach)) continue;
        mark(bodies.island[sleeper]);
        // Contacts act up to a substep before they close.
        hits_.push_back({dt + substep - t, given, pair.sleeper});
    }
    if (!hits_.empty()) hand_on_hits(world, gravity, substep);
    return !marked_.empty();
}

/// Marks what sleepers that are hit come to in turn, the nearest in time first. Without gravity bodies that
/// touch are islands of their own: an impact with the first of a row reaches the last within a step, and one
/// that slept on would take momentum as a wall does.
template <class Real>
void Sleepers<Real>::hand_on_hits(const WorldState<Real>& world, double gravity, double substep) {
    const Bodies<Real>& bodies = world.bodies;
    is_handed_.assign(bodies.asleep, 0);
    std::make_heap(hits_.begin(), hits_.end());
    while (!hits_.empty()) {
        std::pop_heap(hits_.begin(), hits_.end());
        const Hit hit = hits_.back();
        hits_.pop_back();
        const auto row = static_cast<std::size_t>(hit.sleeper);
        if (std::exchange(is_handed_[row - bodies.count], 1)) continue;
        const double radius = bodies.radius[row], mass = bodies.mass[row];
        const Vec2 place = position_of(bodies, row);
        for (const std::int32_t other : grid_.near(world, place, radius + hit.speed * hit.left)) {
            const auto next = static_cast<std::size_t>(other);
            if (is_handed_[next - bodies.count] || (bodies.flags_of(next) & kSensor) != 0) continue;
            if (world.has_filters() && !world.may_collide(row, next)) continue;
            const double given = 2 * hit.speed * mass / (mass + static_cast<double>(bodies.mass[next]));
            if (given <= kWakingShare * still_speed(gravity, substep, bodies.inradius(next))) continue;
            const double gap = std::sqrt(length_squared(position_of(bodies, next) - place)) - radius -
                               (1 + kTouchingShare) * static_cast<double>(bodies.radius[next]);
            const double left = hit.left - std::fmax(gap, 0) / hit.speed;
            if (left < 0) continue;
            mark(bodies.island[next]);
            hits_.push_back({left, given, other});
            std::push_heap(hits_.begin(), hits_.end());
        }
    }
}

template <class Real>
bool Sleepers<Real>::mark_near(const WorldState<Real>& world, Vec2 place, double reach,
                               const KernelTable<Real>& kernels, const Executor& executor) {
    if (world.bodies.asleep == 0) return false;
    grid_.build(world, kernels, executor);
    for (const std::int32_t sleeper : grid_.near(world, place, (1 + kTouchingShare) * reach))
        mark(world.bodies.island[static_cast<std::size_t>(sleeper)]);
    return !marked_.empty();
}

template <class Real>
bool Sleepers<Real>::mark_all(const WorldState<Real>& world) {
    for (std::size_t row = world.bodies.count; row < world.bodies.rows(); ++row)
        mark(world.bodies.island[row]);
    return !marked_.empty();
}

/// Counts for how long each body has been still. @return whether any has been so for long enough.
template <class Real>
bool Sleepers<Real>::note_still(WorldState<Real>& world, double dt, double substep) const {
    Bodies<Real>& bodies = world.bodies;
    const double gravity = std::sqrt(length_squared(world.gravity));
    const auto counted = static_cast<float>(std::fmin(dt, kTimeToSleep / kFewestStepsToSleep));  // s
    unsigned any = 0;
    // (By value: what is noted could be a number that a reference leads to.)
    const auto note = [&bodies, &any, counted](auto speed_of, auto rim_of) {
        unsigned found = 0;
        const Real *vx = bodies.velocity_x.data(), *vy = bodies.velocity_y.data();
        float* still = bodies.still.data();
        for (std::size_t row = 0, rows = bodies.moving(); row < rows; ++row) {
            // Compilers make lanes of what neither branches nor selects.
            const Real rim = rim_of(row), speed = speed_of(row);
            const int is_still =
                (vx[row] * vx[row] + vy[row] * vy[row] <= speed * speed) & (rim * rim <= speed * speed);
            const float now = (still[row] + counted) * static_cast<float>(is_still);
            still[row] = now;
            found |= static_cast<unsigned>(now >= static_cast<float>(kTimeToSleep));
        }
        any = found;
    };
    const auto note_at = [&](auto speed_of) {
        const Real *spin = bodies.angular_velocity.data(), *rim = bodies.rim().data();
        if (!bodies.has_rotation)
            note(speed_of, [](std::size_t) { return Real(0); });
        else if (rim)
            note(speed_of, [=](std::size_t row) { return rim[row] * spin[row]; });
        else
            note(speed_of,
                 [=, all = bodies.rim().uniform_value()](std::size_t row) { return all * spin[row]; });
    };
    if (gravity > 0)  // then it is one for all
        note_at([speed = static_cast<Real>(still_speed(gravity, substep, 0))](std::size_t) { return speed; });
    else
        note_at([&](std::size_t row) {
            return static_cast<Real>(still_speed(gravity, substep, bodies.inradius(row)));
        });
    return any != 0;
}

/// Finds the islands of the contacts that carry an impulse, which of them stay awake and which lean on
/// sleepers.
template <class Real>
void Sleepers<Real>::connect(const WorldState<Real>& world, const ContactGraph<Real>& graph,
                             std::span<const LoadedContact> others) {
    const Bodies<Real>& bodies = world.bodies;
    islands_.reset(bodies.moving());
    stays_awake_.assign(bodies.moving(), 0);
    leaning_.clear();
    for_each_loaded(graph.pairs, [&](std::size_t i) { islands_.join(graph.pairs.a[i], graph.pairs.b[i]); });
    const auto is_pair = [&](const LoadedContact& contact) {
        return contact.b.is_body() && !contact.b.is_sleeper(bodies.count) &&
               !bodies.is_immovable(static_cast<std::size_t>(contact.b.row()));
    };
    for (const LoadedContact& contact : others)
        if (is_pair(contact)) islands_.join(contact.a, contact.b.row());
    const auto row_of = [&](BodyId id) {
        return id == BodyId{} ? SIZE_MAX : std::size_t{world.handles.row_of_slot(id.index)};
    };
    const auto moves = [&](std::size_t row) { return row < bodies.moving() && !bodies.is_immovable(row); };
    world.joints.for_each([&](std::size_t, const StoredJoint& joint) {
        const std::size_t a = row_of(joint.a), b = row_of(joint.b);
        if (moves(a) && moves(b)) islands_.join(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b));
    });
    const auto keep_awake = [&](std::int32_t row) {
        stays_awake_[static_cast<std::size_t>(islands_.island_of(row))] = 1;
    };
    const auto lean = [&](std::int32_t row, Partner support) {
        if (support.is_sleeper(bodies.count))
            leaning_.push_back({row, bodies.island[static_cast<std::size_t>(support.row())]});
        else if (!is_steady(world, support))
            keep_awake(row);
    };
    for_each_loaded(graph.supports,
                    [&](std::size_t i) { lean(graph.supports.a[i], graph.supports.partner(i)); });
    for (const LoadedContact& contact : others)
        if (!is_pair(contact)) lean(contact.a, contact.b);
    world.joints.for_each([&](std::size_t, const StoredJoint& joint) {
        const std::size_t a = row_of(joint.a), b = row_of(joint.b);
        for (const auto& [row, other] : {std::pair{a, b}, std::pair{b, a}})
            if (moves(row) && other < bodies.count && !moves(other) &&
                !is_steady(world, Partner::body(static_cast<std::int32_t>(other))))
                keep_awake(static_cast<std::int32_t>(row));
    });
    for (std::size_t row = 0; row < bodies.moving(); ++row)
        if (bodies.is_immovable(row) || bodies.still[row] < static_cast<float>(kTimeToSleep))
            keep_awake(static_cast<std::int32_t>(row));
}

template <class Real>
void Sleepers<Real>::keep_contact(const WorldState<Real>& world, const ContactRows<Real>& contacts,
                                  std::size_t i, double substep) {
    const std::int32_t a = contacts.a[i], b = contacts.b[i];
    const bool is_body = contacts.partner(i).is_body();
    const std::int32_t smallest = islands_.island_of(a);
    const auto force = [&](const Column<Real>& impulses) {
        return impulses.empty() ? 0 : static_cast<double>(impulses[i]) / substep;
    };
    const BodyId id_a = world.bodies.id[static_cast<std::size_t>(a)];
    kept_.push_back({label_[static_cast<std::size_t>(smallest)], id_a,
                     is_body ? world.bodies.id[static_cast<std::size_t>(b)] : id_a, is_body ? 0 : b,
                     force(contacts.normal_impulse), force(contacts.friction_impulse),
                     force(contacts.rolling_impulse)});
}

template <class Real>
void Sleepers<Real>::keep_contacts(const WorldState<Real>& world, ContactRows<Real>& contacts,
                                   double substep) {
    for_each_loaded(contacts, [&](std::size_t i) {
        const std::int32_t smallest = islands_.island_of(contacts.a[i]);
        if (label_[static_cast<std::size_t>(smallest)] < 0) return;
        keep_contact(world, contacts, i, substep);
        contacts.normal_impulse[i] = 0;  // they are no contacts of rows any more
    });
}

/// Stops a row and moves it behind those awake; the last one that stands takes the place of the last one that
/// moves, and that one its place.
template <class Real>
void Sleepers<Real>::lay_down(WorldState<Real>& world, std::size_t row) {
    Bodies<Real>& bodies = world.bodies;
    const Sums lost = world.sums_of(row);
    world.books.sleep -= lost.energy.kinetic + lost.energy.rotational;
    world.books.sleep_momentum -= lost.momentum;
    world.dynamic_mass -= static_cast<double>(bodies.mass[row]);
    bodies.velocity_x[row] = bodies.velocity_y[row] = 0;
    if (bodies.has_rotation) bodies.angular_velocity[row] = 0;
    const std::size_t last = bodies.count - 1, last_moving = bodies.moving() - 1;
    bodies.island[row] = label_[static_cast<std::size_t>(islands_.island_of(order_[row]))];
    world.swap_rows(row, last_moving), world.swap_rows(last_moving, last);
    std::swap(order_[row], order_[last_moving]), std::swap(order_[last_moving], order_[last]);
    --bodies.count, ++bodies.asleep;
}

template <class Real>
void Sleepers<Real>::rename_island(WorldState<Real>& world, std::int32_t from, std::int32_t to) {
    if (from == to) return;
    for (std::size_t row = world.bodies.count; row < world.bodies.rows(); ++row)
        if (world.bodies.island[row] == from) world.bodies.island[row] = to;
    for (Kept& kept : kept_)
        if (kept.island == from) kept.island = to;
    for (std::int32_t& label : label_)
        if (label == from) label = to;
    --island_count_;
}

template <class Real>
bool Sleepers<Real>::put_to_sleep(WorldState<Real>& world, ContactGraph<Real>& graph,
                                  std::span<const LoadedContact> others, double dt, double substep) {
    Bodies<Real>& bodies = world.bodies;
    since_look_ += dt;
    if (!note_still(world, dt, substep) || since_look_ < kLookInterval) return false;
    since_look_ = 0;
    connect(world, graph, others);
    const auto smallest_of = [&](std::size_t row) {
        return static_cast<std::size_t>(islands_.island_of(static_cast<std::int32_t>(row)));
    };
    std::size_t tired = 0;
    for (std::size_t row = 0; row < bodies.moving(); ++row) tired += stays_awake_[smallest_of(row)] ? 0 : 1;
    waiting_ += static_cast<double>(tired);
    if (tired == 0 || waiting_ < kShareToSleep * static_cast<double>(bodies.moving())) return false;
    waiting_ = 0;
    label_.assign(bodies.moving(), -1);
    for (std::size_t row = 0; row < bodies.moving(); ++row)
        if (smallest_of(row) == row && !stays_awake_[row]) label_[row] = next_island_++, ++island_count_;
    for (const Held& held : leaning_) {
        const auto smallest = static_cast<std::size_t>(islands_.island_of(held.row));
        if (label_[smallest] < 0) continue;
        std::int32_t other = held.island;
        rename_island(world, other, label_[smallest]);
        for (Held& later : leaning_)
            if (later.island == other) later.island = label_[smallest];
    }
    keep_contacts(world, graph.pairs, substep), keep_contacts(world, graph.supports, substep);
    order_.resize(bodies.count);
    std::iota(order_.begin(), order_.end(), 0);
    for (std::size_t row = bodies.moving(); row-- > 0;)
        if (label_[smallest_of(row)] >= 0) lay_down(world, row);
    graph.trail.follow_sorted(order_.data(), bodies.count);
    world.list_immovable_rows();
    grid_.forget(), pairs_of_rebuild_ = -1;
    pairs_.clear();
    return true;
}

template <class Real>
void Sleepers<Real>::forget_contacts(ContactGraph<Real>& graph) {
    ContactRows<Real>& supports = graph.supports;
    const std::size_t awake = graph.trail.rows();  // those when its rows were named: calls may add some
    supports.for_each([&](std::size_t i) {
        if (supports.partner(i).is_sleeper(awake))
            supports.b[i] = supports.a[i], supports.normal_impulse[i] = 0;
    });
}

template <class Real>
bool Sleepers<Real>::mark_pressed(const WorldState<Real>& world, const ContactGraph<Real>& graph,
                                  std::span<const LoadedContact> others, double substep) {
    const Bodies<Real>& bodies = world.bodies;
    if (pairs_.empty()) return false;
    const double gravity = std::sqrt(length_squared(world.gravity));
    const auto press = [&](Partner support, double impulse) {
        if (!support.is_sleeper(bodies.count)) return;
        const auto sleeper = static_cast<std::size_t>(support.row());
        const double speed = impulse * bodies.inverse_mass(sleeper);
        if (speed > kWakingShare * still_speed(gravity, substep, bodies.radius[sleeper]))
            mark(bodies.island[sleeper]);
    };
    for_each_loaded(graph.supports, [&](std::size_t i) {
        press(graph.supports.partner(i), static_cast<double>(graph.supports.normal_impulse[i]));
    });
    for (const LoadedContact& contact : others) press(contact.b, contact.impulse);
    return !marked_.empty();
}

template <class Real>
std::size_t Sleepers<Real>::wake_marked(WorldState<Real>& world) {
    if (marked_.empty()) return 0;
    Bodies<Real>& bodies = world.bodies;
    std::sort(marked_.begin(), marked_.end());
    marked_.erase(std::unique(marked_.begin(), marked_.end()), marked_.end());
    const auto is_marked = [&](std::int32_t island) {
        return std::binary_search(marked_.begin(), marked_.end(), island);
    };
    const std::size_t before = bodies.count;
    for (std::size_t row = bodies.count; row < bodies.count + bodies.asleep; ++row) {
        if (!is_marked(bodies.island[row])) continue;
        bodies.still[row] = 0;
        world.dynamic_mass += static_cast<double>(bodies.mass[row]);
        world.swap_rows(row, bodies.count);
        world.swap_rows(bodies.count, bodies.moving());  // with the first that stands
        ++bodies.count, --bodies.asleep;
    }
    const auto wakes = [&](const Kept& kept) { return is_marked(kept.island); };
    std::copy_if(kept_.begin(), kept_.end(), std::back_inserter(woken_), wakes);
    std::erase_if(kept_, wakes);
    island_count_ -= static_cast<std::int64_t>(marked_.size());
    woken_count_ += static_cast<std::int64_t>(marked_.size());
    marked_.clear();
    pairs_of_rebuild_ = -1;
    pairs_.clear();
    return bodies.count - before;
}

template <class Real>
void Sleepers<Real>::restore_impulses(ContactGraph<Real>& graph, const WorldState<Real>& world,
                                      double substep) {
    if (woken_.empty()) return;
    filed_.clear();
    for (std::size_t i = 0; i < woken_.size(); ++i) {
        const Kept& kept = woken_[i];
        const auto row_of = [&](BodyId id) {
            return static_cast<std::int32_t>(world.handles.row_of_slot(id.index));
        };
        if (!world.handles.is_alive(kept.a) || !world.handles.is_alive(kept.b)) {
            if (world.handles.is_alive(kept.a))
                graph.lost.push_back({-1 - static_cast<std::int32_t>(kept.b.index), row_of(kept.a)});
            if (world.handles.is_alive(kept.b))
                graph.lost.push_back({-1 - static_cast<std::int32_t>(kept.a.index), row_of(kept.b)});
            continue;
        }
        filed_.push_back({row_of(kept.a), kept.support < 0 ? kept.support : row_of(kept.b), i});
    }
    std::sort(filed_.begin(), filed_.end());
    const auto restore = [&](ContactRows<Real>& contacts, bool is_turned) {
        contacts.for_each([&](std::size_t i) {
            Woken wanted{contacts.a[i], contacts.b[i], 0};
            if (is_turned) std::swap(wanted.a, wanted.b);
            const auto found = std::lower_bound(filed_.begin(), filed_.end(), wanted);
            if (found == filed_.end() || found->a != wanted.a || found->b != wanted.b) return;
            const Kept& kept = woken_[found->number];
            const auto impulse = [&](double force) { return static_cast<Real>(force * substep); };
            contacts.normal_impulse[i] = impulse(kept.normal);
            if (!contacts.friction_impulse.empty()) contacts.friction_impulse[i] = impulse(kept.friction);
            if (!contacts.rolling_impulse.empty())
                contacts.rolling_impulse[i] = impulse(is_turned ? -kept.rolling : kept.rolling);
        });
    };
    restore(graph.pairs, false), restore(graph.pairs, true), restore(graph.supports, false);
    woken_.clear();
}

template <class Real>
std::size_t Sleepers<Real>::bytes() const {
    return (kept_.capacity() + woken_.capacity()) * sizeof(Kept) + islands_.bytes() +
           pairs_.capacity() * sizeof(SleeperPair) + grid_.bytes() + hits_.capacity() * sizeof(Hit) +
           is_handed_.capacity() + stays_awake_.capacity() +
           (label_.capacity() + order_.capacity() + marked_.capacity()) * sizeof(std::int32_t);
}

template class Sleepers<float>;
template class Sleepers<double>;

}  // namespace carom
