#pragma once

namespace carom {

/// e^x from + - * / alone, so that every machine gets the same bits. Within 1e-15 of it in relative terms for
/// |x| <= 1; 1e-13 for |x| <= 100; beyond 700 zero or the value at 700.
///
/// Taylor's series of x / 2^k, |x| / 2^k <= 1/4, squared k times; (1/4)^14 / 14! is below 2^-63.
inline double exponential(double x) {
    if (x < -700) return 0;
    if (x > 700) x = 700;
    int halvings = 0;
    while (x > 0.25 || x < -0.25) x *= 0.5, ++halvings;
    double sum = 1;
    for (int n = 14; n >= 1; --n) sum = 1 + x / n * sum;
    for (; halvings > 0; --halvings) sum *= sum;
    return sum;
}

}  // namespace carom
