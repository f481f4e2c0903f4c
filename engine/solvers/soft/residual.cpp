#include <algorithm>
#include <cmath>

#include "solvers/soft/soft_solver.hpp"

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
    const auto look_at = [&](std::size_t i, double impulse, double relative, const ContactRows<Real>& live) {
        if (impulse > 0) ++quality.touching;
        if (!live.bounce_impulse.empty() && live.bounce_impulse[i] > 0) return;
        const double mass = static_cast<double>(live.mass[i]);
        // At most what would take the whole impulse back.
        const double change = std::fmax(static_cast<double>(live.floor[i]) - relative, -impulse / mass);
        if (impulse == 0 && change <= 0) return;
        ++pushing;
        sum += change * change;
        quality.residual_max = std::fmax(quality.residual_max, std::fabs(change));
    };
    const auto is_row = [this](std::int32_t row) { return static_cast<std::size_t>(row) < count_; };
    graph.pairs.for_each([&](std::size_t i) {
        const std::size_t block = i / kContactBlock;
        const std::int32_t a = graph.pairs.a[i], b = graph.pairs.b[i];
        if (block >= graph.pairs.is_live.size() || !graph.pairs.is_live[block] || !is_row(a) || !is_row(b))
            return;
        const double nx = static_cast<double>(graph.pairs.normal_x[i]),
                     ny = static_cast<double>(graph.pairs.normal_y[i]);
        look_at(i, static_cast<double>(graph.pairs.normal_impulse[i]),
                velocity(b, nx, ny) - velocity(a, nx, ny), graph.pairs);
    });
    supports_.for_each([&](std::size_t i) {
        if (!is_row(supports_.a[i])) return;
        const double nx = static_cast<double>(supports_.normal_x[i]),
                     ny = static_cast<double>(supports_.normal_y[i]);
        look_at(i, static_cast<double>(supports_.normal_impulse[i]),
                static_cast<double>(supports_.surface_normal[i]) - velocity(supports_.a[i], nx, ny),
                supports_);
    });
    if (pushing > 0) quality.residual = std::sqrt(sum / static_cast<double>(pushing));
    return quality;
}

template SolveQuality SoftSolver<float>::quality() const;
template SolveQuality SoftSolver<double>::quality() const;

}  // namespace carom
