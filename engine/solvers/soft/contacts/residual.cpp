#include "solvers/soft/contacts/residual.hpp"

#include <algorithm>
#include <cmath>

#include "effects/contact_law.hpp"

namespace carom {

template <class Real>
SolveQuality quality_of(const ContactRows<Real>& pairs, const ContactRows<Real>& supports,
                        const BodyRecords<Real>& records) {
    SolveQuality quality;
    double sum = 0;
    std::int64_t pushing = 0;
    const auto look_at = [&](const ContactRows<Real>& contacts, std::size_t i, const auto& other) {
        const double impulse = contacts.normal_impulse[i], mass = contacts.mass[i], nx = contacts.normal_x[i],
                     ny = contacts.normal_y[i], floor = contacts.floor[i];
        if (impulse > 0) ++quality.touching;
        const double velocity = normal_velocity(body_at(records.velocity, contacts.a[i]), other, nx, ny);
        const auto sweep = push_only(impulse, impulse + mass * (floor - velocity));
        if (impulse == 0 && sweep.impulse == 0) return;
        const double change = std::fabs(sweep.added) / mass;
        ++pushing;
        sum += change * change;
        quality.residual_max = std::fmax(quality.residual_max, change);
    };
    const auto is_row = [count = records.count()](std::int32_t row) {
        return static_cast<std::size_t>(row) < count;
    };
    pairs.for_each([&](std::size_t i) {
        const std::size_t block = i / kContactBlock;
        if (block >= pairs.is_live.size() || !pairs.is_live[block]) return;
        if (is_row(pairs.a[i]) && is_row(pairs.b[i]))
            look_at(pairs, i, body_at(records.velocity, pairs.b[i]));
    });
    supports.for_each([&](std::size_t i) {
        if (is_row(supports.a[i]))
            look_at(supports, i, DoubleSurface{static_cast<double>(supports.surface_normal[i]), 0, 0});
    });
    if (pushing > 0) quality.residual = std::sqrt(sum / static_cast<double>(pushing));
    return quality;
}

template SolveQuality quality_of(const ContactRows<float>&, const ContactRows<float>&,
                                 const BodyRecords<float>&);
template SolveQuality quality_of(const ContactRows<double>&, const ContactRows<double>&,
                                 const BodyRecords<double>&);

}  // namespace carom
