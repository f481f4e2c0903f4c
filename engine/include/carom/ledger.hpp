#pragma once

#include <carom/vec2.hpp>

namespace carom {

/// Mechanical energy of all dynamic bodies at one moment [J]. Potential is zero at the origin: -m g·x.
struct Energy {
    double kinetic = 0;     ///< translation
    double rotational = 0;  ///< spin
    double potential = 0;
    double total() const { return kinetic + rotational + potential; }
};

/// Work done on the dynamic bodies since the start, by cause [J]. Always
/// kinetic + rotational - (their start) = sum(); and as gravity = -(change of potential),
/// total - (total at the start) = sum() - gravity.
struct EnergyByCause {
    double gravity = 0;
    double drag = 0;
    double restitution = 0;  ///< lost where bodies or walls meet with restitution < 1
    double friction = 0;     ///< lost where surfaces slide on each other
    double correction = 0;   ///< spent on pushing overlapping bodies apart against gravity
    double joints = 0;       ///< by springs, motors and targets; what rigid joints take: their error
    double drive = 0;        ///< by kinematic bodies
    double sleep = 0;        ///< what bodies still had when they were put to sleep
    /// What came and went with bodies that calls added, changed or removed, or that were quarantined:
    /// potential energy included, which `gravity`, too, says of them.
    double outside = 0;
    double unexplained = 0;  ///< what the columns say minus what the causes add up to: the error of the run
    double sum() const {
        return gravity + drag + restitution + friction + correction + joints + drive + sleep + outside +
               unexplained;
    }
};

/// Momentum given to the dynamic bodies since the start, by cause [kg m/s].
struct MomentumByCause {
    Vec2 gravity;
    Vec2 drag;
    Vec2 walls;
    Vec2 immovable;  ///< by static and kinematic bodies
    Vec2 sleep;      ///< taken from bodies that were put to sleep
    Vec2 outside;    ///< came and went with bodies that calls changed or that were quarantined
    Vec2 unexplained;
};

/// Energy that neither a law nor rounding explains [J]: the most that a step has had of it so far. All three
/// are zero where what holds by construction holds, as it should; each is above what rounding explains.
/// docs/how-a-step-works.md has the rules and their bounds.
struct EnergyExcess {
    double restitution = 0;  ///< given in a step where bodies or walls meet
    double correction = 0;   ///< by pushing bodies apart in a step, beyond what the overlap was worth
    double passive = 0;      ///< that a world which nothing drives had above that at its start
};

/// The books of a world: sums over its dynamic bodies, in double precision whatever the world's own.
struct Ledger {
    double time = 0;  ///< s
    Energy initial;   ///< when the world was made, of the bodies of its scene; likewise below
    Energy energy;
    Vec2 initial_momentum;  ///< kg m/s
    Vec2 momentum;
    double initial_angular_momentum = 0;  ///< kg m²/s about the origin, spin included
    double angular_momentum = 0;
    EnergyByCause energy_by_cause;      ///< zero unless the ledger effect is on
    MomentumByCause momentum_by_cause;  ///< zero unless the ledger effect is on
    EnergyExcess energy_excess;         ///< zero unless the ledger effect is on
    double wall_impulse = 0;  ///< N s, sum of |impulse| on all walls; pressure = this / (perimeter · time)
};

}  // namespace carom
