#pragma once

#include "math/random.hpp"

#include <carom/vec2.hpp>

#include <cstddef>
#include <vector>

namespace carom {

/// An axis-aligned box to fill.
struct Region {
    Vec2 min;
    Vec2 max;
    double width() const { return max.x - min.x; }
    double height() const { return max.y - min.y; }
};

/// A lattice with at least as many sites as there are discs, and room for a disc to move about its site.
struct SiteLattice {
    bool hexagonal = false;
    std::size_t rows = 0;
    std::size_t columns = 0;      // in even rows
    std::size_t odd_columns = 0;  // in odd rows: as many, or one less
    double spacing_x = 0;         // m
    double spacing_y = 0;         // m
    double first_x = 0;           // m, centre of the first site from the left side; odd rows of a hexagonal
    double first_y = 0;           //    lattice start half a spacing further
    double clearance = -1;        // m between discs that sit on neighbouring sites; negative: they overlap
    std::size_t sites() const { return (rows + 1) / 2 * columns + rows / 2 * odd_columns; }
};

/// The square or hexagonal lattice with the most room for `count` discs of that radius; clearance < 0 if none
/// fits. Cost: O(rows).
SiteLattice roomiest_lattice(const Region& box, std::size_t count, double radius);

/// Centres of `count` discs on that lattice, row by row from the bottom, each moved at random within its
/// room; sites left over are free at random.
std::vector<Vec2> place_on_lattice(const Region& box, const SiteLattice& lattice, std::size_t count,
                                   double radius, Random& random);

/// Centres of discs of mixed radii: discs of like radius side by side in rows, the rows in random order.
/// Fills up to about 0.75 of the box. Reorders `radius` to the order of the centres. Empty if the discs do
/// not fit. Cost: O(n log n).
std::vector<Vec2> place_in_rows(const Region& box, std::vector<double>& radius, Random& random);

}  // namespace carom
