#include "solvers/shared/check_energy.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <limits>

#include "math/vec2_math.hpp"

namespace carom {
namespace {

/// Roundings of a velocity in a substep: 4 in free flight, and 2 in each of 3 visits of each of 6 contacts.
constexpr double kRoundings = 40;
/// Energy that a passive world may gain by the energy rule (docs/hard-cases.md), a share of its parts' sizes:
/// debug builds assert that. By how much it is above rounding is noted in any case.
constexpr double kLargestRise = 1e-3;

/// Energy of all dynamic bodies, and the sum of its parts' sizes, by which rounding goes [J].
struct EnergyAndSize {
    double energy = 0, size = 0;
};

/// Each of kEnergyLanes partial sums takes every kEnergyLanes-th row, which is what compilers make lanes of.
constexpr std::size_t kEnergyLanes = 4;
using Lanes = std::array<double, kEnergyLanes>;

double sum_of(const Lanes& lanes) {
    return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

template <class Real>
EnergyAndSize energy_of(const WorldState<Real>& world) {
    const Bodies<Real>& bodies = world.bodies;
    const Real *const x = bodies.position_x.data(), *const y = bodies.position_y.data(),
                      *const vx = bodies.velocity_x.data(), *const vy = bodies.velocity_y.data(),
                      *const masses = bodies.mass.data(), *const rims = bodies.rim().data(),
                      *const spins = bodies.has_rotation ? bodies.angular_velocity.data() : nullptr;
    const double mass = bodies.mass.uniform_value(), rim = bodies.rim().uniform_value(), gx = world.gravity.x,
                 gy = world.gravity.y;
    Lanes motion{}, potential{}, size{};  // J, motion twice
    const std::size_t rows = bodies.rows();
    for (std::size_t first = 0; first < rows; first += kEnergyLanes) {
        const std::size_t lanes = std::min(kEnergyLanes, rows - first);
        Lanes m{}, u{}, squares{}, across{}, along{};
        for (std::size_t k = 0; k < lanes; ++k) m[k] = masses ? static_cast<double>(masses[first + k]) : mass;
        for (std::size_t k = 0; k < lanes && bodies.has_flags; ++k)
            if (bodies.is_immovable(first + k)) m[k] = 0;
        for (std::size_t k = 0; k < lanes && spins; ++k)
            u[k] =
                static_cast<double>(spins[first + k]) * (rims ? static_cast<double>(rims[first + k]) : rim);
        const auto take = [&](std::size_t k) {
            const double ax = vx[first + k], ay = vy[first + k];
            squares[k] = ax * ax + ay * ay;
            across[k] = gx * static_cast<double>(x[first + k]),
            along[k] = gy * static_cast<double>(y[first + k]);
        };
        if (lanes == kEnergyLanes)
            for (std::size_t k = 0; k < kEnergyLanes; ++k) take(k);
        else
            for (std::size_t k = 0; k < lanes; ++k) take(k);
        for (std::size_t k = 0; k < kEnergyLanes; ++k) {
            motion[k] += m[k] * (squares[k] + 0.5 * (u[k] * u[k]));
            potential[k] -= m[k] * (across[k] + along[k]);
            size[k] += m[k] * (std::fabs(across[k]) + std::fabs(along[k]));
        }
    }
    const double kinetic = 0.5 * sum_of(motion);
    return {kinetic + sum_of(potential), kinetic + sum_of(size)};
}

template <class Real>
bool is_driven(const WorldState<Real>& world) {
    const Bodies<Real>& bodies = world.bodies;
    const bool is_pushed =
        std::any_of(world.immovable_rows.begin(), world.immovable_rows.end(), [&](std::int32_t of) {
            const auto row = static_cast<std::size_t>(of);
            if (!(bodies.flags_of(row) & kKinematic)) return false;
            return bodies.velocity_x[row] != 0 || bodies.velocity_y[row] != 0 ||
                   (bodies.has_rotation && bodies.angular_velocity[row] != 0);
        });
    // A joint that broke in this step has brought what its gap was worth, or its motor.
    bool is_moved = is_pushed || world.joints.may_move_limits() || world.joints.have_broken_since(world.time);
    if (!is_moved && !world.joints.empty())
        world.joints.for_each([&](std::size_t, const StoredJoint& joint) {
            is_moved = is_moved || joint.has_motor || joint.is_spring() || joint.type == JointType::target;
        });
    return is_moved;
}

/// Notes what is above a bound. @param is_kept  whether debug builds assert that it is no more than `most`
/// [J]
void note([[maybe_unused]] const char* rule, double value, double bound, [[maybe_unused]] bool is_kept,
          [[maybe_unused]] double most, double& largest) {
    largest = std::fmax(largest, value - bound);
#ifndef NDEBUG
    is_kept = is_kept && value > bound + most;
    if (is_kept)
        std::fprintf(stderr, "energy rule: %s by %g J, where rounding and overlaps explain %g J\n", rule,
                     value, bound);
    assert(!is_kept && "a rule of energy is kept in every step");
#endif
}

}  // namespace

template <class Real>
void check_energy(WorldState<Real>& world, int substeps, const KeptEnergyRules& kept) {
    EnergyWatch& watch = world.energy_watch;
    Books& books = world.books;
    const auto [energy, size] = energy_of(world);
    const double round_off =
        kRoundings * substeps * static_cast<double>(std::numeric_limits<Real>::epsilon()) * size;
    const double given = books.restitution - watch.restitution, lifted = books.correction - watch.correction;
    const double contacts = books.restitution + books.friction + books.joints;
    const double worth = books.overlap_worth + std::fmax(0, watch.taken_by_contacts - contacts);
    note("restitution gives energy", given, round_off, kept.restitution, 0, watch.largest.restitution);
    note("pushes lift bodies", lifted, worth + round_off, kept.correction, 0, watch.largest.correction);

    // What is left by steps that need not keep the rule is where those begin that do.
    if (kept.passive && !watch.was_kept) watch.is_set = false;
    watch.was_kept = kept.passive;
    const double brought = world.outside.energy.total() - watch.outside;
    if (!watch.is_set || brought != 0) {
        watch.allowed = watch.energy + brought + books.overlap_worth, watch.is_set = true;
        // What calls have brought is a sum, from which that of the bodies may differ by its rounding: of
        // bodies that are all gone it leaves what is no energy.
        watch.round_off = kRoundings * std::numeric_limits<double>::epsilon() *
                          (std::fabs(watch.energy) + std::fabs(watch.outside) + watch.brought);
        // A body that is quarantined is taken with what the step gave it, and stays where it was before.
        if (brought != 0 && world.quarantined_count > 0) watch.allowed = std::fmax(watch.allowed, energy);
    }
    watch.round_off += round_off;
    if (is_driven(world))
        watch.is_set = false;
    else
        note("a passive world has gained", energy - watch.allowed, watch.round_off, kept.passive,
             kLargestRise * size, watch.largest.passive);

    watch.energy = energy, watch.outside = world.outside.energy.total(), watch.brought = 0;
    watch.restitution = books.restitution, watch.correction = books.correction;
    watch.taken_by_contacts = contacts;
    books.overlap_worth = 0;
}

template void check_energy(WorldState<float>&, int, const KeptEnergyRules&);
template void check_energy(WorldState<double>&, int, const KeptEnergyRules&);

}  // namespace carom
