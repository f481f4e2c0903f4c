#pragma once

#include <cstddef>
#include <cstdint>

namespace carom {

/// A row, or another number that is not below zero, as the index of a column.
inline std::size_t index(std::int32_t row) {
    return static_cast<std::size_t>(row);
}

}  // namespace carom
