#pragma once

#include "support/seed_run.hpp"

namespace carom::test {

// Each function measures one fault of the teaching program, on whichever engine it is given.
// docs/seed-faults.md lists the numbers.

/// Scene S1 with restitution 1 and no drag, 8 s in steps of dt: (energy at the end / at the start) - 1,
/// kinetic and potential above the floor. Exact: 0.
double elastic_energy_gain(StartRun start, double dt);

/// A disc in free flight for 1 s with what the seed calls damping, stepped with dt: the drag it feels [1/s].
/// Exact: kSeedDrag.
double drag_felt(StartRun start, double dt);

/// Two discs of radius 0.5 at rest with their centres `distance` apart, after 2 s: the distance of the
/// centres [m]. Exact: at least 1.
double distance_after_two_seconds(StartRun start, double distance);

/// Discs of 1 and 100 kg at rest, overlapping by 0.2 m, one step: how far their common centre moves [m].
/// Exact: 0.
double common_centre_shift(StartRun start);

/// A disc spinning at 10 rad/s meets another at 45 degrees, restitution 1: the largest change of a spin
/// [rad/s]. Exact with friction 0.5, where the discs stick while they touch: 1.9191; without friction: 0.
double spin_change(StartRun start);

/// A disc that is 1 mm inside the left wall and leaves at 1 m/s, restitution 0.8: its speed after a step
/// [m/s]. Exact: 1.
double speed_of_leaving_disc(StartRun start);

/// 1000 discs of radius 0.25 shot head-on at 100 m/s at a disc of radius 0.25 at rest, from evenly spread
/// distances, steps of 0.016 s: the share that ends beyond the target without having given it any speed.
/// Exact: 0.
double share_of_shots_through(StartRun start);

/// Scene S1: what is left at the end (8 s) of the kinetic energy, and of kinetic and potential energy above
/// the lowest place each disc can take.
struct EnergyLeft {
    double kinetic, total;  // no unit
};
EnergyLeft energy_left(StartRun start);

/// A disc of 1 kg falling freely for 1.6 s: how much kinetic energy alone says it gained, and kinetic and
/// potential energy together. Exact: mass * (gravity * 1.6)^2 / 2 = 20.48 J and 0.
struct FallEnergy {
    double kinetic_gain, total_gain;  // J
};
FallEnergy fall_energy(StartRun start);

/// An elastic gas of 196 discs, rms speed 3 m/s, in a closed box at this packing fraction, 200 s after 20 s.
struct GasReport {
    double pressure_error;  // pressure on the walls / that of hard discs in such a box - 1, no unit
    double energy_error;    // energy at the end / at the start - 1, no unit
};
GasReport elastic_gas(StartRun start, double packing_fraction, double dt);

}  // namespace carom::test
