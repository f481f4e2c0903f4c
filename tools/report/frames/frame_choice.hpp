#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace carom::report {

/// What of a trajectory a page shows, so that it stays within its size.
struct FrameChoice {
    std::vector<std::size_t> frames;  ///< of the trajectory, ascending; the first and the last are among them
    std::vector<std::size_t> bodies;  ///< ascending
    bool velocity = true;             ///< whether velocities are on the page
    bool angle = false;
    std::vector<std::string> words;  ///< a sentence on each thing left out
};

/// First velocities go, then frames down to kFewestFrames, then bodies.
FrameChoice choose_frames(std::size_t frame_count, std::size_t body_count, bool turns, std::size_t bytes);

/// `count` of 0 ... size - 1, evenly, the first and the last among them (all if there are no more).
std::vector<std::size_t> evenly_chosen(std::size_t size, std::size_t count);

/// `count` of 0 ... size - 1, ascending, one from each of `count` parts of equal size, the same every time.
/// Chosen evenly, bodies that were made row by row would show stripes that are not there.
std::vector<std::size_t> randomly_chosen(std::size_t size, std::size_t count);

inline constexpr std::size_t kMostFrames = 3000;     // finer than a screen's slider
inline constexpr std::size_t kFewestFrames = 60;     // below, motion is not seen any more
inline constexpr std::size_t kMostBodies = 100'000;  // what a browser draws in a 30th of a second

}  // namespace carom::report
