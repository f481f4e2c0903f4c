#pragma once

#include <cstdint>

namespace carom {

/// Names a body for good: rows of the columns move, handles do not. A removed body's handle goes stale.
struct BodyId {
    std::uint32_t index = UINT32_MAX;
    std::uint32_t generation = 0;

    friend bool operator==(BodyId, BodyId) = default;
};

/// Names a joint for good; a removed joint's handle goes stale.
struct JointId {
    std::uint32_t index = UINT32_MAX;
    std::uint32_t generation = 0;

    /// No aggregate, so that `world.remove({3, 0})` still names a body.
    constexpr JointId() {}
    static constexpr JointId of(std::uint32_t index, std::uint32_t generation = 0) {
        JointId id;
        id.index = index, id.generation = generation;
        return id;
    }

    friend bool operator==(JointId, JointId) = default;
};

}  // namespace carom
