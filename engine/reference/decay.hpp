#pragma once

namespace carom {

/// exp(-exponent) for exponent >= 0, from sums and products alone, so that every machine and libm gives the
/// same bits. Within 1e-15 of the true value, relative; 0 where that would be denormal.
double decay(double exponent);

}  // namespace carom
