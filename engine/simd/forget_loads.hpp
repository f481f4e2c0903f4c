#pragma once

namespace carom::simd {

/// Between two uses of the same indices: the compiler loads them again, from the first cache, where it would
/// save dozens of them on the stack and load them from there. Saves a pile 3 % of its time.
[[gnu::always_inline]] inline void forget_loads() {
    asm volatile("" ::: "memory");
}

}  // namespace carom::simd
