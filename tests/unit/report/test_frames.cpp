#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "report/frames/frame_choice.hpp"
#include "report/frames/quantised_frame.hpp"
#include "report/page/base64.hpp"

namespace test_frames {

using namespace carom::report;

namespace {

constexpr std::size_t kPage = 50'000'000;

/// What a page needs for the frames of a choice [bytes].
double bytes_of(const FrameChoice& choice) {
    const std::size_t numbers = 2 + (choice.velocity ? 2 : 0) + (choice.angle ? 1 : 0);
    return 4.0 / 3 * 2 * static_cast<double>(numbers * choice.frames.size() * choice.bodies.size());
}

void check_ascending(const std::vector<std::size_t>& chosen, std::size_t size) {
    CHECK(std::is_sorted(chosen.begin(), chosen.end()));
    CHECK(std::adjacent_find(chosen.begin(), chosen.end()) == chosen.end());
    REQUIRE(!chosen.empty());
    CHECK(chosen.back() < size);
}

}  // namespace

TEST_SUITE("report/frame_choice") {
    TEST_CASE("whatever the trajectory, the page keeps its size and shows first and last frame") {
        for (const std::size_t frames : {1u, 2u, 61u, 501u, 100'000u})
            for (const std::size_t bodies : {1u, 5u, 10'000u, 100'000u, 1'000'000u})
                for (const std::size_t bytes : {std::size_t{0}, std::size_t{1'000'000}, kPage})
                    for (const bool turns : {false, true}) {
                        CAPTURE(frames);
                        CAPTURE(bodies);
                        CAPTURE(bytes);
                        const FrameChoice choice = choose_frames(frames, bodies, turns, bytes);
                        check_ascending(choice.frames, frames);
                        check_ascending(choice.bodies, bodies);
                        CHECK(choice.frames.front() == 0);
                        CHECK(choice.frames.back() == frames - 1);
                        const double one_body = 4.0 / 3 * 6 * static_cast<double>(choice.frames.size());
                        CHECK(bytes_of(choice) <= static_cast<double>(bytes) + one_body);
                        CHECK(choice.angle == turns);
                    }
    }

    TEST_CASE("what fits is shown whole, and nothing is said") {
        const FrameChoice choice = choose_frames(301, 10'000, false, kPage);
        CHECK(choice.frames.size() == 301);
        CHECK(choice.bodies.size() == 10'000);
        CHECK(choice.velocity);
        CHECK(choice.words.empty());
    }

    TEST_CASE("what is left out is said: velocities first, then frames, then bodies") {
        const auto words = [](const FrameChoice& choice) {
            std::string all;
            for (const std::string& sentence : choice.words) all += sentence;
            return all;
        };
        const FrameChoice slow = choose_frames(60, 100'000, false, kPage);
        CHECK(!slow.velocity);
        CHECK(slow.frames.size() == 60);
        CHECK(words(slow).find("Velocities are left out") != std::string::npos);
        const FrameChoice few = choose_frames(600, 100'000, false, kPage);
        CHECK(few.frames.size() < 100);
        CHECK(few.frames.size() >= kFewestFrames);
        CHECK(words(few).find(" of 600 frames") != std::string::npos);
        const FrameChoice sample = choose_frames(100, 1'000'000, false, kPage);
        CHECK(sample.bodies.size() == kMostBodies);
        CHECK(words(sample).find("100000 of 1000000 bodies") != std::string::npos);
    }
}

TEST_SUITE("report/quantised_frame") {
    TEST_CASE("positions come back to half a step, velocities and angles too") {
        std::mt19937 random(3);
        std::uniform_real_distribution<float> place(-40, 100), speed(-3, 3), turn(-9, 9);
        constexpr std::size_t kBodies = 500;
        std::vector<float> position(2 * kBodies), velocity(2 * kBodies), angle(kBodies);
        for (float& value : position) value = place(random);
        for (float& value : velocity) value = speed(random);
        for (float& value : angle) value = turn(random);
        const QuantisedFrame frame = quantise(position, velocity, angle);
        REQUIRE(frame.bits.size() == 5 * kBodies);
        CHECK(frame.lost == 0);
        CHECK(frame.x.step < 140.0 / 65534 * 1.0001);
        for (std::size_t i = 0; i < kBodies; ++i) {
            CHECK(std::abs(frame.x.base + frame.x.step * frame.bits[i] - position[2 * i]) <=
                  0.501 * frame.x.step);
            CHECK(std::abs(frame.y.base + frame.y.step * frame.bits[kBodies + i] - position[2 * i + 1]) <=
                  0.501 * frame.y.step);
            std::int16_t vy = 0;
            std::memcpy(&vy, &frame.bits[3 * kBodies + i], sizeof vy);
            CHECK(std::abs(frame.speed_step * vy - velocity[2 * i + 1]) <= 0.501 * frame.speed_step);
            const double shown = frame.bits[4 * kBodies + i] * 2 * 3.14159265358979 / 65536;
            CHECK(std::abs(std::sin((shown - angle[i]) / 2)) < 1e-4);
        }
    }

    TEST_CASE("a body far away does not blur the others; it is lost, and so is one that is nowhere") {
        std::vector<float> position;
        for (int i = 0; i < 200; ++i) {
            position.push_back(static_cast<float>(i % 20));
            position.push_back(static_cast<float>(i / 20));
        }
        position[0] = 1e7f;
        position[11] = std::numeric_limits<float>::quiet_NaN();
        const QuantisedFrame frame = quantise(position, {}, {});
        CHECK(frame.lost == 2);
        CHECK(frame.bits[0] == kNowhere);
        CHECK(frame.bits[200 + 5] == kNowhere);
        CHECK(frame.x.step < 0.01);
        CHECK(std::abs(frame.x.base + frame.x.step * frame.bits[7] - 7) < 0.01);
    }

    TEST_CASE("of few bodies none is lost, however they lie") {
        const std::vector<float> position{0, 0, 1e-3f, 0, 500, 7};
        const QuantisedFrame frame = quantise(position, {}, {});
        CHECK(frame.lost == 0);
        CHECK(std::abs(frame.x.base + frame.x.step * frame.bits[2] - 500) < 0.01);
    }

    TEST_CASE("bodies at one place stay there") {
        const std::vector<float> position(20, 3.5f), still(20, 0.0f);
        const QuantisedFrame frame = quantise(position, still, {});
        CHECK(frame.lost == 0);
        for (std::size_t i = 0; i < 10; ++i) CHECK(frame.x.base + frame.x.step * frame.bits[i] == 3.5);
        CHECK(frame.speed_step == 0);
    }
}

TEST_SUITE("report/base64") {
    TEST_CASE("the examples of RFC 4648") {
        const char* const expected[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
        for (std::size_t length = 0; length <= 6; ++length) {
            const std::string text = std::string("foobar").substr(0, length);
            CHECK(base64_of<char>(text) == expected[length]);
        }
    }
}

}  // namespace test_frames
