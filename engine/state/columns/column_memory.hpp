#pragma once

#include <cstddef>

namespace carom {

inline constexpr std::size_t kColumnAlignment = 64;  // bytes: a cache line, and the widest batch

/// Memory of columns, aligned to a cache line, its contents indeterminate. Large blocks share slabs that the
/// system is asked to back by huge pages: a world of a million bodies works in some hundred columns at once,
/// and with pages of 4 KiB a tenth of a step is spent on finding out where they are
/// (docs/decisions/0019-huge-pages.md). May be called by any thread.
/// @throws std::bad_alloc
/// Cost: of a large block O(blocks in use); rounded up to 64 KiB.
void* allocate_column(std::size_t bytes);

/// Gives back what allocate_column gave for so many bytes.
void release_column(void* column, std::size_t bytes) noexcept;

}  // namespace carom
