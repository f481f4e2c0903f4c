#pragma once

#include <cstdint>

namespace carom {
namespace {

/// Row numbers of a batch of consecutive records, counted from its first: what load_rows4 takes.
alignas(64) constexpr std::int32_t kConsecutive[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

}  // namespace
}  // namespace carom
