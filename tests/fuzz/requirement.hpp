#pragma once

#include <cstdio>
#include <cstdlib>

namespace carom::fuzz {

/// Ends the process, as a sanitizer does, and says what did not hold.
inline void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "does not hold: %s\n", what);
    std::abort();
}

}  // namespace carom::fuzz
