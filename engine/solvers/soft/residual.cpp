#include <algorithm>
#include <cmath>

#include "constraints/contact_law.hpp"
#include "solvers/soft/soft_solver.hpp"

namespace carom {

/// What one more sweep would change in the relative normal velocity of each contact, on its own, with the
/// velocities at the end of the step. Contacts that bounced have left the law on purpose.
template <class Real>
SolveQuality SoftSolver<Real>::quality() const {
    SolveQuality quality;
    double sum = 0;
    std::int64_t pushing = 0;
    const auto look_at = [&](const ContactRows<Real>& contacts, std::size_t i, const auto& other) {
        const double impulse = contacts.normal_impulse[i], mass = contacts.mass[i], nx = contacts.normal_x[i],
                     ny = contacts.normal_y[i], floor = contacts.floor[i];
        if (impulse > 0) ++quality.touching;
        if (!contacts.bounce_impulse.empty() && contacts.bounce_impulse[i] > 0) return;
        const double velocity = normal_velocity(body_at(velocity_, contacts.a[i]), other, nx, ny);
        const auto sweep = push_only(impulse, impulse + mass * (floor - velocity));
        if (impulse == 0 && sweep.impulse == 0) return;
        const double change = std::fabs(sweep.added) / mass;
        ++pushing;
        sum += change * change;
        quality.residual_max = std::fmax(quality.residual_max, change);
    };
    const auto is_row = [this](std::int32_t row) { return static_cast<std::size_t>(row) < count_; };
    const ContactRows<Real>& pairs = graph.pairs;
    pairs.for_each([&](std::size_t i) {
        const std::size_t block = i / kContactBlock;
        if (block >= pairs.is_live.size() || !pairs.is_live[block]) return;
        if (is_row(pairs.a[i]) && is_row(pairs.b[i])) look_at(pairs, i, body_at(velocity_, pairs.b[i]));
    });
    supports_.for_each([&](std::size_t i) {
        if (is_row(supports_.a[i]))
            look_at(supports_, i, DoubleSurface{static_cast<double>(supports_.surface_normal[i]), 0, 0});
    });
    if (pushing > 0) quality.residual = std::sqrt(sum / static_cast<double>(pushing));
    return quality;
}

template SolveQuality SoftSolver<float>::quality() const;
template SolveQuality SoftSolver<double>::quality() const;

}  // namespace carom
