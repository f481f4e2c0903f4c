#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

// Plain arguments of the kernels that find contacts and solve them (solver `soft`). Columns are padded and
// 64-byte aligned, and `first` is a multiple of kRowPadding: a batch that goes beyond `last` ends in padding,
// so there is no tail.
//
// A body's velocity record is [4]: vx, vy [m/s], rim speed u = spin * radius [m/s], inverse mass [1/kg]. The
// inverse mass is zero for what nothing moves, and negative for a disc that has a fixed angle.
// effects/contact_law.hpp says why the rim speed stands in place of the spin, and what contacts do.
// A body's displacement record is [2]: how far it moved since the start of the step [m].

namespace carom {

/// Contacts of a block belong to one colour: a batch of any width is in one block. It is kRowPadding, which
/// kernels do not see.
inline constexpr std::size_t kContactBlock = 16;
/// The last block of a colour is half a block where that holds its contacts: it is solved by short lanes.
inline constexpr std::size_t kHalfBlock = kContactBlock / 2;

/// Contacts of one kind as the solver streams them, sorted by colour: a body is in one contact of a colour.
/// The normal points from body a to body b, the tangent is the normal turned by a quarter counter-clockwise.
template <class Real>
struct ContactColumns {
    std::int32_t* a;         // row
    std::int32_t* b;         // row; null where nothing moves b
    Real* normal_x;          // no unit
    Real* normal_y;          //
    Real* separation;        // m, at the start of the step; negative = overlapping
    Real* mass;              // kg, effective, along the normal
    Real* normal_impulse;    // N s, of a substep, >= 0
    Real* friction_impulse;  // N s, along the tangent, on b; null without friction
    Real* friction;          // Coulomb coefficient; null: uniform_friction serves all
    Real* floor;             // m/s, least relative normal velocity, written by the first sweep
    Real* surface_normal;    // m/s, velocity of b along the normal; only where b is null
    Real* surface_tangent;   // m/s, velocity of b's surface along the tangent; only where b is null
    // Only with kRolling.
    Real* rolling_impulse;  // N s
    Real* rolling;          // coefficient; null: uniform_rolling serves all
    Real* rolling_share;    // weight of a's rim speed; null: one half, as for two discs of the same radius
    Real* surface_rolling;  // m/s, b's share of the rolling velocity; only where b is null
    // Only where radii vary.
    const Real*
        smaller;  // m, the smaller radius of the two, or that of a where b is null; null: `push` is in m
};

/// One Gauss-Seidel sweep over the contacts of a colour.
template <class Real>
struct SolveContacts {
    ContactColumns<Real> contacts;
    Real* velocity;      // [rows][4]
    Real* displacement;  // [rows][2]
    Real uniform_friction;
    Real uniform_rolling;
    Real inverse_h;  // 1/s, of the substep
    Real h;          // s
    Real elapsed;    // s, since the start of the step, at the start of the substep
    Real recovery;   // share of an overlap that one sweep takes away, by displacement
    Real push;       // largest displacement of that kind: m, or of contacts.smaller
    Real slop;       // overlap that is left, without friction alone: m, or of contacts.smaller
    // The next members are read for pairs alone, in the first sweep.
    Real calm;  // m/s: a contact that changes by no more needs no second sweep; below zero: all need one
    Real over_relaxation;           // of normal impulses, 1 ... 2
    Real calm_over_relaxation;      // of those of calm contacts
    Real next_over_relaxation = 1;  // of pairs in the other sweeps
    std::uint8_t*
        needs_second_sweep;  // out, [last / kContactBlock]: set where a contact of the block is not calm
    // The rest is for kernels/contacts/coarse_correction.hpp alone.
    const Real* reach = nullptr;  // m, sum of the radii; null where b is
    Real* load = nullptr;         // [rows][4]
    Real* stress = nullptr;       // [rows][4]
    const Real* scale = nullptr;  // [rows]
    Real kept = 0;                // share
};

/// What kernels/contacts/find_deep.hpp looks for.
template <class Real>
struct DeepPairs {
    Real closes;  // way in a substep: m, or of contacts.smaller
    Real deep;    // overlap behind it: likewise
};

/// The mark of a block that has a contact of bodies which are deep in each other.
inline constexpr std::uint8_t kDeepBlock = 2;

/// What changes from step to step in the contacts of a group. They stay where they are; blocks of them
/// without any that can touch in this step are told apart, so that nothing need look at them again.
template <class Real>
struct FindContacts {
    const Real* motion;      // [rows][4]: x, y [m], vx, vy [m/s] at the start of the step
    const std::int32_t* a;   // rows
    const std::int32_t* b;   //
    const Real* reach;       // m, sum of the radii; zero for padding
    const Real* smaller;     // m, the smaller of the radii; null where all are the same
    Real* normal_impulse;    // N s, from the step before; zeroed where bodies cannot touch
    Real* friction_impulse;  // likewise
    Real* rolling_impulse;   // likewise; null without rolling resistance
    Real* normal_x;          // out
    Real* normal_y;          // out
    Real* separation;        // out, m
    Real* approach;          // out: m/s, relative normal velocity at the start; null without restitution
    Real dt;                 // s, of the step
    Real near;               // m, separation up to which slow bodies are in contact
    Real near_of_smaller;    // besides, of `smaller`
    Real deep;  // below zero: separation of bodies that are deep in each other: m, or of `smaller`
    std::uint8_t* is_live;  // out, [last / kContactBlock]: whether a contact of the block can touch: 0, 1,
                            // or kDeepBlock
    Real strike = 0;        // way along the normal in the step: m, or of `smaller`
    std::uint8_t* is_struck = nullptr;  // out, [last / kContactBlock]: whether two of the block meet in this
                                        // step and come by more than `strike`; null: not asked for
    Real pace = 1;  // share of a gap that counts where the contact carried something in the step before
};

/// Velocities at the start of a substep. Those of single bodies are not asked for, so they are columns.
template <class Real>
struct StartColumns {
    Real *x, *y;  // m/s
    Real* rim;    // m/s, of the rim; null without rotation
};

/// The passage from the end of one substep to the start of the next, or to the end of the step.
template <class Real>
struct AdvanceBodies {
    Real* velocity;  // [rows][4], in: at the end of the substep; out: at the start of the next, foreseen
    StartColumns<Real> start;  // in: at the start of the substep; out: of the next
    Real* displacement;        // [rows][2]
    Real* turn;                // m, rim displacement u t since the start of the step; null without rotation
    Real h;                    // s
    Real gain_x, gain_y;       // m/s, what gravity adds in a substep
    Real decay;                // velocity kept under drag in a substep
    Real spin_decay;           // rim speed kept under angular drag
    bool is_last;              // no next substep
    const Real* joined;        // [rows], above zero for bodies that have joints; null where there are none
    Real nothing;              // m/s: what is slower, and loses speed, is at rest
};

/// The kinetic energy that impulses have added in a substep, and that which free flight left [J].
struct EnergyGain {
    double gain = 0, before = 0;
};

/// Velocities at the end of a substep, and what free flight made of those at its start.
template <class Real>
struct MeasureGain {
    const Real* velocity;  // [rows][4]
    StartColumns<Real> start;
    Real gain_x, gain_y;  // m/s, what gravity adds in a substep
    Real decay;           // velocity kept under drag in a substep
    Real spin_decay;      // rim speed kept under angular drag
};

/// Partial sums, whose sum is what is asked for: kernels/contacts/ordered_sum.hpp.
struct alignas(64) BlockOfSums : std::array<double, kContactBlock> {
    double sum() const {
        double all = 0;
        for (const double part : *this) all += part;
        return all;
    }
};

/// Work of impulses of contacts [J].
struct WorkSums {
    BlockOfSums normal{};
    BlockOfSums tangent{};  // that of rolling impulses as well
};

/// Sums over bodies that something moves, of a substep: m mass, v0 and v velocity at its start and on the
/// mean.
struct FlightSums {
    BlockOfSums mean_x{}, mean_y{};  // m v [kg m/s]
    // The next members are summed with drag alone.
    BlockOfSums start_x{}, start_y{};  // m v0 [kg m/s]
    BlockOfSums path{};                // m v0·v [J]
    BlockOfSums turn{};                // the same of rims [J]
};

/// The means of velocities before and after a substep.
template <class Real>
struct TakeMeans {
    const Real* velocity;      // [rows][4], at the end
    StartColumns<Real> start;  // at the start
    const Real* mass;          // kg, or null: uniform_mass serves all
    Real uniform_mass;         // kg
    Real* mean;                // out, [rows][4]: vx, vy, rim speed [m/s]; what is in a record besides
};

/// Velocity and displacement records at the start of a step.
template <class Real>
struct BeginSubsteps {
    const Real* motion;            // [rows][4]: x, y, vx, vy
    const Real* angular_velocity;  // rad/s, or null
    const Real* radius;            // m, or null: uniform_radius serves all
    const Real* inverse_mass;      // 1/kg, signed as in the records, or null: uniform_inverse_mass serves all
    Real uniform_radius;
    Real uniform_inverse_mass;
    Real gain_x, gain_y;  // m/s
    Real decay;
    Real spin_decay;
    std::size_t count;         // rows at and beyond it are padding: all zero
    Real* velocity;            // out
    StartColumns<Real> start;  // out
    Real* displacement;        // out
    Real* turn;                // out, or null
};

/// Positions and velocities back into the columns.
template <class Real>
struct EndSubsteps {
    const Real* velocity;      // [rows][4]
    const Real* displacement;  // [rows][2]
    const Real* turn;          // m, or null
    const Real* radius;        // m, or null: uniform_radius serves all
    Real uniform_radius;
    Real* position_x;  // in and out, m
    Real* position_y;
    Real* velocity_x;  // out, m/s
    Real* velocity_y;
    Real* angle;             // in and out, rad, or null
    Real* angular_velocity;  // in and out, rad/s, or null
    Real largest_position;   // m
    Real largest_speed;      // m/s
    std::int32_t* lost;      // out: rows whose state leaves the limits, or is not a number: they keep their
                             // position and stop; room for last - first and a batch
};

}  // namespace carom
