#pragma once

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

/// How much of something a test does: all of it in release builds, less where that would take minutes.
template <class T>
constexpr T scaled(T full, T reduced) {
    return kIsSlowBuild ? reduced : full;
}

}  // namespace carom::test
