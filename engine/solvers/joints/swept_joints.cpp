#include "solvers/joints/swept_joints.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

namespace carom {
namespace {

/// The largest mass that a swept joint is taken to swing, in reduced masses of its own two bodies: 64 like
/// bodies, or four of 16 times the mass, the largest ratio in a crowd.
constexpr double kBodiesOfBend = 64;
/// Factor by which the first sweep over rods goes farther. Hinges take 1: more pumps energy into them.
constexpr double kOverRelaxation = 1.3;

constexpr std::size_t kColours = 64;
constexpr std::size_t kFewestChunks = 8;         // or one: four tasks for the threads to share
constexpr std::size_t kFewestRowsOfChunk = 512;  // fewer: too many short colours
constexpr double kNanosecondsToSweep = 5;        // a joint on one thread, for the executor
static_assert(kJointBlock == kRowPadding);

/// A part of a joint that is to be swept.
struct Entry {
    std::size_t group, colour, kind, slot;
    std::int32_t a, b;
};

constexpr std::size_t kInOrder = 4;  // joints at least that lie in order: RowOrder

/// How joints lie in memory if each of them lies to the next one as these two do.
RowOrder order_of(std::int32_t a, std::int32_t b, std::int32_t next_a, std::int32_t next_b) {
    if (next_a == a + 1 && next_b == b + 1) return RowOrder::runs;
    return b == a + 1 && next_a == a + 2 && next_b == b + 2 ? RowOrder::pairs : RowOrder::any;
}

/// Within each colour puts joints whose rows lie in order before all others, in whole blocks: lines of a net,
/// and what reaches from line to line, if bodies were added in that order. The order within a colour is free:
/// none of its joints moves what another one moves.
/// @param entries  of one kind, by group and colour
template <class Moves>
void put_blocks_first(std::vector<Entry>& entries, const Moves& moves) {
    std::array<std::vector<Entry>, 3> lying;  // by RowOrder
    std::vector<Entry>& any = lying[static_cast<std::size_t>(RowOrder::any)];
    const auto is_of_colour = [&](std::size_t i, const Entry& other) {
        return i < entries.size() && entries[i].group == other.group && entries[i].colour == other.colour;
    };
    const auto order_at = [&](std::size_t i) {
        const Entry& here = entries[i];
        if (!is_of_colour(i + 1, here)) return RowOrder::any;
        const Entry& next = entries[i + 1];
        for (const std::int32_t row : {here.a, here.b, next.a, next.b})
            if (!moves(row)) return RowOrder::any;
        return order_of(here.a, here.b, next.a, next.b);
    };
    for (std::size_t i = 0, first = 0; i < entries.size();) {
        const RowOrder order = order_at(i);
        std::size_t length = 1;
        while (length < kInOrder && order != RowOrder::any && order_at(i + length - 1) == order) ++length;
        std::vector<Entry>& to = length == kInOrder ? lying[static_cast<std::size_t>(order)] : any;
        if (length < kInOrder) length = 1;
        to.insert(to.end(), &entries[i], &entries[i] + length);
        i += length;
        if (is_of_colour(i, entries[first])) continue;
        auto out = entries.begin() + static_cast<std::ptrdiff_t>(first);
        for (const RowOrder of : {RowOrder::runs, RowOrder::pairs}) {
            std::vector<Entry>& in_order = lying[static_cast<std::size_t>(of)];
            const auto whole = static_cast<std::ptrdiff_t>(in_order.size() / kJointBlock * kJointBlock);
            out = std::copy(in_order.begin(), in_order.begin() + whole, out);
            any.insert(any.begin(), in_order.begin() + whole, in_order.end());
            in_order.clear();
        }
        std::copy(any.begin(), any.end(), out);
        any.clear(), first = i;
    }
}

}  // namespace

template <class Real>
bool SweptJoints<Real>::knows(const StoredJoint& joint) {
    return joint.type == JointType::distance || joint.type == JointType::revolute ||
           joint.type == JointType::weld;
}

template <class Real>
std::size_t SweptJoints<Real>::kind_of(const StoredJoint& joint) {
    if (joint.type != JointType::distance) return kHinges;
    if (joint.is_spring() || joint.has_lower || joint.has_upper) return kSprings;
    const bool has_arms = joint.anchor_b != Vec2{} || (!joint.is_on_world() && joint.anchor_a != Vec2{});
    return has_arms ? kRodsOfAnchors : kRods;
}

template <class Real>
bool SweptJoints<Real>::has_angle_part(const StoredJoint& joint) {
    return joint.type == JointType::weld ||
           (joint.type == JointType::revolute &&
            (joint.has_lower || joint.has_upper || joint.has_motor || joint.is_spring()));
}

template <class Real>
unsigned SweptJoints<Real>::needs_of(std::size_t kind) {
    constexpr unsigned kNeeds[kKinds] = {kPoints, kPoints | kArms | kRims, kPoints | kArms | kRims,
                                         kPoints | kArms | kRims | kDrives, kRims | kDrives};
    return kNeeds[kind];
}

template <class Real>
template <class Fn>
void SweptJoints<Real>::Kind::for_each_column(const Fn& fn) {
    for (Column<Real>* column : {&start_x, &impulse_x, &impulse_y}) fn(*column, 0u);
    for (Column<Real>* column : {&start_y, &length, &normal_x, &normal_y, &per_length})
        fn(*column, unsigned{kPoints});
    for (Column<Real>* column : {&start_arm_a_x, &start_arm_a_y, &start_arm_b_x, &start_arm_b_y, &arm_a_x,
                                 &arm_a_y, &arm_b_x, &arm_b_y})
        fn(*column, unsigned{kArms});
    for (Column<Real>* column : {&per_rim_a, &per_rim_b, &seen_a, &seen_b}) fn(*column, unsigned{kRims});
    for (Column<Real>* column : {&impulse_z, &impulse_w, &value, &alpha, &gamma, &lower, &upper, &lower_rate,
                                 &upper_rate, &speed, &most})
        fn(*column, unsigned{kDrives});
}

template <class Real>
void SweptJoints<Real>::Kind::resize(std::size_t places, unsigned needs) {
    a.resize(places), b.resize(places), slot.resize(places), order.resize(places / kJointBlock);
    for_each_column([&](Column<Real>& column, unsigned bit) {
        column.clear();
        column.resize((needs & bit) == bit ? places : 0);
    });
}

template <class Real>
void SweptJoints<Real>::Kind::find_order() {
    const auto order_at = [&](std::size_t i) {
        const bool are_joints = slot[i] >= 0 && slot[i + 1] >= 0;
        return are_joints ? order_of(a[i], b[i], a[i + 1], b[i + 1]) : RowOrder::any;
    };
    for (std::size_t block = 0; block < order.size(); ++block) {
        const std::size_t first = block * kJointBlock;
        order[block] = order_at(first);
        for (std::size_t i = first; i < first + kJointBlock; ++i)
            if (i % kInOrder + 1 < kInOrder && order_at(i) != order[block]) order[block] = RowOrder::any;
    }
}

template <class Real>
JointColumns<Real> SweptJoints<Real>::Kind::columns() {
    return {a.data(),
            b.data(),
            order.data(),
            start_x.data(),
            start_y.data(),
            length.data(),
            impulse_x.data(),
            impulse_y.data(),
            normal_x.data(),
            normal_y.data(),
            per_length.data(),
            start_arm_a_x.data(),
            start_arm_a_y.data(),
            start_arm_b_x.data(),
            start_arm_b_y.data(),
            arm_a_x.data(),
            arm_a_y.data(),
            arm_b_x.data(),
            arm_b_y.data(),
            per_rim_a.data(),
            per_rim_b.data(),
            seen_a.data(),
            seen_b.data(),
            impulse_z.data(),
            impulse_w.data(),
            value.data(),
            alpha.data(),
            gamma.data(),
            lower.data(),
            upper.data(),
            lower_rate.data(),
            upper_rate.data(),
            speed.data(),
            most.data()};
}

template <class Real>
std::vector<std::size_t> SweptJoints<Real>::sort(const WorldState<Real>& world,
                                                 const std::vector<std::size_t>& slots) {
    const std::size_t rows = world.bodies.count;
    first_beyond_ = static_cast<std::int32_t>(rows), joints_ = parts_of_joints_ = 0, colours_ = 0;
    longest_ = 0, is_loaded_ = false;
    breakable_.clear();
    groups_ = {};
    // Nets have their rows in order, so that joints reach into the next chunk at most: as long as a chunk has
    // so many rows that most do.
    if (rows / kFewestChunks >= kFewestRowsOfChunk && slots.size() > rows / 2) {
        const std::size_t length = padded((rows + kFewestChunks - 1) / kFewestChunks);
        groups_ = TaskGroups(length, (rows + length - 1) / length);
    }
    std::vector<Entry> entries;
    const auto row_of = [&](BodyId id) {
        return id == BodyId{} ? first_beyond_
                              : static_cast<std::int32_t>(world.handles.row_of_slot(id.index));
    };
    const auto moves = [&](std::int32_t row) {
        return row < first_beyond_ && !world.bodies.is_immovable(static_cast<std::size_t>(row));
    };
    const auto drives = [&](std::int32_t row) {
        return row < first_beyond_ &&
               (world.bodies.flags_of(static_cast<std::size_t>(row)) & kKinematic) != 0;
    };
    std::vector<std::size_t> left_over;
    for (const std::size_t slot : slots) {
        const StoredJoint& joint = world.joints[slot];
        const std::int32_t a = row_of(joint.a), b = row_of(joint.b);
        if (drives(a) || drives(b)) {
            left_over.push_back(slot);
            continue;
        }
        // What does not move is in any group: the joint is where its other body is.
        const std::int32_t low = !moves(a)   ? b
                                 : !moves(b) ? a
                                             : std::min(a, b),
                           high = !moves(a)   ? b
                                  : !moves(b) ? a
                                              : std::max(a, b);
        entries.push_back({groups_.group_of(low, high), 0, kind_of(joint), slot, a, b});
        if (has_angle_part(joint)) entries.push_back({groups_.group_of(low, high), 0, kAngles, slot, a, b});
    }
    const auto by_group = [](const Entry& left, const Entry& right) { return left.group < right.group; };
    std::stable_sort(entries.begin(), entries.end(), by_group);
    std::vector<std::uint64_t> taken(rows * kKinds);
    std::size_t group = SIZE_MAX;
    for (Entry& entry : entries) {
        if (entry.group != group) std::fill(taken.begin(), taken.end(), 0), group = entry.group;
        const auto of = [&](std::int32_t row) -> std::uint64_t& {
            return taken[static_cast<std::size_t>(row) * kKinds + entry.kind];
        };
        std::uint64_t both = 0;
        for (const std::int32_t row : {entry.a, entry.b})
            if (moves(row)) both |= of(row);
        entry.colour = static_cast<std::size_t>(std::countr_one(both));
        if (entry.colour == kColours) {
            left_over.push_back(entry.slot);
            continue;
        }
        ++parts_of_joints_;
        joints_ += entry.kind != kAngles;
        colours_ = std::max(colours_, entry.colour + 1);
        for (const std::int32_t row : {entry.a, entry.b})
            if (moves(row)) of(row) |= std::uint64_t{1} << entry.colour;
    }
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& left, const Entry& right) {
        return left.group != right.group ? left.group < right.group : left.colour < right.colour;
    });
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        Kind& own = kinds_[kind];
        std::vector<Entry> of_kind;
        for (const Entry& entry : entries)
            if (entry.kind == kind && entry.colour != kColours) of_kind.push_back(entry);
        put_blocks_first(of_kind, moves);
        std::vector<std::pair<std::size_t, const Entry*>> places;
        std::size_t place = 0, colour = SIZE_MAX, of_group = SIZE_MAX;
        own.begin.assign(groups_.count() + 1, 0);
        for (const Entry& entry : of_kind) {
            if (entry.group != of_group || entry.colour != colour) place = padded(place);
            if (entry.group != of_group) {
                for (std::size_t g = of_group + 1; g <= entry.group; ++g)
                    own.begin[g] = place;  // SIZE_MAX + 1 = 0
                of_group = entry.group;
            }
            colour = entry.colour;
            places.push_back({place++, &entry});
        }
        place = padded(place);
        for (std::size_t g = of_group + 1; g < own.begin.size(); ++g) own.begin[g] = place;
        own.resize(place, needs_of(kind));
        std::fill(own.slot.begin(), own.slot.end(), -1);
        for (std::size_t g = 0; g < groups_.count(); ++g)
            for (std::size_t at = own.begin[g]; at < own.begin[g + 1]; ++at)
                own.a[at] = own.b[at] = first_beyond_ + static_cast<std::int32_t>(g);
        for (const auto& [at, entry] : places) {
            if (world.joints[entry->slot].may_break()) breakable_.push_back({kind, at, {}});
            if (moves(entry->a)) own.a[at] = entry->a;
            if (moves(entry->b)) own.b[at] = entry->b;
            own.slot[at] = static_cast<std::int32_t>(entry->slot);
        }
        own.find_order();
    }
    return left_over;
}

template <class Real>
Real* SweptJoints<Real>::turn_of(BodyRecords<Real>& records) {
    if (Real* const turn = records.turn()) return turn;
    no_turn_.resize(padded(records.rows()));
    return no_turn_.data();
}

template <class Real>
void SweptJoints<Real>::run_group(std::size_t group, Kernel kernel) const {
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        const std::size_t first = kinds_[kind].begin[group], last = kinds_[kind].begin[group + 1];
        if (first == last) continue;
        SweepJoints<Real> k = arguments_[kind];
        k.over_relaxation =
            static_cast<Real>(kind >= kHinges || kernel == Kernel::last ? 1 : kOverRelaxation);
        const JointKernels<Real>& kernels = kernels_->joints[kind];
        const auto run = kernel == Kernel::give    ? kernels.give
                         : kernel == Kernel::first ? kernels.first
                                                   : kernels.next;
        run(k, first, last);
    }
}

template <class Real>
void SweptJoints<Real>::sweep(const JointStep<Real>& step, const StepLoops<Real>& loops, Begin begin) {
    for (SweepJoints<Real>& k : arguments_) {
        k.velocity = step.records.velocity.data(), k.displacement = step.records.displacement.data();
        k.turn = turn_of(step.records);
        k.until_end = static_cast<Real>(step.terms.dt - step.terms.elapsed), k.ends_move = ends_move_;
    }
    bool any_far = false;
    for (const Kind& kind : kinds_)
        any_far |= groups_.chunks > 1 && kind.begin[groups_.far()] < kind.begin[groups_.far() + 1];
    phases_.clear(), parts_.clear();
    const auto add_sweep = [&](Kernel kernel) {
        const auto add = [&](Part part, PhaseKind phase) {
            parts_.push_back({kernel, part}), phases_.push_back(phase);
        };
        add(Part::chunks, PhaseKind::side_by_side);
        if (any_far) add(Part::far, PhaseKind::alone);
        add(Part::borders, PhaseKind::side_by_side);
    };
    if (begin == Begin::step) add_sweep(Kernel::give);
    add_sweep(begin == Begin::nothing ? Kernel::next : Kernel::first);
    add_sweep(Kernel::last);
    const double work = kNanosecondsToSweep * static_cast<double>(parts_of_joints_) * 2;
    loops.executor->for_each_phase(phases_, groups_.tasks(), work, [&](std::size_t phase, std::size_t task) {
        const auto [kernel, part] = parts_[phase];
        const std::size_t chunk = 2 * task;
        if (part == Part::far) return run_group(groups_.far(), kernel);
        if (part == Part::borders) {
            if (chunk > 0 && groups_.has_border(chunk - 1)) run_group(TaskGroups::across(chunk - 1), kernel);
            return;
        }
        if (chunk >= groups_.chunks) return;
        run_group(TaskGroups::inside(chunk), kernel);
        if (!groups_.has_border(chunk)) return;
        run_group(TaskGroups::across(chunk), kernel);
        run_group(TaskGroups::inside(chunk + 1), kernel);
    });
}

/// What the spring, the motor and the ends of a joint may have given: the motor its impulse times the mean
/// rate of the length or angle, an end that moves its own times its rate, the spring only that part of its
/// impulse that pulls it to its rest, for the rest of it damps (constraints/joints/spring_law.hpp).
template <class Real>
double SweptJoints<Real>::work_of_drive(const JointStep<Real>& step, std::size_t kind, std::size_t i) const {
    const Kind& own = kinds_[kind];
    if ((needs_of(kind) & kDrives) == 0) return 0;
    if (own.impulse_x[i] == 0 && own.impulse_y[i] == 0 && !ends_move_) return 0;
    const bool has_arms = kind != kAngles;
    struct End {
        double rate;          // m/s or rad/s, mean of the substep
        double inverse_mass;  // 1/kg or 1/(kg m²), along the coordinate
    };
    const auto end_of = [&](std::int32_t number, Vec2 arm, double per_rim, double seen) -> End {
        if (number >= first_beyond_) return {};
        const Real* record = &step.records.velocity[4 * static_cast<std::size_t>(number)];
        const auto [x, y, rim] = step.records.free_flight(number, step.terms);
        const double turning = 2 * std::fmax(static_cast<double>(record[3]), 0) * per_rim * per_rim * seen,
                     spin = turning > 0 ? 0.5 * per_rim * seen * (rim + static_cast<double>(record[2])) : 0;
        if (!has_arms) return {spin, turning};
        const Vec2 normal{own.normal_x[i], own.normal_y[i]};
        const double lever = cross(arm, normal);
        return {0.5 * dot(normal, Vec2{x, y} + Vec2{record[0], record[1]}) + spin * lever,
                std::fabs(static_cast<double>(record[3])) + turning * lever * lever};
    };
    const Vec2 arm_a = has_arms ? Vec2{own.arm_a_x[i], own.arm_a_y[i]} : Vec2{},
               arm_b = has_arms ? Vec2{own.arm_b_x[i], own.arm_b_y[i]} : Vec2{};
    const End a = end_of(own.a[i], arm_a, own.per_rim_a[i], own.seen_a[i]),
              b = end_of(own.b[i], arm_b, own.per_rim_b[i], own.seen_b[i]);
    const double inverse = a.inverse_mass + b.inverse_mass, rest = has_arms ? own.length[i] : Real(0),
                 off = static_cast<double>(own.value[i]) - rest,
                 pull = inverse > 0 ? -static_cast<double>(own.alpha[i]) * off / inverse : 0;
    const double of_ends = static_cast<double>(own.impulse_z[i]) * static_cast<double>(own.lower_rate[i]) +
                           static_cast<double>(own.impulse_w[i]) * static_cast<double>(own.upper_rate[i]);
    return (pull + static_cast<double>(own.impulse_y[i])) * (b.rate - a.rate) + of_ends;
}

/// A body goes straight on while it turns, and a joint brings it back to its curved path: it is asked for the
/// velocity v that a substep's path bends by (kernels/joints/sweep_joints.hpp), and its impulse l then does
/// the work l v on top of what a joint along a straight path would take. What l is to give its bodies v is
/// worth v² times the mass that moves; joints that press against contacts have l of any size, which gives
/// bodies no v and no reason to gain.
template <class Real>
double SweptJoints<Real>::work_of_bend(const JointStep<Real>& step, std::size_t kind, std::size_t i) const {
    const Kind& own = kinds_[kind];
    if (kind == kAngles) return 0;
    const Vec2 impulse = impulse_on_b(own, i, kind);
    if (impulse == Vec2{}) return 0;
    const double h = step.terms.substep_dt;
    const bool has_arms = kind != kRods;
    // rad/s · rad, with the bounds of the kernels
    const auto bend_at = [&](double spin) {
        return std::fabs(spin) * std::fmin(h * std::fabs(spin), kMostBend);
    };
    struct End {
        Vec2 velocity, bend;  // m/s, of the anchor
        double inverse_mass;  // 1/kg, of the body
    };
    const auto end_of = [&](std::int32_t number, Vec2 arm, double per_rim) -> End {
        const Real* record = &step.records.velocity[4 * static_cast<std::size_t>(number)];
        const double spin = per_rim * static_cast<double>(record[2]),
                     strain = 4 * h * std::fabs(dot(arm, impulse)) * 2 * per_rim * per_rim *
                              std::fmax(static_cast<double>(record[3]), 0),
                     share = 1 / (1 + strain * strain);
        return {Vec2{record[0], record[1]} + spin * Vec2{-arm.y, arm.x}, (-0.5 * share * bend_at(spin)) * arm,
                std::fabs(static_cast<double>(record[3]))};
    };
    const End a = has_arms ? end_of(own.a[i], {own.arm_a_x[i], own.arm_a_y[i]}, own.per_rim_a[i])
                           : end_of(own.a[i], {}, 0),
              b = has_arms ? end_of(own.b[i], {own.arm_b_x[i], own.arm_b_y[i]}, own.per_rim_b[i])
                           : end_of(own.b[i], {}, 0);
    Vec2 bend = b.bend - a.bend;
    if (kind != kHinges && own.per_length[i] > 0) {
        const Vec2 normal{own.normal_x[i], own.normal_y[i]};
        const double across = cross(normal, b.velocity - a.velocity), per_length = own.per_length[i];
        bend += (0.5 * bend_at(across * per_length) / per_length) * normal;
    }
    const double most = kBodiesOfBend * length_squared(bend) / (a.inverse_mass + b.inverse_mass);
    return std::clamp(-dot(impulse, bend), -most, most);
}

template <class Real>
void SweptJoints<Real>::book(const JointStep<Real>& step, Books& books) const {
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        const Kind& own = kinds_[kind];
        for (std::size_t i = 0; i < own.slot.size(); ++i) {
            if (own.slot[i] < 0) continue;
            if (kind == kAngles) {
                for (const auto& [number, per_rim, sign] :
                     {std::tuple{own.a[i], own.per_rim_a[i] * own.seen_a[i], -0.5},
                      std::tuple{own.b[i], own.per_rim_b[i] * own.seen_b[i], 0.5}}) {
                    const Real* record = &step.records.velocity[4 * static_cast<std::size_t>(number)];
                    if (number >= first_beyond_ || !(record[3] > Real(0))) continue;
                    books.joints +=
                        sign * sum_of_impulses(own, i) * static_cast<double>(per_rim) *
                        (step.records.start_of_substep(number)[2] + static_cast<double>(record[2]));
                }
                continue;
            }
            const Vec2 j = impulse_on_b(own, i, kind);
            const auto work_on = [&](std::int32_t number, Vec2 impulse, Vec2 arm, double per_rim) {
                if (number >= first_beyond_) return -1 * impulse;
                const auto row = static_cast<std::size_t>(number);
                const Real* record = &step.records.velocity[4 * row];
                const auto [x, y, rim] = step.records.start_of_substep(number);
                books.joints += 0.5 * dot(impulse, Vec2{x, y} + Vec2{record[0], record[1]});
                if (record[3] > Real(0))
                    books.joints +=
                        0.5 * per_rim * cross(arm, impulse) * (rim + static_cast<double>(record[2]));
                return Vec2{};
            };
            const bool has_arms = kind != kRods;
            const Vec2 arm_a = has_arms ? Vec2{own.arm_a_x[i], own.arm_a_y[i]} : Vec2{},
                       arm_b = has_arms ? Vec2{own.arm_b_x[i], own.arm_b_y[i]} : Vec2{};
            books.immovable_momentum -=
                work_on(own.a[i], -1 * j, arm_a, has_arms ? own.per_rim_a[i] * own.seen_a[i] : 0);
            books.immovable_momentum -=
                work_on(own.b[i], j, arm_b, has_arms ? own.per_rim_b[i] * own.seen_b[i] : 0);
        }
    }
}

template <class Real>
std::size_t SweptJoints<Real>::bytes() const {
    std::size_t bytes = no_turn_.bytes() + stiffness_.bytes() + breakable_.capacity() * sizeof(Breakable) +
                        moments_.capacity() * sizeof(Moments);
    for (const Kind& kind : kinds_) {
        bytes += kind.a.bytes() + kind.b.bytes() + kind.slot.bytes() + kind.order.bytes() +
                 kind.sources.capacity() * sizeof(typename Kind::Source);
        const_cast<Kind&>(kind).for_each_column(
            [&](Column<Real>& column, unsigned) { bytes += column.bytes(); });
    }
    return bytes;
}

template class SweptJoints<float>;
template class SweptJoints<double>;

}  // namespace carom
