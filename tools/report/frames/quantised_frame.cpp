#include "report/frames/quantised_frame.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace carom::report {
namespace {

constexpr double kSteps = kNowhere - 1;  // between the outermost positions
constexpr double kFarthest = 16;         // of the middle's extent: beyond, single bodies are not shown
constexpr double kMiddleBegin = 0.02,
                 kMiddleEnd = 0.98;  // the part of all bodies that is the middle; of few it is all
constexpr double kLargestSigned = 32767;
constexpr double kTurn = 2 * std::numbers::pi;  // rad

}  // namespace

Scale drawn_range(std::span<const float> position, std::size_t component) {
    std::vector<float> values;
    for (std::size_t i = component; i < position.size(); i += 2)
        if (std::isfinite(position[i])) values.push_back(position[i]);
    if (values.empty()) return {};
    const auto last = static_cast<double>(values.size() - 1);
    const auto at = [&values](double rank) {
        const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
        std::nth_element(values.begin(), place, values.end());
        return static_cast<double>(*place);
    };
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    double low = *least, high = *most;
    const double begin = at(std::floor(kMiddleBegin * last)), end = at(std::ceil(kMiddleEnd * last)),
                 middle = end - begin;
    if (middle > 0 && high - low > kFarthest * middle) {
        low = std::max(low, begin - kFarthest / 2 * middle);
        high = std::min(high, end + kFarthest / 2 * middle);
    }
    return {.base = low, .step = (high - low) / kSteps};
}

namespace {

std::uint16_t place(double value, const Scale& scale) {
    const double bits = scale.step > 0 ? std::round((value - scale.base) / scale.step) : 0;
    if (!(std::isfinite(value) && bits >= 0 && bits <= kSteps)) return kNowhere;
    return static_cast<std::uint16_t>(bits);
}

void add_positions(std::span<const float> position, QuantisedFrame& frame) {
    const std::size_t bodies = position.size() / 2;
    frame.x = drawn_range(position, 0);
    frame.y = drawn_range(position, 1);
    frame.bits.resize(2 * bodies);
    for (std::size_t i = 0; i < bodies; ++i) {
        std::uint16_t x = place(position[2 * i], frame.x), y = place(position[2 * i + 1], frame.y);
        if (x == kNowhere || y == kNowhere) {
            x = y = kNowhere;
            ++frame.lost;
        }
        frame.bits[i] = x;
        frame.bits[bodies + i] = y;
    }
}

void add_velocities(std::span<const float> velocity, QuantisedFrame& frame) {
    double largest = 0, squares = 0;
    for (const float v : velocity) {
        if (!std::isfinite(v)) continue;
        largest = std::max(largest, std::abs(static_cast<double>(v)));
        squares += static_cast<double>(v) * v;
    }
    frame.speed_step = largest / kLargestSigned;
    frame.speed_rms = std::sqrt(squares / std::max<double>(1, static_cast<double>(velocity.size()) / 2));
    for (std::size_t component = 0; component < 2; ++component)
        for (std::size_t i = component; i < velocity.size(); i += 2) {
            const bool drawn = largest > 0 && std::isfinite(velocity[i]);
            const double bits = drawn ? std::round(velocity[i] / frame.speed_step) : 0;
            frame.bits.push_back(std::bit_cast<std::uint16_t>(static_cast<std::int16_t>(bits)));
        }
}

/// A turn is 65,536 steps.
void add_angles(std::span<const float> angle, QuantisedFrame& frame) {
    for (const float a : angle) {
        const double turns = std::isfinite(a) ? a / kTurn : 0;
        frame.bits.push_back(static_cast<std::uint16_t>(std::floor((turns - std::floor(turns)) * 65535.999)));
    }
}

}  // namespace

QuantisedFrame quantise(std::span<const float> position, std::span<const float> velocity,
                        std::span<const float> angle) {
    QuantisedFrame frame;
    frame.bits.reserve(position.size() + velocity.size() + angle.size());
    add_positions(position, frame);
    if (!velocity.empty()) add_velocities(velocity, frame);
    add_angles(angle, frame);
    return frame;
}

}  // namespace carom::report
