#pragma once

#include <cstdlib>
#include <cstring>

namespace carom::test {

/// Whether this build steps at a fraction of the release build's speed: assertions or a sanitizer are on.
#if !defined(NDEBUG) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kIsSlowBuild = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool kIsSlowBuild = true;
#else
inline constexpr bool kIsSlowBuild = false;
#endif
#else
inline constexpr bool kIsSlowBuild = false;
#endif

/// Whether long tests do a part of what they do at full length: in slow builds, and where CAROM_TEST_EFFORT
/// says so, as ctest does for the instruction sets that worlds do not choose by themselves.
inline bool is_effort_reduced() {
    static const char* const wish = std::getenv("CAROM_TEST_EFFORT");
    return kIsSlowBuild || (wish && std::strcmp(wish, "reduced") == 0);
}

/// How much of something a test does: all of it, or less where that would take minutes.
template <class T>
T scaled(T full, T reduced) {
    return is_effort_reduced() ? reduced : full;
}

}  // namespace carom::test
