#pragma once

namespace carom {

/// Separation up to which bodies at rest are in contact [m].
struct ContactDistance {
    double share, fall;  // of the thickness of the thinner body; m, what gravity adds in a step
    double operator()(double thickness) const { return share * thickness + fall; }
};

}  // namespace carom
