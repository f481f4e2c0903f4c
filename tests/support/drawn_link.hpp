#pragma once

#include <cmath>
#include <cstddef>

#include "kernels/paths/path_arguments.hpp"

namespace carom::test {

/// Fills a lane of a link with a contact of two points: levers, gaps of up to 2 mm and impulses that are
/// drawn.
/// @param angle  rad, of the normal  @param draw  draw(least, most), a Real
template <class Real, class Draw>
void draw_contact(PathLink<Real>& link, std::size_t lane, double angle, Real friction, const Draw& draw) {
    link.normal_x[lane] = static_cast<Real>(std::cos(angle));
    link.normal_y[lane] = static_cast<Real>(std::sin(angle));
    link.near1[lane] = draw(-1, -0.2), link.near2[lane] = draw(0.2, 1), link.near_t[lane] = draw(0.5, 1);
    link.far1[lane] = draw(-1, -0.2), link.far2[lane] = draw(0.2, 1), link.far_t[lane] = draw(-1, -0.5);
    link.separation1[lane] = draw(0, 0.002), link.separation2[lane] = draw(0, 0.002);
    link.friction[lane] = friction, link.thickness[lane] = 1;
    link.normal1[lane] = draw(0, 0.2), link.normal2[lane] = draw(0, 0.2);
}

}  // namespace carom::test
