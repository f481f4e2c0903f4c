#pragma once

namespace carom {

/// Normal impulse of an impact [N s]: reverses the approach speed vn < 0 to restitution times it.
/// j = -(1 + e) vn m_eff, m_eff = 1 / (1/ma + 1/mb).
constexpr double impact_impulse(double normal_velocity, double restitution, double inverse_mass_sum) {
    return -(1 + restitution) * normal_velocity / inverse_mass_sum;
}

/// Work an impulse j along the normal does when the relative normal velocity goes from `before` to `after`
/// [J]: j (before + after) / 2. For one impact that is -m_eff (1 - e²) vn² / 2.
constexpr double impact_work(double impulse, double before, double after) {
    return 0.5 * impulse * (before + after);
}

/// A pair's coefficient: the larger of the two materials'.
constexpr double pair_restitution(double a, double b) {
    return a > b ? a : b;
}

}  // namespace carom
