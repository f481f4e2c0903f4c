#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace carom {

/// One disc of the naive engine. Plain data: read it, copy it, change it in a description.
struct PairwiseBody {
    double x = 0, y = 0;    ///< m, centre
    double vx = 0, vy = 0;  ///< m/s
    double mass = 1;        ///< kg, finite and > 0
    double radius = 0.5;    ///< m, finite and > 0
    double angle = 0;       ///< rad, counter-clockwise
    double omega = 0;       ///< rad/s
};

/// A closed box around the world; every side can be left out.
struct PairwiseWalls {
    double min_x = 0, min_y = 0, max_x = 0, max_y = 0;  ///< m, min < max
    bool left = true, right = true, bottom = true, top = true;
    double restitution = 0;  ///< no unit, >= 0
    double spin_kept = 0.9;  ///< no unit, in [0, 1]: what a wall contact leaves of the spin
};

/// Everything the naive engine is told. One restitution serves all pairs of bodies.
struct PairwiseScene {
    std::vector<PairwiseBody> bodies;
    double gravity_x = 0, gravity_y = 0;  ///< m/s²
    double linear_drag = 0;               ///< 1/s, >= 0: velocity <- velocity * exp(-linear_drag * dt)
    double angular_drag = 0;              ///< 1/s, >= 0: the same for the spin
    double restitution = 0;               ///< no unit, >= 0
    /// In [0, 1]: stands in for exp(-linear_drag * dt) whatever dt is, as in the seed.
    std::optional<double> keep_per_step;
    std::optional<PairwiseWalls> walls;
};

/// What the naive engine has done since it was built.
struct PairwiseCounts {
    std::uint64_t steps = 0;
    std::uint64_t pair_tests = 0;     ///< pairs looked at: bodies * (bodies - 1) / 2 a step
    std::uint64_t contacts = 0;       ///< of these, overlapping and more than kPairwiseBlindDistance apart
    std::uint64_t impulses = 0;       ///< of these, approaching, so that an impulse was applied
    std::uint64_t wall_contacts = 0;  ///< times a body was put back inside a wall
    double wall_impulse = 0;  ///< N s, sum of |impulse| on all walls; pressure = this / (perimeter * time)
    double pair_virial =
        0;  ///< J, what contacts added to the sum of momentum * position: pressure from inside
};

/// A plane vector of the naive engine's sums.
struct PairwiseVector {
    double x = 0, y = 0;
};

/// Pairs whose centres are at most this far apart are not seen by the naive engine [m].
inline constexpr double kPairwiseBlindDistance = 1e-9;

/// The naive pairwise engine: discs as an array of objects, every pair in the order i < j, one impulse a
/// contact, double precision, one thread, no SIMD. It is the yardstick of the benchmarks and the golden
/// numbers of the tests; its faults are part of it and are measured in docs/seed-faults.md.
///
/// One step, in this order: gravity, then damping; pairs (push apart half and half, then an impulse if
/// approaching); walls (put back inside, reverse with restitution, keep `spin_kept` of the spin); positions
/// and angles.
class Pairwise {
  public:
    /// @throws carom::Error naming the body or setting, its value, the limit and the remedy.
    /// Cost: O(bodies).
    explicit Pairwise(PairwiseScene scene);

    /// Advances every body by one step.
    ///
    /// @param dt  step length [s], finite and >= 0; 0 changes nothing.
    /// @throws carom::Error if dt is out of range; the bodies are then unchanged.
    /// Cost: O(bodies²); no allocation.
    void step(double dt);

    std::span<const PairwiseBody> bodies() const { return scene_.bodies; }
    const PairwiseCounts& counts() const { return counts_; }
    double time() const { return time_; }  ///< s

    double total_mass() const;              ///< kg
    double kinetic_energy() const;          ///< J, translation and rotation
    double rotational_energy() const;       ///< J, the part of kinetic_energy() in rotation
    double potential_energy() const;        ///< J in the field of gravity, 0 at the origin
    double total_energy() const;            ///< J, kinetic and potential
    PairwiseVector momentum() const;        ///< kg m/s
    double angular_momentum() const;        ///< kg m²/s about the origin, with spin
    PairwiseVector centre_of_mass() const;  ///< m; (0, 0) without bodies

  private:
    void accelerate(double dt);
    void resolve_pairs();
    void resolve_walls();
    void integrate_positions(double dt);

    PairwiseScene scene_;
    PairwiseCounts counts_;
    double time_ = 0;
};

/// Energy of one disc in translation and rotation [J]; the disc is solid: inertia mass * radius² / 2.
double kinetic_energy(const PairwiseBody& body);

}  // namespace carom
