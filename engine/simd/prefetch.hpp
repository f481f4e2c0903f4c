#pragma once

namespace carom {

/// Asks for the cache line at `address`, which may be any. gcc 12 drops __builtin_prefetch from loops that do
/// nothing else, so the instruction is written out where we know it.
inline void prefetch(const void* address) {
#if defined(__x86_64__)
    asm volatile("prefetcht0 %0" : : "m"(*static_cast<const char*>(address)));
#else
    __builtin_prefetch(address);
#endif
}

}  // namespace carom
