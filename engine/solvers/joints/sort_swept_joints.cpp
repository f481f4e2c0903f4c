#include <algorithm>
#include <bit>
#include <utility>

#include "solvers/joints/swept_joints.hpp"

// Which swept joints are in which group, colour, bundle and place.

namespace carom {
namespace {

constexpr std::size_t kFewestChunks = 8;         // or one: four tasks for the threads to share
constexpr std::size_t kFewestRowsOfChunk = 512;  // fewer: too many short colours

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
std::vector<std::size_t> SweptJoints<Real>::sort(const WorldState<Real>& world,
                                                 std::vector<std::size_t> slots,
                                                 const std::vector<std::vector<std::size_t>>& crowd) {
    const std::size_t rows = world.bodies.count;
    first_beyond_ = static_cast<std::int32_t>(rows), joints_ = parts_of_joints_ = 0, colours_ = 0;
    longest_ = 0, is_loaded_ = false;
    breakable_.clear();
    groups_ = {}, bundles_.clear();
    has_joints_of_groups_ = false;
    kinds_.resize(slots.empty() && crowd.empty() ? std::size_t{0} : std::size_t{kKinds});
    if (kinds_.empty()) return {};
    for (const std::vector<std::size_t>& group : crowd) {
        Mechanism mechanism = mechanism_of(world, group, &has_angle_part);
        if (mechanism.rows.empty())
            slots.insert(slots.end(), group.begin(), group.end());
        else
            bundles_.mechanisms.push_back(std::move(mechanism));
    }
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
        if (entry.colour == kMostColoursOfJoints) {
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
            if (entry.kind == kind && entry.colour != kMostColoursOfJoints) of_kind.push_back(entry);
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
            if (moves(entry->a)) own.a[at] = entry->a;
            if (moves(entry->b)) own.b[at] = entry->b;
            own.slot[at] = static_cast<std::int32_t>(entry->slot);
        }
    }
    has_joints_of_groups_ = parts_of_joints_ > 0;
    add_bundles();
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        kinds_[kind].find_order();
        for (std::size_t at = 0; at < kinds_[kind].slot.size(); ++at)
            if (const std::int32_t slot = kinds_[kind].slot[at];
                slot >= 0 && world.joints[static_cast<std::size_t>(slot)].may_break())
                breakable_.push_back({kind, at, {}});
    }
    return left_over;
}

/// The mechanisms of the crowd, behind the other joints.
template <class Real>
void SweptJoints<Real>::add_bundles() {
    Kind &hinges = kinds_[kHinges], &angles = kinds_[kAngles];
    const std::int32_t first_still = first_beyond_ + static_cast<std::int32_t>(groups_.count());
    bundles_.arrange(first_still, hinges.slot.size(), angles.slot.size());
    for (Kind* own : {&hinges, &angles}) {
        std::size_t places = own->slot.size();
        for (const JointBundle& bundle : bundles_.bundles)
            places += kJointBlock * (own == &hinges ? bundle.hinges : bundle.angles);
        own->resize(places, needs_of(own == &hinges ? kHinges : kAngles));
        own->of_bundle_a.resize(places), own->of_bundle_b.resize(places);
    }
    const Mechanism* first = bundles_.mechanisms.data();  // of the bundle
    std::int32_t still = first_still;
    for (const JointBundle& bundle : bundles_.bundles) {
        const auto add = [&](Kind& own, std::size_t begin, std::vector<MechanismPart> Mechanism::*parts) {
            for (std::size_t j = 0; j < ((*first).*parts).size(); ++j)
                for (std::size_t lane = 0; lane < kJointBlock; ++lane) {
                    const bool is_joint = lane < bundle.mechanisms;
                    const Mechanism& of = first[is_joint ? lane : 0];
                    const MechanismPart& part = (of.*parts)[j];
                    const std::size_t at = begin + kJointBlock * j + lane;
                    const auto row_of = [&](std::int32_t body) {
                        const std::int32_t row = of.rows[static_cast<std::size_t>(body)];
                        return is_joint && row != Mechanism::kWorld ? row : still;
                    };
                    own.a[at] = row_of(part.a), own.b[at] = row_of(part.b);
                    own.of_bundle_a[at] = part.a, own.of_bundle_b[at] = part.b;
                    own.slot[at] = is_joint ? static_cast<std::int32_t>(part.slot) : -1;
                }
        };
        add(hinges, bundle.first_hinge, &Mechanism::hinges);
        add(angles, bundle.first_angle, &Mechanism::angles);
        joints_ += bundle.mechanisms * bundle.hinges;
        parts_of_joints_ += bundle.mechanisms * (bundle.hinges + bundle.angles);
        colours_ = std::max(colours_, first->colours);
        first += bundle.mechanisms, ++still;
    }
    bundles_.mechanisms.clear();
}

template class SweptJoints<float>;
template class SweptJoints<double>;

}  // namespace carom
