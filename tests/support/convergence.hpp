#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace carom::test {

/// Order of convergence: slope of the straight line through log(error) over log(step), least squares.
inline double observed_order(const std::vector<double>& steps, const std::vector<double>& errors) {
    const double count = static_cast<double>(steps.size());
    double x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const double log_step = std::log(steps[i]), log_error = std::log(errors[i]);
        x += log_step, y += log_error, xx += log_step * log_step, xy += log_step * log_error;
    }
    return (count * xy - x * y) / (count * xx - x * x);
}

}  // namespace carom::test
