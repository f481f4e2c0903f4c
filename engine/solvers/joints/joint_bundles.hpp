#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/joints/joint_arguments.hpp"
#include "state/world_state.hpp"

namespace carom {

inline constexpr std::size_t kMostColoursOfJoints = 64;  // bits of the word a body has for those it is in

/// A part of a joint of a mechanism, that of its points or that of its angle.
struct MechanismPart {
    std::size_t slot;
    std::int32_t a, b;  // numbers of bodies of the mechanism
};

/// Bodies that hinges and welds join to each other alone, ready to be swept: each part in the order of the
/// colours, of which no two parts share a body.
struct Mechanism {
    std::vector<std::int32_t> rows;             // of its bodies; kWorld: it hangs there, as its body 0
    std::vector<MechanismPart> hinges, angles;  // by colour
    std::size_t colours = 0;

    /// What a lane of a bundle has to have in common with the others: how the bodies are joined.
    std::vector<std::int32_t> shape() const;
    static constexpr std::int32_t kWorld = -1;
    bool hangs() const { return !rows.empty() && rows.front() == kWorld; }
    /// Its hinges as a tree, from its first body outwards; none where they close a loop.
    std::vector<JointBranch> tree() const;
};

/// Whether a joint hangs on the world, or on a body that nothing moves.
template <class Real>
bool is_hung(const WorldState<Real>& world, const StoredJoint& joint);

/// A group of joints as a mechanism; one without bodies if it has too many of them, or other joints, or hangs
/// on a static body or in two places.
/// @param has_angle_part  of each slot, whether something acts on the joint's angle
template <class Real>
Mechanism mechanism_of(const WorldState<Real>& world, const std::vector<std::size_t>& slots,
                       bool (*has_angle_part)(const StoredJoint&));

/// Mechanisms that are joined alike, side by side: which of them share a bundle, in which order.
///
/// They are sorted by how they are joined, then by where their bodies are in memory. What a mechanism does
/// does not depend on its bundle.
struct JointBundles {
    std::vector<JointBundle> bundles;
    std::vector<Mechanism> mechanisms;  // kJointBlock at most of each bundle, in their order
    std::vector<std::int32_t> rows;     // [bodies of all bundles][kJointBlock]
    std::vector<JointBranch> branches;  // of the bundles that are trees

    void clear() { bundles.clear(), mechanisms.clear(), rows.clear(), branches.clear(); }
    bool empty() const { return bundles.empty(); }
    /// Sorts the mechanisms and cuts them into bundles.
    /// @param first_still  row at rest for the lanes that the first bundle does not need; each has its own
    /// @param first_hinge, first_angle  places of the first parts in their columns
    void arrange(std::int32_t first_still, std::size_t first_hinge, std::size_t first_angle);
    std::size_t bytes() const;
};

}  // namespace carom
