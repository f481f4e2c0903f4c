#include "solvers/contact_sets/support_normals.hpp"

#include <algorithm>

#include "math/vec2_math.hpp"

namespace carom {
bool solve_support_normals(Vec2& velocity, double inverse_mass, std::span<SupportNormal> supports,
                           double tolerance) {
    Vec2 free = velocity;
    for (const SupportNormal& s : supports) free += inverse_mass * s.impulse * s.normal;
    const auto excess = [](const SupportNormal& s, Vec2 v) { return dot(v, s.normal) - s.most; };
    // Takes these two impulses alone if they keep the body off all supports.
    const auto take = [&](SupportNormal* one, double by_one, SupportNormal* other, double by_other) {
        Vec2 pushed = free;
        if (one) pushed -= inverse_mass * by_one * one->normal;
        if (other) pushed -= inverse_mass * by_other * other->normal;
        const bool keeps_off = std::all_of(supports.begin(), supports.end(), [&](const SupportNormal& s) {
            return &s == one || &s == other || excess(s, pushed) <= tolerance;
        });
        if (!keeps_off) return false;
        for (SupportNormal& s : supports) s.impulse = 0;
        if (one) one->impulse = by_one;
        if (other) other->impulse = by_other;
        velocity = pushed;
        return true;
    };
    if (take(nullptr, 0, nullptr, 0)) return true;
    for (SupportNormal& s : supports) {
        const double of_s = excess(s, free);
        const double by_s = of_s / (inverse_mass * length_squared(s.normal));
        if (by_s > 0 && take(&s, by_s, nullptr, 0)) return true;
    }
    for (std::size_t i = 0; i < supports.size(); ++i)
        for (std::size_t k = i + 1; k < supports.size(); ++k) {
            SupportNormal &one = supports[i], &other = supports[k];
            // Normals in single precision have a length of 1 but for 1e-7, which a narrow wedge makes much
            // of.
            const double of_both = dot(one.normal, other.normal), of_ones = length_squared(one.normal),
                         of_others = length_squared(other.normal),
                         determinant = of_ones * of_others - of_both * of_both;
            if (!(determinant >= kLeastOfWedge)) continue;
            const double of_one = excess(one, free), of_other = excess(other, free);
            const double by_one = (of_others * of_one - of_both * of_other) / (inverse_mass * determinant),
                         by_other = (of_ones * of_other - of_both * of_one) / (inverse_mass * determinant);
            if (by_one > 0 && by_other > 0 && take(&one, by_one, &other, by_other)) return true;
        }
    return false;
}

}  // namespace carom
