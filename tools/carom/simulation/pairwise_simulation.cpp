#include <carom/errors.hpp>
#include <carom/pairwise.hpp>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>

#include "simulation/pairwise_scene.hpp"
#include "simulation/simulation.hpp"
#include "terminal/format.hpp"

namespace carom::tool {
namespace {

using Clock = std::chrono::steady_clock;

Vec2 to_vec2(PairwiseVector v) {
    return {v.x, v.y};
}

bool is_finite(const PairwiseBody& body) {
    return std::isfinite(body.x) && std::isfinite(body.y) && std::isfinite(body.vx) &&
           std::isfinite(body.vy) && std::isfinite(body.angle) && std::isfinite(body.omega);
}

/// Collects overlaps as fractions of a radius.
class OverlapSum {
  public:
    void add(double separation, double radius) {
        if (!(separation < 0)) return;
        const double overlap = -separation / radius;
        ++report_.touching;
        sum_ += overlap;
        report_.max = std::max(report_.max, overlap);
    }
    /// A wall that is touched counts as a candidate; pairs all do.
    void add_wall(double separation, double radius) {
        if (separation < 0) ++report_.candidates;
        add(separation, radius);
    }
    OverlapReport report(std::int64_t pairs) const {
        OverlapReport result = report_;
        result.candidates += pairs;
        result.mean = report_.touching > 0 ? sum_ / static_cast<double>(report_.touching) : 0;
        return result;
    }

  private:
    OverlapReport report_;
    double sum_ = 0;
};

/// The naive engine behind the interface. It keeps no books: of the causes it knows gravity alone, and what
/// is left over is unexplained.
class PairwiseSimulation final : public Simulation {
  public:
    explicit PairwiseSimulation(const Scene& scene)
        : description_(to_pairwise(scene)),
          engine_(description_),
          substeps_(scene.accuracy.substeps.value_or(1)),
          keeps_ledger_(scene.effects.ledger.value_or(false)),
          initial_(energies()) {}

    void step(double dt) override {
        const auto start = Clock::now();
        const double part = substeps_ == 1 ? dt : dt / substeps_;
        for (int i = 0; i < substeps_; ++i) engine_.step(part);
        seconds_ += std::chrono::duration<double>(Clock::now() - start).count();
        ++steps_;
    }

    std::size_t body_count() const override { return engine_.bodies().size(); }
    Precision precision() const override { return Precision::double_; }
    double time() const override { return engine_.time(); }
    BodyState state(std::size_t body) const override {
        const PairwiseBody& b = engine_.bodies()[body];
        return {
            .position = {b.x, b.y}, .angle = b.angle, .velocity = {b.vx, b.vy}, .angular_velocity = b.omega};
    }
    void copy_frame(const FrameTarget& frame) const override {
        auto* position = reinterpret_cast<double*>(frame.position);
        auto* velocity = reinterpret_cast<double*>(frame.velocity);
        auto* angle = reinterpret_cast<double*>(frame.angle);
        for (const PairwiseBody& b : engine_.bodies()) {
            *position++ = b.x, *position++ = b.y;
            *velocity++ = b.vx, *velocity++ = b.vy;
            *angle++ = b.angle;
        }
    }

    bool keeps_ledger() const override { return keeps_ledger_; }
    Ledger ledger() const override;
    Profile profile() const override;
    Plan plan() const override;
    OverlapReport overlaps() const override;
    std::vector<std::size_t> quarantined() const override;
    std::uint64_t state_hash() const override;

  private:
    Ledger energies() const;

    PairwiseScene description_;
    Pairwise engine_;
    int substeps_;
    bool keeps_ledger_;
    Ledger initial_;
    std::int64_t steps_ = 0;
    double seconds_ = 0;
};

/// Energy and momentum now, without causes.
Ledger PairwiseSimulation::energies() const {
    Ledger now;
    now.time = engine_.time();
    now.energy = {.kinetic = engine_.kinetic_energy() - engine_.rotational_energy(),
                  .rotational = engine_.rotational_energy(),
                  .potential = engine_.potential_energy()};
    now.momentum = to_vec2(engine_.momentum());
    now.angular_momentum = engine_.angular_momentum();
    now.wall_impulse = engine_.counts().wall_impulse;
    return now;
}

Ledger PairwiseSimulation::ledger() const {
    Ledger now = energies();
    now.initial = initial_.energy;
    now.initial_momentum = initial_.momentum;
    now.initial_angular_momentum = initial_.angular_momentum;
    if (!keeps_ledger_) return now;

    const double mass = engine_.total_mass(), time = engine_.time();
    now.energy_by_cause.gravity = now.initial.potential - now.energy.potential;
    now.energy_by_cause.unexplained = now.energy.total() - now.initial.total();
    now.momentum_by_cause.gravity = {mass * description_.gravity_x * time,
                                     mass * description_.gravity_y * time};
    now.momentum_by_cause.unexplained = {
        now.momentum.x - now.initial_momentum.x - now.momentum_by_cause.gravity.x,
        now.momentum.y - now.initial_momentum.y - now.momentum_by_cause.gravity.y};
    return now;
}

Profile PairwiseSimulation::profile() const {
    const PairwiseCounts& counts = engine_.counts();
    const auto bodies = static_cast<std::int64_t>(body_count());
    Profile profile;
    profile.stages = {{.name = "pairwise step", .calls = steps_ * substeps_, .seconds = seconds_}};
    profile.steps = steps_;
    profile.candidate_pairs = bodies * (bodies - 1) / 2;
    profile.impacts = static_cast<std::int64_t>(counts.impulses + counts.wall_contacts);
    profile.wall_impacts = static_cast<std::int64_t>(counts.wall_contacts);
    profile.overlaps_corrected = static_cast<std::int64_t>(counts.contacts + counts.wall_contacts);
    profile.bytes = body_count() * sizeof(PairwiseBody);
    return profile;
}

OverlapReport PairwiseSimulation::overlaps() const {
    const auto bodies = engine_.bodies();
    OverlapSum sum;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const PairwiseBody& a = bodies[i];
        for (std::size_t j = i + 1; j < bodies.size(); ++j) {
            const PairwiseBody& b = bodies[j];
            const double distance = std::sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
            sum.add(distance - a.radius - b.radius, std::min(a.radius, b.radius));
        }
        if (!description_.walls) continue;
        const PairwiseWalls& walls = *description_.walls;
        if (walls.left) sum.add_wall(a.x - a.radius - walls.min_x, a.radius);
        if (walls.right) sum.add_wall(walls.max_x - a.x - a.radius, a.radius);
        if (walls.bottom) sum.add_wall(a.y - a.radius - walls.min_y, a.radius);
        if (walls.top) sum.add_wall(walls.max_y - a.y - a.radius, a.radius);
    }
    return sum.report(profile().candidate_pairs);
}

/// The naive engine disables nothing; bodies whose state is no number any more are named all the same.
std::vector<std::size_t> PairwiseSimulation::quarantined() const {
    std::vector<std::size_t> lost;
    for (std::size_t i = 0; i < body_count(); ++i)
        if (!is_finite(engine_.bodies()[i])) lost.push_back(i);
    return lost;
}

/// FNV-1a (Fowler, Noll, Vo) over the bytes of all state, low byte first.
std::uint64_t PairwiseSimulation::state_hash() const {
    std::uint64_t hash = 14695981039346656037u;
    for (const PairwiseBody& b : engine_.bodies())
        for (const double value : {b.x, b.y, b.vx, b.vy, b.angle, b.omega}) {
            const auto bits = std::bit_cast<std::uint64_t>(value);
            for (int shift = 0; shift < 64; shift += 8)
                hash = (hash ^ (bits >> shift & 0xff)) * 1099511628211u;
        }
    return hash;
}

Plan PairwiseSimulation::plan() const {
    const bool spins = std::any_of(description_.bodies.begin(), description_.bodies.end(),
                                   [](const PairwiseBody& body) { return body.omega != 0; });
    const bool falls = description_.gravity_x != 0 || description_.gravity_y != 0;
    const bool drags = description_.linear_drag > 0 || description_.angular_drag > 0;
    const bool bounces =
        description_.restitution > 0 || (description_.walls && description_.walls->restitution > 0);
    Plan plan;
    plan.solver = "pairwise";
    plan.solver_reason = "asked for";
    plan.substeps = substeps_;
    plan.precision = "double";
    plan.isa = "scalar";
    plan.effects = {
        {"gravity", falls, falls ? "gravity is not zero" : "gravity is zero"},
        {"drag", drags, drags ? "drag is above zero" : "no drag"},
        {"walls", description_.walls.has_value(), description_.walls ? "the scene has walls" : "no walls"},
        {"restitution", bounces, bounces ? "a restitution is above zero" : "every restitution is zero"},
        {"rotation", spins, spins ? "a body spins from the start" : "nothing spins"},
        {"ledger", keeps_ledger_,
         keeps_ledger_ ? "asked for; gravity is the one cause the naive engine knows" : "not asked for"},
    };
    plan.stages = {{"accelerate", "scalar", "velocity", "velocity"},
                   {"resolve_pairs", "scalar, every pair", "pose, velocity", "pose, velocity"},
                   {"resolve_walls", "scalar", "pose, velocity", "pose, velocity"},
                   {"integrate_positions", "scalar", "pose, velocity", "pose"}};
    plan.columns = {{"body (one object)", "m, m/s, kg, rad, rad/s", sizeof(PairwiseBody)}};
    plan.bytes_per_body = sizeof(PairwiseBody);
    return plan;
}

}  // namespace

std::unique_ptr<Simulation> make_pairwise_simulation(const Scene& scene, const MachineSettings& machine) {
    if (machine.isa != "auto" && machine.isa != "scalar")
        throw Error(ErrorCode::unsupported_isa,
                    joined("Solver pairwise: the instruction set asked for is \"", machine.isa,
                           "\"; expected \"auto\" or \"scalar\": the naive engine is scalar."));
    return std::make_unique<PairwiseSimulation>(scene);
}

}  // namespace carom::tool
