#pragma once

#include <limits>

#include "kernels/contacts/contact_arguments.hpp"
#include "simd/consecutive_rows.hpp"
#include "simd/lanes.hpp"
#include "simd/ordered_lanes.hpp"

namespace carom {
namespace {

/// What free flight does to a velocity in a substep; nothing if nothing moves the body.
template <class F>
struct FreeFlight {
    F gain_x, gain_y, decay, spin_decay;

    F x(F vx, F inverse_mass) const { return simd::select(moves(inverse_mass), decay * vx + gain_x, vx); }
    F y(F vy, F inverse_mass) const { return simd::select(moves(inverse_mass), decay * vy + gain_y, vy); }
    F spin(F u, F inverse_mass) const { return simd::select(moves(inverse_mass), spin_decay * u, u); }

  private:
    static auto moves(F inverse_mass) { return simd::abs(inverse_mass) > F(0); }
};

/// What contacts leave of the velocity of a body that comes to rest is round-off of what they took, and of
/// that again in the next substep: before long it would be too small for a normal number, and products of
/// such numbers take a processor a hundred cycles each. What is slower than `nothing` is at rest.
template <class F>
F without_round_off(F v, F nothing) {
    return simd::select(simd::abs(v) < nothing, F(0), v);
}

/// Moves bodies through a substep, whose velocities are solved, and foresees the next one's: whatever the
/// contacts did to a velocity in this substep they will do again, because their impulses are nearly the same.
/// That is the warm start of the next substep, without looking at a contact.
///
/// The displacement is that of the velocity at the end, h v1 (symplectic Euler), which is what contacts need;
/// where the velocity changed by no more than free flight would change it - bodies in flight, sliding,
/// rolling, at rest - it is h (v0 + v1) / 2, which is exact under constant acceleration. The turn likewise,
/// where the rim speed changes by no more than that and angular drag together: in flight, and where a disc
/// rolls. Bodies that have joints go by h v1 always: their rows ask where that takes them.
/// @tparam kRests  whether some have joints, or what is slower than k.nothing is at rest
template <bool kTurns, bool kRests, class Real, class Isa>
void advance_bodies(const AdvanceBodies<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::LanesOfRuns<simd::Lanes<Real, Isa>>;
    using F = typename Lanes::Batch;
    const FreeFlight<F> free{F(k.gain_x), F(k.gain_y), F(k.decay), F(k.spin_decay)};
    const F h(k.h), half(Real(0.5)), nothing(k.nothing);
    for (std::size_t row = first; row < last; row += Lanes::size) {
        auto v = Lanes::load_rows4(k.velocity + 4 * row, kConsecutive);
        const F start_x = Lanes::load(k.start.x + row), start_y = Lanes::load(k.start.y + row);
        if constexpr (kRests) {
            v[0] = without_round_off(v[0], nothing), v[1] = without_round_off(v[1], nothing);
            if constexpr (kTurns) v[2] = without_round_off(v[2], nothing);
            if (k.is_last) Lanes::store_rows4(k.velocity + 4 * row, kConsecutive, v);
        }
        auto moved = Lanes::load_rows2(k.displacement + 2 * row, kConsecutive);
        const F inverse_mass = v[3];
        const F free_x = free.x(start_x, inverse_mass), free_y = free.y(start_y, inverse_mass);
        const F change_x = v[0] - start_x, change_y = v[1] - start_y;
        const F fall_x = free_x - start_x, fall_y = free_y - start_y;
        const F fall = fall_x * fall_x + fall_y * fall_y, margin(Real(1.0001));
        auto is_smooth = change_x * change_x + change_y * change_y <= fall * margin;
        if (kRests && k.joined) is_smooth = is_smooth & !(Lanes::load(k.joined + row) > F(0));
        moved[0] += h * (v[0] - simd::select(is_smooth, half * change_x, F(0)));
        moved[1] += h * (v[1] - simd::select(is_smooth, half * change_y, F(0)));
        Lanes::store_rows2(k.displacement + 2 * row, kConsecutive, moved);
        F start_rim(0), free_rim(0);
        if constexpr (kTurns) {
            start_rim = Lanes::load(k.start.rim + row), free_rim = free.spin(start_rim, inverse_mass);
            const F change = v[2] - start_rim, drag = free_rim - start_rim;
            auto turns_smoothly = change * change <= (fall + drag * drag) * margin;
            if (kRests && k.joined) turns_smoothly = turns_smoothly & !(Lanes::load(k.joined + row) > F(0));
            const F mean = v[2] - simd::select(turns_smoothly, half * change, F(0));
            Lanes::store(k.turn + row, Lanes::load(k.turn + row) + h * mean);
        }
        if (k.is_last) continue;
        Lanes::store(k.start.x + row, v[0]), Lanes::store(k.start.y + row, v[1]);
        const F next_x = free.x(v[0], inverse_mass) + (v[0] - free_x);
        const F next_y = free.y(v[1], inverse_mass) + (v[1] - free_y);
        if constexpr (kTurns) {
            Lanes::store(k.start.rim + row, v[2]);
            v[2] = free.spin(v[2], inverse_mass) + (v[2] - free_rim);
        }
        v[0] = simd::select(simd::abs(inverse_mass) > F(0), next_x, v[0]);
        v[1] = simd::select(simd::abs(inverse_mass) > F(0), next_y, v[1]);
        Lanes::store_rows4(k.velocity + 4 * row, kConsecutive, v);
    }
}

/// @see BeginSubsteps
template <bool kTurns, class Real, class Isa>
void begin_substeps(const BeginSubsteps<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::LanesOfRuns<simd::Lanes<Real, Isa>>;
    using F = typename Lanes::Batch;
    const FreeFlight<F> free{F(k.gain_x), F(k.gain_y), F(k.decay), F(k.spin_decay)};
    for (std::size_t row = first; row < last; row += Lanes::size) {
        auto record = Lanes::load_rows4(k.motion + 4 * row, kConsecutive);
        record[0] = record[2], record[1] = record[3];
        record[2] = F(0);
        if constexpr (kTurns) {
            const F radius = k.radius ? Lanes::load(k.radius + row) : F(k.uniform_radius);
            record[2] = Lanes::load(k.angular_velocity + row) * radius;
            Lanes::store(k.turn + row, F(0));
        }
        record[3] = k.inverse_mass ? Lanes::load(k.inverse_mass + row) : F(k.uniform_inverse_mass);
        Lanes::store(k.start.x + row, record[0]), Lanes::store(k.start.y + row, record[1]);
        if constexpr (kTurns) Lanes::store(k.start.rim + row, record[2]);
        record[0] = free.x(record[0], record[3]);
        record[1] = free.y(record[1], record[3]);
        record[2] = free.spin(record[2], record[3]);
        Lanes::store_rows4(k.velocity + 4 * row, kConsecutive, record);
        typename Lanes::Batch2 still{{F(0), F(0)}};
        Lanes::store_rows2(k.displacement + 2 * row, kConsecutive, still);
    }
}

/// @see EndSubsteps. @return how many rows were lost.
template <bool kTurns, class Real, class Isa>
std::size_t end_substeps(const EndSubsteps<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::LanesOfRuns<simd::Lanes<Real, Isa>>;
    using F = typename Lanes::Batch;
    const F largest_position(k.largest_position), largest_speed(k.largest_speed);
    const F largest_number(std::numeric_limits<Real>::max());
    std::size_t lost = 0;
    for (std::size_t row = first; row < last; row += Lanes::size) {
        auto v = Lanes::load_rows4(k.velocity + 4 * row, kConsecutive);
        const auto moved = Lanes::load_rows2(k.displacement + 2 * row, kConsecutive);
        const F old_x = Lanes::load(k.position_x + row), old_y = Lanes::load(k.position_y + row);
        F x = old_x + moved[0], y = old_y + moved[1];
        auto is_sound = (simd::abs(x) <= largest_position) & (simd::abs(y) <= largest_position) &
                        (simd::abs(v[0]) <= largest_speed) & (simd::abs(v[1]) <= largest_speed);
        F old_angle(0), angle(0), spin(0);
        if constexpr (kTurns) {
            F radius = k.radius ? Lanes::load(k.radius + row) : F(k.uniform_radius);
            radius = simd::select(radius > F(0), radius, F(1));  // padding rows have none
            old_angle = Lanes::load(k.angle + row), spin = Lanes::load(k.angular_velocity + row);
            angle = old_angle + Lanes::load(k.turn + row) / radius;
            // The change of the rim speed, so that a spin which nothing changes keeps its bits.
            spin = spin + (v[2] - spin * radius) / radius;
            is_sound = is_sound & (simd::abs(angle) <= largest_number) & (simd::abs(spin) <= largest_number);
        }
        if (!simd::all(is_sound)) {  // not a number compares false
            x = simd::select(is_sound, x, old_x), y = simd::select(is_sound, y, old_y);
            v[0] = simd::select(is_sound, v[0], F(0)), v[1] = simd::select(is_sound, v[1], F(0));
            angle = simd::select(is_sound, angle, old_angle), spin = simd::select(is_sound, spin, F(0));
            const unsigned bits = simd::bitmask(is_sound);
            for (std::size_t lane = 0; lane < Lanes::size; ++lane)
                if (((bits >> lane) & 1u) == 0) k.lost[lost++] = static_cast<std::int32_t>(row + lane);
        }
        Lanes::store(k.position_x + row, x);
        Lanes::store(k.position_y + row, y);
        Lanes::store(k.velocity_x + row, v[0]);
        Lanes::store(k.velocity_y + row, v[1]);
        if constexpr (kTurns)
            Lanes::store(k.angle + row, angle), Lanes::store(k.angular_velocity + row, spin);
    }
    return lost;
}

}  // namespace
}  // namespace carom
