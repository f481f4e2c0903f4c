#include "scene/generators/place_discs.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

constexpr double kSqrtHalf = 0.70710678118654752;

double count_of(std::size_t n) {
    return static_cast<double>(n);
}

/// The most rows of discs that fit, discs of one row all below those of the next or between them.
std::size_t most_rows(double height, double diameter, double row_height, std::size_t count) {
    const double rows = 1 + (height - diameter) / row_height;
    return rows >= count_of(count) ? count : static_cast<std::size_t>(std::max(rows, 0.0));
}

SiteLattice square_lattice(const Region& box, std::size_t rows, std::size_t count, double diameter) {
    SiteLattice lattice;
    lattice.rows = rows;
    lattice.columns = lattice.odd_columns = (count + rows - 1) / rows;
    lattice.spacing_x = box.width() / count_of(lattice.columns);
    lattice.spacing_y = box.height() / count_of(rows);
    lattice.first_x = lattice.spacing_x / 2;
    lattice.first_y = lattice.spacing_y / 2;
    lattice.clearance = std::min(lattice.spacing_x, lattice.spacing_y) - diameter;
    return lattice;
}

/// Rows at half a spacing from each other; odd ones have as many sites as even ones, or one less.
SiteLattice hexagonal_lattice(const Region& box, std::size_t rows, std::size_t count, double diameter,
                              bool one_less) {
    SiteLattice lattice;
    lattice.hexagonal = true;
    lattice.rows = rows;
    lattice.columns = one_less ? (count + rows / 2 + rows - 1) / rows : (count + rows - 1) / rows;
    lattice.odd_columns = lattice.columns - (one_less ? 1 : 0);
    const double spans = count_of(lattice.columns) - (one_less ? 1.0 : 0.5);
    if (!(spans > 0)) return lattice;
    lattice.spacing_x = (box.width() - diameter) / spans;
    lattice.spacing_y = (box.height() - diameter) / count_of(rows - 1);
    lattice.first_x = lattice.first_y = diameter / 2;
    const double half = lattice.spacing_x / 2;
    const double slanted = std::sqrt(half * half + lattice.spacing_y * lattice.spacing_y);
    const double nearest = std::min({lattice.spacing_x, slanted, 2 * lattice.spacing_y});
    lattice.clearance =
        std::min(nearest - diameter, lattice.spacing_x);  // spacing < 0: the box is too narrow
    return lattice;
}

/// How far a disc may move from its site, in x and in y, so that none overlaps another.
Vec2 room(const Region& box, const SiteLattice& lattice, double radius) {
    constexpr double kRoundings = 16 * 0x1p-52;  // of coordinates, so that rounding cannot make discs overlap
    const double largest =
        std::max({std::abs(box.min.x), std::abs(box.min.y), std::abs(box.max.x), std::abs(box.max.y)});
    const double lost = kRoundings * largest;
    if (lattice.hexagonal) {  // half the clearance in any direction: a square inside that circle
        const double side = std::max(0.0, lattice.clearance - lost) / 2 * kSqrtHalf;
        return {side, side};
    }
    return {std::max(0.0, lattice.spacing_x - 2 * radius - lost) / 2,
            std::max(0.0, lattice.spacing_y - 2 * radius - lost) / 2};
}

/// Moves a coordinate by a random part of the room, away from a side it would leave the box at.
double moved(double site, double side_room, double low, double high, Random& random) {
    const double step = random.uniform(-side_room, side_room);
    const double there = site + step;
    if (there < low || there > high) return std::clamp(site - step, low, high);
    return there;
}

}  // namespace

SiteLattice roomiest_lattice(const Region& box, std::size_t count, double radius) {
    const double diameter = 2 * radius;
    SiteLattice best;
    const auto take = [&best](const SiteLattice& lattice) {
        if (lattice.clearance > best.clearance || best.rows == 0) best = lattice;
    };
    const std::size_t square_rows = most_rows(box.height(), diameter, diameter, count);
    for (std::size_t rows = 1; rows <= square_rows; ++rows) take(square_lattice(box, rows, count, diameter));
    const std::size_t hexagonal_rows = most_rows(box.height(), diameter, diameter / 2, count);
    for (std::size_t rows = 2; rows <= hexagonal_rows; ++rows)
        for (const bool one_less : {false, true})
            take(hexagonal_lattice(box, rows, count, diameter, one_less));
    return best;
}

std::vector<Vec2> place_on_lattice(const Region& box, const SiteLattice& lattice, std::size_t count,
                                   double radius, Random& random) {
    const Vec2 free = room(box, lattice, radius);
    const Vec2 low{box.min.x + radius, box.min.y + radius}, high{box.max.x - radius, box.max.y - radius};
    std::vector<Vec2> centres;
    centres.reserve(count);
    std::size_t sites_left = lattice.sites();
    for (std::size_t row = 0; row < lattice.rows; ++row) {
        const bool odd = row % 2 == 1;
        const double first = lattice.first_x + (odd && lattice.hexagonal ? lattice.spacing_x / 2 : 0.0);
        const double y = box.min.y + (lattice.first_y + count_of(row) * lattice.spacing_y);
        const std::size_t columns = odd ? lattice.odd_columns : lattice.columns;
        for (std::size_t column = 0; column < columns; ++column, --sites_left) {
            // Each site is taken with the probability that leaves the rest a fair choice.
            const std::size_t discs_left = count - centres.size();
            if (sites_left > discs_left && random.below(sites_left) >= discs_left) continue;
            const double x = box.min.x + (first + count_of(column) * lattice.spacing_x);
            const double centre_x = moved(x, free.x, low.x, high.x, random);
            centres.push_back({centre_x, moved(y, free.y, low.y, high.y, random)});
        }
    }
    return centres;
}

}  // namespace carom
