#pragma once

#include <algorithm>

#include "state/bodies.hpp"

namespace carom {

/// Separation up to which bodies at rest are in contact [m].
struct ContactDistance {
    double share, fall;  // of the thickness of the thinner body; m, what gravity adds in a step
    double operator()(double thickness) const { return share * thickness + fall; }
};

/// What contacts of two bodies are measured in: the inradius of the thinner one [m]. What nothing moves may
/// be huge: how thick it is says nothing of the contact.
/// @param a  a body that moves
template <class Real>
Real pair_thickness(const Bodies<Real>& bodies, std::size_t a, std::size_t b) {
    const bool b_moves = b < bodies.count && !bodies.is_immovable(b);
    return b_moves ? std::min(bodies.inradius(a), bodies.inradius(b)) : bodies.inradius(a);
}

}  // namespace carom
