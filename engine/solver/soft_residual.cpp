#include <algorithm>
#include <cmath>

#include "solver/soft.hpp"

namespace carom {

/// What one more sweep would change in the relative normal velocity of each contact, on its own: the
/// contact law of kernels/solve_contacts.hpp with the velocities at the end of the step. Contacts that
/// bounced have left the law on purpose.
template <class Real>
SolveQuality SoftSolver<Real>::quality() const {
    SolveQuality quality;
    double sum = 0;
    std::int64_t pushing = 0;
    const auto velocity = [this](std::int32_t row, double nx, double ny) {
        const Real* record = velocity_.data() + 4 * static_cast<std::size_t>(row);
        return static_cast<double>(record[0]) * nx + static_cast<double>(record[1]) * ny;
    };
    const auto look_at = [&](const LiveContacts<Real>& live, bool is_support) {
        live.for_each([&](std::size_t i) {
            const double impulse = static_cast<double>(live.normal_impulse[i]);
            if (impulse > 0) ++quality.touching;
            if (!live.bounce_impulse.empty() && live.bounce_impulse[i] > 0) return;
            const double nx = static_cast<double>(live.normal_x[i]),
                         ny = static_cast<double>(live.normal_y[i]);
            const double of_b =
                is_support ? static_cast<double>(live.surface_normal[i]) : velocity(live.b[i], nx, ny);
            const double relative = of_b - velocity(live.a[i], nx, ny);
            const double mass = static_cast<double>(live.mass[i]);
            // At most what would take the whole impulse back.
            const double change = std::fmax(static_cast<double>(live.floor[i]) - relative, -impulse / mass);
            if (impulse == 0 && change <= 0) return;
            ++pushing;
            sum += change * change;
            quality.residual_max = std::fmax(quality.residual_max, std::fabs(change));
        });
    };
    look_at(pairs_, false), look_at(supports_, true);
    if (pushing > 0) quality.residual = std::sqrt(sum / static_cast<double>(pushing));
    return quality;
}

template SolveQuality SoftSolver<float>::quality() const;
template SolveQuality SoftSolver<double>::quality() const;

}  // namespace carom
