#include "solvers/joints/built_in_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "narrowphase/placed_convex.hpp"
#include "shapes/convex_geometry.hpp"
#include "sleeping/islands.hpp"

namespace carom {
namespace {

/// Overlap, in inradii of the thinner body, from which a pair counts as built in: several times what is left
/// between bodies that rest on each other.
constexpr double kBuiltIn = 0.05;

/// Pairs of one world, looked at piece by piece.
template <class Real>
class PairLooks {
  public:
    explicit PairLooks(const WorldState<Real>& world) : world_(world) {}

    /// Whether the circles around both overlap.
    bool are_near(std::size_t a, std::size_t b) const {
        return are_within(world_.bodies.radius[a], world_.bodies.radius[b], a, b);
    }
    bool are_apart(std::size_t a, std::size_t b) const {
        if (!are_near(a, b)) return true;
        const bool have_circles = !is_compound(a) && !is_compound(b);  // inside, around their centres
        if (have_circles && are_within(world_.bodies.inradius(a), world_.bodies.inradius(b), a, b))
            return false;
        return !(overlap(a, b) > 0);
    }
    /// How deep two bodies are in each other, as a share of the smaller inradius of two pieces; 0: apart.
    double overlap(std::size_t a, std::size_t b) const {
        double deepest = 0;
        for_each_piece(a, [&](const PlacedConvex& of_a) {
            for_each_piece(
                b, [&](const PlacedConvex& of_b) { deepest = std::fmax(deepest, overlap_of(of_a, of_b)); });
        });
        return deepest;
    }
    Vec2 place(std::size_t row) const {
        return {world_.bodies.position_x[row], world_.bodies.position_y[row]};
    }

  private:
    bool are_within(double of_a, double of_b, std::size_t a, std::size_t b) const {
        const double reach = of_a + of_b;
        return length_squared(place(b) - place(a)) < reach * reach;
    }
    bool is_compound(std::size_t row) const {
        return world_.bodies.has_shapes && !world_.shapes.pieces(world_.bodies.shape[row]).empty();
    }
    template <class Fn>
    void for_each_piece(std::size_t row, const Fn& fn) const {
        const Bodies<Real>& bodies = world_.bodies;
        const Rotation turn = rotation_by(bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0);
        if (!bodies.has_shapes)
            return fn(PlacedConvex{convex_shape_of<double>(Disc{static_cast<double>(bodies.radius[row])}),
                                   place(row), turn});
        world_.shapes.for_each_piece(bodies.shape[row],
                                     [&](const ConvexShape<Real>& shape, std::int32_t, const StoredPiece*) {
                                         fn(placed(shape, place(row), turn));
                                     });
    }

    const WorldState<Real>& world_;
};

/// A row in a mechanism, which is known by its smallest row that moves.
struct Member {
    std::int32_t mechanism, row;
    friend auto operator<=>(const Member&, const Member&) = default;
};

/// The rows of the mechanisms that some of these joints are in, by mechanism. Segments and chains are in
/// none, and neither are sensors.
template <class Real>
std::vector<Member> members_with(const WorldState<Real>& world, const std::vector<std::uint32_t>& joints) {
    Islands islands;
    islands.reset(world.bodies.rows());
    const auto row_of = [&](BodyId id) {
        return id == BodyId{} ? std::int32_t{-1}
                              : static_cast<std::int32_t>(world.handles.row_of_slot(id.index));
    };
    const auto moves = [&](std::int32_t row) {
        return row >= 0 && !world.bodies.is_immovable(static_cast<std::size_t>(row));
    };
    world.joints.for_each([&](std::size_t, const StoredJoint& joint) {
        const std::int32_t a = row_of(joint.a), b = row_of(joint.b);
        if (moves(a) && moves(b)) islands.join(a, b);
    });
    const auto mechanism_of = [&](const StoredJoint& joint) {
        const std::int32_t a = row_of(joint.a), b = row_of(joint.b);
        return moves(a) ? islands.island_of(a) : moves(b) ? islands.island_of(b) : -1;
    };
    std::vector<std::uint8_t> is_asked_for(world.bodies.rows());
    for (const std::uint32_t slot : joints) {
        if (!world.joints.has(slot)) continue;
        const std::int32_t mechanism = mechanism_of(world.joints[slot]);
        if (mechanism >= 0) is_asked_for[static_cast<std::size_t>(mechanism)] = 1;
    }
    std::vector<Member> members;
    world.joints.for_each([&](std::size_t, const StoredJoint& joint) {
        const std::int32_t mechanism = mechanism_of(joint);
        if (mechanism < 0 || !is_asked_for[static_cast<std::size_t>(mechanism)]) return;
        for (const std::int32_t row : {row_of(joint.a), row_of(joint.b)})
            if (row >= 0 && (world.bodies.flags_of(static_cast<std::size_t>(row)) & kNotInGrid) == 0)
                members.push_back({mechanism, row});
    });
    std::sort(members.begin(), members.end());
    members.erase(std::unique(members.begin(), members.end()), members.end());
    return members;
}

bool is_before(const BuiltInPair& one, const BuiltInPair& other) {
    return one.a.index != other.a.index ? one.a.index < other.a.index : one.b.index < other.b.index;
}

/// In the order of their slots.
BuiltInPair pair_of(BodyId a, BodyId b) {
    return a.index < b.index ? BuiltInPair{a, b} : BuiltInPair{b, a};
}

/// Which bodies joints join directly.
class JoinedPairs {
  public:
    explicit JoinedPairs(const JointStore& joints) {
        joints.for_each([&](std::size_t, const StoredJoint& joint) {
            if (joint.is_on_world()) return;
            pairs_.push_back({joint.a, joint.b}), pairs_.push_back({joint.b, joint.a});
        });
        std::sort(pairs_.begin(), pairs_.end(), is_before);
    }
    bool has(const BuiltInPair& pair) const {
        return std::binary_search(pairs_.begin(), pairs_.end(), pair, is_before);
    }
    /// Whether some body is joined to both.
    bool have_third(const BuiltInPair& pair) const {
        auto of_a = std::lower_bound(pairs_.begin(), pairs_.end(), BuiltInPair{pair.a, {0, 0}}, is_before);
        for (; of_a != pairs_.end() && of_a->a == pair.a; ++of_a)
            if (has({of_a->b, pair.b})) return true;
        return false;
    }

  private:
    std::vector<BuiltInPair> pairs_;  // each in both orders, ascending
};

/// Lists pairs of one mechanism that are in each other, in the order of their handles.
template <class Real>
std::vector<BuiltInPair> find_built_in(const WorldState<Real>& world, std::vector<Member> members) {
    const Bodies<Real>& bodies = world.bodies;
    const PairLooks<Real> looks(world);
    const auto left_end = [&](std::int32_t row) {
        const auto i = static_cast<std::size_t>(row);
        return looks.place(i).x - static_cast<double>(bodies.radius[i]);
    };
    // From left to right within each mechanism.
    std::sort(members.begin(), members.end(), [&](const Member& one, const Member& other) {
        const double x = left_end(one.row), of_other = left_end(other.row);
        return one.mechanism != other.mechanism ? one.mechanism < other.mechanism
               : x != of_other                  ? x < of_other
                                                : one.row < other.row;
    });
    const JoinedPairs joined(world.joints);
    std::vector<BuiltInPair> pairs;
    for (std::size_t i = 0; i < members.size(); ++i) {
        const auto a = static_cast<std::size_t>(members[i].row);
        const double right_end = looks.place(a).x + static_cast<double>(bodies.radius[a]);
        for (std::size_t k = i + 1; k < members.size() && members[k].mechanism == members[i].mechanism &&
                                    left_end(members[k].row) < right_end;
             ++k) {
            const auto b = static_cast<std::size_t>(members[k].row);
            if (bodies.is_immovable(a) && bodies.is_immovable(b)) continue;
            const BuiltInPair pair = pair_of(bodies.id[a], bodies.id[b]);
            if (joined.has(pair)) continue;
            // A floor that holds a mechanism by a rope is nothing that its feet may fall through.
            if ((bodies.is_immovable(a) || bodies.is_immovable(b)) && !joined.have_third(pair)) continue;
            if (!looks.are_near(a, b) || !world.may_collide(a, b)) continue;
            if (looks.overlap(a, b) > kBuiltIn) pairs.push_back(pair);
        }
    }
    std::sort(pairs.begin(), pairs.end(), is_before);
    return pairs;
}

}  // namespace

template <class Real>
bool watch_built_in_pairs(WorldState<Real>& world) {
    const PairLooks<Real> looks(world);
    const std::size_t awake = world.bodies.count;
    const bool any_apart = world.joints.let_touch([&](const BuiltInPair& pair) {
        const std::size_t a = world.handles.row_of_slot(pair.a.index),
                          b = world.handles.row_of_slot(pair.b.index);
        return a < awake && b < awake && looks.are_apart(a, b);
    });
    const std::vector<std::uint32_t> added = world.joints.take_added_slots();
    if (added.empty()) return any_apart;
    const std::vector<BuiltInPair> found = find_built_in(world, members_with(world, added));
    if (found.empty()) return any_apart;
    world.joints.add_built_in(found);
    return true;
}

template bool watch_built_in_pairs(WorldState<float>&);
template bool watch_built_in_pairs(WorldState<double>&);

}  // namespace carom
