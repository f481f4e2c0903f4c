#pragma once

#include <cstdint>

namespace carom {

/// Bits of the flags column that the broadphase reads.
inline constexpr std::uint8_t kImmovable = 1;  // pairs of two such bodies are no candidates
inline constexpr std::uint8_t kDisabled = 2;   // no candidates at all

}  // namespace carom
