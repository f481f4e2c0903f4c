#include "report/frames/frame_choice.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace carom::report {
namespace {

constexpr double kBase64 = 4.0 / 3;  // characters a byte
constexpr double kPositionBytes = 4, kVelocityBytes = 4,
                 kAngleBytes = 2;    // a body and frame, 16 bits a number
constexpr double kColumnBytes = 10;  // a body: radius, mass, colour

std::string of(std::size_t part, std::size_t all) {
    return std::to_string(part) + " of " + std::to_string(all);
}

}  // namespace

std::vector<std::size_t> evenly_chosen(std::size_t size, std::size_t count) {
    std::vector<std::size_t> chosen;
    if (size == 0) return chosen;
    count = std::clamp<std::size_t>(count, 1, size);
    for (std::size_t i = 0; i + 1 < count; ++i) chosen.push_back(i * (size - 1) / (count - 1));
    chosen.push_back(size - 1);
    return chosen;
}

std::vector<std::size_t> randomly_chosen(std::size_t size, std::size_t count) {
    std::vector<std::size_t> chosen;
    count = std::min(count, size);
    std::minstd_rand random(1);  // its numbers are the same everywhere
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t begin = i * size / count, end = (i + 1) * size / count;
        chosen.push_back(begin + random() % (end - begin));
    }
    return chosen;
}

FrameChoice choose_frames(std::size_t frame_count, std::size_t body_count, bool turns, std::size_t bytes) {
    FrameChoice choice;
    choice.angle = turns;
    std::size_t frames = std::min(frame_count, kMostFrames), bodies = std::min(body_count, kMostBodies);
    const double room = static_cast<double>(bytes) / kBase64;
    const auto frame_room = [&] { return std::max(0.0, room - kColumnBytes * static_cast<double>(bodies)); };
    const auto a_body = [&] {
        return kPositionBytes + (choice.velocity ? kVelocityBytes : 0) + (choice.angle ? kAngleBytes : 0);
    };
    const auto needed = [&] { return static_cast<double>(frames * bodies) * a_body(); };

    if (needed() > frame_room()) choice.velocity = false;
    if (needed() > frame_room()) {
        const double fitting = frame_room() / (a_body() * static_cast<double>(bodies));
        frames = std::clamp(static_cast<std::size_t>(fitting), std::min(frames, kFewestFrames), frames);
    }
    if (needed() > frame_room()) {
        const double a_shown_body = static_cast<double>(frames) * a_body() + kColumnBytes;
        bodies = std::max<std::size_t>(1, static_cast<std::size_t>(room / a_shown_body));
    }

    choice.frames = evenly_chosen(frame_count, frames);
    choice.bodies = randomly_chosen(body_count, bodies);
    if (!choice.velocity)
        choice.words.push_back(
            "Velocities are left out to keep this page small, so there are no arrows and no flashes.");
    if (choice.frames.size() < frame_count)
        choice.words.push_back("The player has " + of(choice.frames.size(), frame_count) +
                               " frames, evenly chosen; trajectory.h5 has all.");
    if (choice.bodies.size() < body_count)
        choice.words.push_back(
            "The player shows a sample of " + of(choice.bodies.size(), body_count) +
            " bodies, chosen at random, so there are gaps that the run did not have; trajectory.h5 has all.");
    return choice;
}

}  // namespace carom::report
