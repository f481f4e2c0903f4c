#include "solvers/joints/joint_bundles.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

namespace carom {
namespace {

/// Sorts parts by colour: greedily, in the order of the slots, a bit for each colour that a body has.
/// @return the number of colours; 0: there are not enough
std::size_t sort_by_colour(std::vector<MechanismPart>& parts, std::size_t bodies) {
    std::vector<std::uint64_t> taken(bodies);
    std::vector<std::pair<std::size_t, MechanismPart>> coloured;
    std::size_t colours = 1;
    for (const MechanismPart& part : parts) {
        std::uint64_t &of_a = taken[static_cast<std::size_t>(part.a)],
                      &of_b = taken[static_cast<std::size_t>(part.b)];
        const auto colour = static_cast<std::size_t>(std::countr_one(of_a | of_b));
        if (colour == kMostColoursOfJoints) return 0;
        of_a |= std::uint64_t{1} << colour, of_b |= std::uint64_t{1} << colour;
        coloured.push_back({colour, part}), colours = std::max(colours, colour + 1);
    }
    std::stable_sort(coloured.begin(), coloured.end(),
                     [](const auto& left, const auto& right) { return left.first < right.first; });
    std::transform(coloured.begin(), coloured.end(), parts.begin(),
                   [](const auto& one) { return one.second; });
    return colours;
}

}  // namespace

std::vector<std::int32_t> Mechanism::shape() const {
    std::vector<std::int32_t> shape{static_cast<std::int32_t>(rows.size()),
                                    static_cast<std::int32_t>(hinges.size()), hangs() ? 1 : 0};
    for (const std::vector<MechanismPart>* parts : {&hinges, &angles})
        for (const MechanismPart& part : *parts) shape.push_back(part.a), shape.push_back(part.b);
    return shape;
}

std::vector<JointBranch> Mechanism::tree() const {
    std::vector<JointBranch> tree;
    if (hinges.size() + 1 != rows.size()) return tree;
    std::vector<std::int32_t> reached{0};
    std::vector<bool> is_reached(rows.size());
    is_reached[0] = true;
    for (std::size_t next = 0; next < reached.size(); ++next)
        for (std::size_t j = 0; j < hinges.size(); ++j) {
            const MechanismPart& hinge = hinges[j];
            const std::int32_t parent = reached[next];
            if (hinge.a != parent && hinge.b != parent) continue;
            const std::int32_t child = hinge.a == parent ? hinge.b : hinge.a;
            if (is_reached[static_cast<std::size_t>(child)]) continue;
            const auto angle = std::find_if(angles.begin(), angles.end(), [&](const MechanismPart& part) {
                return part.slot == hinge.slot;
            });
            const auto of_angle = static_cast<std::int32_t>(angle - angles.begin());
            tree.push_back({.hinge = j,
                            .angle = angle == angles.end() ? -1 : of_angle,
                            .parent = parent,
                            .child = child,
                            .parent_is_a = hinge.a == parent});
            reached.push_back(child), is_reached[static_cast<std::size_t>(child)] = true;
        }
    return tree.size() == hinges.size() ? tree : std::vector<JointBranch>{};
}

template <class Real>
bool is_hung(const WorldState<Real>& world, const StoredJoint& joint) {
    const auto stands = [&](BodyId id) {
        const std::size_t row = world.handles.row_of_slot(id.index);
        return row >= world.bodies.count || world.bodies.is_immovable(row);
    };
    return joint.is_on_world() || stands(joint.a) || stands(joint.b);
}

template <class Real>
Mechanism mechanism_of(const WorldState<Real>& world, const std::vector<std::size_t>& slots,
                       bool (*has_angle_part)(const StoredJoint&)) {
    Mechanism mechanism;
    const auto on_world = std::count_if(slots.begin(), slots.end(),
                                        [&](std::size_t slot) { return world.joints[slot].is_on_world(); });
    if (on_world > 1) return {};
    if (on_world == 1) mechanism.rows.push_back(Mechanism::kWorld);
    const auto number_of = [&](BodyId id) {
        const std::int32_t row = id == BodyId{}
                                     ? Mechanism::kWorld
                                     : static_cast<std::int32_t>(world.handles.row_of_slot(id.index));
        const auto at = std::find(mechanism.rows.begin(), mechanism.rows.end(), row);
        const auto number = static_cast<std::int32_t>(at - mechanism.rows.begin());
        if (at == mechanism.rows.end()) mechanism.rows.push_back(row);
        return number;
    };
    for (const std::size_t slot : slots) {
        const StoredJoint& joint = world.joints[slot];
        if (joint.type != JointType::revolute && joint.type != JointType::weld) return {};
        if (is_hung(world, joint) && !joint.is_on_world()) return {};
        const std::int32_t a = number_of(joint.a), b = number_of(joint.b);
        if (mechanism.rows.size() > kMostBodiesOfBundle) return {};
        mechanism.hinges.push_back({slot, a, b});
        if (has_angle_part(joint)) mechanism.angles.push_back({slot, a, b});
    }
    const std::size_t bodies = mechanism.rows.size(), of_hinges = sort_by_colour(mechanism.hinges, bodies),
                      of_angles = sort_by_colour(mechanism.angles, bodies);
    if (of_hinges == 0 || of_angles == 0) return {};
    mechanism.colours = std::max(of_hinges, of_angles);
    return mechanism;
}

template bool is_hung(const WorldState<float>&, const StoredJoint&);
template bool is_hung(const WorldState<double>&, const StoredJoint&);

void JointBundles::arrange(std::int32_t first_still, std::size_t first_hinge, std::size_t first_angle) {
    std::vector<std::vector<std::int32_t>> shapes(mechanisms.size());
    std::vector<std::int32_t> lowest(mechanisms.size());
    for (std::size_t i = 0; i < mechanisms.size(); ++i) {
        shapes[i] = mechanisms[i].shape();
        lowest[i] = *std::min_element(mechanisms[i].rows.begin() + (mechanisms[i].hangs() ? 1 : 0),
                                      mechanisms[i].rows.end());
    }
    std::vector<std::size_t> order(mechanisms.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t left, std::size_t right) {
        return shapes[left] != shapes[right] ? shapes[left] < shapes[right] : lowest[left] < lowest[right];
    });
    std::vector<Mechanism> sorted;
    for (const std::size_t i : order) sorted.push_back(std::move(mechanisms[i]));
    mechanisms = std::move(sorted);
    bundles.clear(), rows.clear(), branches.clear();
    for (std::size_t first = 0; first < order.size();) {
        std::size_t last = first + 1;
        while (last < order.size() && last < first + kJointBlock &&
               shapes[order[last]] == shapes[order[first]])
            ++last;
        const Mechanism& one = mechanisms[first];
        const std::size_t bodies = one.rows.size();
        const std::vector<JointBranch> tree = one.tree();
        bundles.push_back({.mechanisms = last - first,
                           .bodies = bodies,
                           .first_body = rows.size() / kJointBlock,
                           .hinges = one.hinges.size(),
                           .first_hinge = first_hinge,
                           .angles = one.angles.size(),
                           .first_angle = first_angle,
                           .branches = tree.size(),
                           .first_branch = branches.size(),
                           .hangs = one.hangs()});
        branches.insert(branches.end(), tree.begin(), tree.end());
        for (std::size_t body = 0; body < bodies; ++body)
            for (std::size_t lane = 0; lane < kJointBlock; ++lane) {
                const bool is_one = first + lane < last && !(one.hangs() && body == 0);
                rows.push_back(is_one ? mechanisms[first + lane].rows[body] : first_still);
            }
        ++first_still;
        first_hinge += kJointBlock * one.hinges.size(), first_angle += kJointBlock * one.angles.size();
        first = last;
    }
}

std::size_t JointBundles::bytes() const {
    std::size_t bytes = bundles.capacity() * sizeof(JointBundle) + rows.capacity() * sizeof(std::int32_t) +
                        branches.capacity() * sizeof(JointBranch);
    for (const Mechanism& one : mechanisms)
        bytes += sizeof(one) + one.rows.capacity() * sizeof(std::int32_t) +
                 (one.hinges.capacity() + one.angles.capacity()) * sizeof(MechanismPart);
    return bytes;
}

template Mechanism mechanism_of(const WorldState<float>&, const std::vector<std::size_t>&,
                                bool (*)(const StoredJoint&));
template Mechanism mechanism_of(const WorldState<double>&, const std::vector<std::size_t>&,
                                bool (*)(const StoredJoint&));

}  // namespace carom
