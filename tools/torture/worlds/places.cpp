#include "torture/worlds/places.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace carom::torture {
namespace {

Enclosure enclosure_of_area(double area, double aspect, double angle, const WorldTraits& traits) {
    const bool is_box = traits.fence == Fence::walls || traits.surroundings == Surroundings::floor ||
                        traits.surroundings == Surroundings::open;
    if (!is_box) return polygon_of(traits.fence, traits.sides, area, angle);
    const double width = std::sqrt(area / aspect);
    return box_of(Fence::walls, width, width * aspect);
}

bool is_apart(Vec2 point, double radius, std::span<const Vec2> at, std::span<const double> radii) {
    for (std::size_t i = 0; i < at.size(); ++i)
        if (std::hypot(point.x - at[i].x, point.y - at[i].y) < 1.001 * (radius + radii[i])) return false;
    return true;
}

std::optional<Vec2> place_in(const Enclosure& enclosure, double radius, std::span<const Vec2> at,
                             std::span<const double> radii, bool is_crowded, Random& random) {
    constexpr int kTries = 100;
    const Vec2 low = enclosure.low(), high = enclosure.high();
    for (int i = 0; i < kTries; ++i) {
        const Vec2 point{random.uniform(low.x, high.x), random.uniform(low.y, high.y)};
        if (enclosure.clearance(point) < 1.01 * radius) continue;
        if (is_crowded || is_apart(point, radius, at, radii)) return point;
    }
    return std::nullopt;
}

/// Places of circles in the order of `radii`; fewer than these if there is no room.
std::vector<Vec2> places_in(const Enclosure& enclosure, std::span<const double> radii, bool is_crowded,
                            Random& random) {
    std::vector<Vec2> at;
    for (const double radius : radii) {
        const auto point = place_in(enclosure, radius, at, radii, is_crowded, random);
        if (!point) break;
        at.push_back(*point);
    }
    return at;
}

}  // namespace

Places places_for(std::span<const double> radii, const WorldTraits& traits, Random& random) {
    constexpr double kGrowth = 1.2;
    std::vector<std::size_t> order(radii.size());  // the largest first: the others fit around it
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return radii[a] > radii[b]; });
    std::vector<double> sorted;
    double area = 0;
    for (const std::size_t i : order) {
        sorted.push_back(radii[i]);
        area += std::numbers::pi * radii[i] * radii[i] / traits.fill;
    }
    const double aspect = random.log_uniform(0.4, 2.5), angle = random.uniform(0, 2 * std::numbers::pi);
    for (;; area *= kGrowth) {
        Places places{enclosure_of_area(area, aspect, angle, traits), std::vector<Vec2>(radii.size())};
        const std::vector<Vec2> at = places_in(places.enclosure, sorted, traits.is_crowded, random);
        if (at.size() < sorted.size()) continue;
        for (std::size_t i = 0; i < order.size(); ++i) places.at[order[i]] = at[i];
        return places;
    }
}

}  // namespace carom::torture
