#include "narrowphase/impact_time.hpp"

#include <doctest/doctest.h>
#include <cmath>
#include <optional>
#include <random>
#include <string>

namespace test_impact_time {

using namespace carom;

// The oracle shares no formula with the engine: it flies bodies by x(t) with exp() and log(), looks for the
// first sample at which a distance has fallen to its limit, and bisects between that and the one before.

namespace {

using Long = long double;

constexpr int kSamples = 2000;
constexpr Long kClearOfGrazing = 0.05L;  // m/s; slower meetings may be seen by one and not by the other

/// t - s over k, from the definition of the clock s = (1 - exp(-k t)) / k.
Long fall(Long s, Long drag) {
    if (drag == 0) return s * s / 2;
    const Long t = -std::log1p(-drag * s) / drag;
    return (t - s) / drag;
}

/// The first clock in the window at which gap(s) has fallen to zero; the window's start if it is below zero
/// there and falls.
template <class Gap>
std::optional<Long> first_fall_to_zero(const Gap& gap, const Window& window) {
    const Long from = window.from, length = static_cast<Long>(window.until) - from;
    Long before = from, gap_before = gap(from);
    for (int i = 1; i <= kSamples; ++i) {
        const Long s = from + length * i / kSamples, now = gap(s);
        if (gap_before <= 0 && now < gap_before) return before;  // inside already, and going deeper
        if (gap_before > 0 && now <= 0) {
            Long outside = before, inside = s;
            for (int halving = 0; halving < 60; ++halving) {
                const Long middle = (outside + inside) / 2;
                (gap(middle) > 0 ? outside : inside) = middle;
            }
            return inside;
        }
        before = s, gap_before = now;
    }
    return std::nullopt;
}

/// The least gap in the window: near zero one of the two may see a touch that the other does not.
template <class Gap>
Long least(const Gap& gap, const Window& window) {
    Long smallest = gap(window.from);
    for (int i = 1; i <= kSamples; ++i)
        smallest = std::fmin(
            smallest, gap(window.from + (static_cast<Long>(window.until) - window.from) * i / kSamples));
    return smallest;
}

template <class Gap>
Long most(const Gap& gap, const Window& window) {
    return -least([&](Long s) { return -gap(s); }, window);
}

/// How far an answer is from the oracle's [s], if the meeting is no grazing one; else nothing.
template <class Gap>
std::optional<Long> error_of(double answer, const Gap& gap, const Window& window, int& meetings) {
    const std::optional<Long> expected = first_fall_to_zero(gap, window);
    constexpr Long kStep = 1e-6L;  // s
    if (!expected) {
        if (answer == kNever) return 0;
        return std::fabs(least(gap, window)) < 1e-6L ? std::nullopt : std::optional<Long>(1);
    }
    const Long rate = (gap(*expected) - gap(*expected + kStep)) / kStep;
    if (rate < kClearOfGrazing || *expected > static_cast<Long>(window.until) - 1e-9L) return std::nullopt;
    ++meetings;
    return answer == kNever ? Long(1) : std::fabs(static_cast<Long>(answer) - *expected);
}

struct Numbers {
    std::mt19937 random{23};
    double operator()(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    }
};

constexpr int kCases = 600;

}  // namespace

TEST_SUITE("narrowphase/impact_time") {
    TEST_CASE("a pair in straight relative motion meets when bisection says") {
        Numbers number;
        int meetings = 0;
        Long worst = 0;
        for (int i = 0; i < kCases; ++i) {
            const double from = i % 3 == 0 ? 0 : number(0, 0.02), reach = number(0.2, 1.2);
            const Window window{from, from + number(0.01, 0.3), 0};
            const Vec2 d{number(-1.5, 1.5), number(-1.5, 1.5)}, v{number(-9, 9), number(-9, 9)};
            const auto gap = [&](Long s) {
                const Long after = s - from;
                return std::hypot(d.x + after * v.x, d.y + after * v.y) - reach;
            };
            const double answer = straight_impact_time(d, v, reach, window);
            if (const auto error = error_of(answer, gap, window, meetings)) worst = std::fmax(worst, *error);
        }
        CHECK(meetings > kCases / 5);
        CHECK(worst < 1e-12L);
    }

    TEST_CASE("a pair whose accelerations differ meets when bisection says, with and without drag") {
        Numbers number;
        for (const double drag : {0.0, 0.3, 4.0}) {
            CAPTURE(drag);
            int meetings = 0;
            Long worst = 0;
            for (int i = 0; i < kCases; ++i) {
                const double from = i % 3 == 0 ? 0 : number(0, 0.02), reach = number(0.2, 1.2);
                const Window window{from, from + number(0.005, 0.07), drag};
                const Flight f{{number(-1.5, 1.5), number(-1.5, 1.5)},
                               {number(-15, 15), number(-15, 15)},
                               {number(-30, 30), number(-30, 30)}};
                const auto gap = [&](Long s) {
                    const Long q = fall(s, drag);
                    return std::hypot(f.position.x + s * f.velocity.x + q * f.acceleration.x,
                                      f.position.y + s * f.velocity.y + q * f.acceleration.y) -
                           reach;
                };
                const double tolerance = 1e-13;  // m
                const double answer = accelerated_impact_time(f, reach, window, tolerance);
                if (const auto error = error_of(answer, gap, window, meetings))
                    worst = std::fmax(worst, *error);
            }
            CHECK(meetings > kCases / 10);
            CHECK(worst < 2e-11L);  // the tolerance over the slowest approach, and round-off
        }
    }

    TEST_CASE(
        "a body meets a wall when bisection says, pulled to it or away from it, with and without drag") {
        Numbers number;
        for (const double drag : {0.0, 0.3, 4.0}) {
            CAPTURE(drag);
            int meetings = 0;
            Long worst = 0;
            for (int i = 0; i < kCases; ++i) {
                const double from = i % 3 == 0 ? 0 : number(0, 0.02);
                const Window window{from, from + number(0.005, 0.09), drag};
                const double c = number(-0.02, 0.3), v = number(-8, 4), a = number(-60, 60);
                const auto gap = [&](Long s) { return c + v * s + a * fall(s, drag); };
                const double answer = wall_impact_time(c, v, a, window);
                if (a < 0 && gap(from) < 0 && most(gap, window) < 0) {  // never gets out
                    CHECK(answer == from);
                    continue;
                }
                if (const auto error = error_of(answer, gap, window, meetings))
                    worst = std::fmax(worst, *error);
            }
            CHECK(meetings > kCases / 10);
            CHECK(worst < 1e-12L);
        }
    }

    TEST_CASE("touching bodies that part do not meet, however little they part") {
        const Window window{0, 1, 0};
        CHECK(straight_impact_time({1, 0}, {1e-12, 0}, 1, window) == kNever);
        CHECK(straight_impact_time({1, 0}, {-1e-12, 0}, 1, window) == 0);
        CHECK(wall_impact_time(0, 1e-12, 0, window) == kNever);
        CHECK(wall_impact_time(0, -1e-12, 0, window) == 0);
    }

    TEST_CASE("a ball thrown up from the floor comes back after 2 v / g") {
        const Window window{0, 1, 0};
        CHECK(wall_impact_time(0, 4, -10, window) == doctest::Approx(0.8).epsilon(1e-14));
        const Flight thrown{{0, 1}, {0, 4}, {0, -10}};
        CHECK(accelerated_impact_time(thrown, 1, window, 1e-13) == doctest::Approx(0.8).epsilon(1e-12));
    }
}

}  // namespace test_impact_time
