#include "scene/generators/place_discs.hpp"

#include <algorithm>
#include <functional>
#include <span>
#include <utility>

namespace carom {
namespace {

/// Discs [begin, end) of the radii in falling order; the first is the largest.
struct Row {
    std::size_t begin = 0;
    std::size_t end = 0;
};

template <class T>
void shuffle(std::span<T> items, Random& random) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[random.below(i)]);
}

/// Fills rows one after the other, each as full as it gets.
std::vector<Row> fill_rows(const std::vector<double>& radius, double width) {
    std::vector<Row> rows;
    double used = 0;
    for (std::size_t i = 0; i < radius.size(); ++i) {
        if (rows.empty() || used + 2 * radius[i] > width) {
            rows.push_back({i, i});
            used = 0;
        }
        used += 2 * radius[i];
        rows.back().end = i + 1;
    }
    return rows;
}

double clamped(double low, double high, Random& random) {
    return high > low ? std::min(random.uniform(low, high), high) : (low + high) / 2;
}

/// Puts the discs of a row beside each other between `bottom` and `top`, with the free width shared out
/// equally.
void place_row(const Region& box, double bottom, double top, std::span<const double> radius, Random& random,
               std::vector<Vec2>& centres) {
    double used = 0;
    for (const double r : radius) used += 2 * r;
    const double gap = std::max(0.0, box.width() - used) / static_cast<double>(radius.size());
    double left = box.min.x;
    for (const double r : radius) {
        const double right = left + (2 * r + gap);
        const double x = clamped(left + r, std::min(right, box.max.x) - r, random);
        centres.push_back({x, clamped(bottom + r, top - r, random)});
        left = right;
    }
}

}  // namespace

std::vector<Vec2> place_in_rows(const Region& box, std::vector<double>& radius, Random& random) {
    std::sort(radius.begin(), radius.end(), std::greater<>());
    if (2 * radius.front() > box.width()) return {};
    std::vector<Row> rows = fill_rows(radius, box.width());
    double height = 0;
    for (const Row& row : rows) height += 2 * radius[row.begin];
    if (height > box.height()) return {};

    const double gap = (box.height() - height) / static_cast<double>(rows.size());
    shuffle(std::span(rows), random);
    std::vector<Vec2> centres;
    std::vector<double> placed;
    centres.reserve(radius.size());
    placed.reserve(radius.size());
    double bottom = box.min.y;
    for (const Row& row : rows) {
        const double top = bottom + (2 * radius[row.begin] + gap);
        const std::span discs = std::span(radius).subspan(row.begin, row.end - row.begin);
        shuffle(discs, random);  // its height was read before
        place_row(box, bottom, std::min(top, box.max.y), discs, random, centres);
        placed.insert(placed.end(), discs.begin(), discs.end());
        bottom = top;
    }
    radius = std::move(placed);
    return centres;
}

}  // namespace carom
