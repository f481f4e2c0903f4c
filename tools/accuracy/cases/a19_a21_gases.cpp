#include <map>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr std::int64_t kDiscs = 256;
constexpr double kForever = 1e9;  // s
const std::vector<double> kSteps{1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480};

Scene equal_speeds(int member) {
    Scene scene = gas_of(kDiscs, 0.4, 1, member);
    for (Body& body : scene.bodies) {
        const double scale = 3 / std::hypot(body.velocity.x, body.velocity.y);
        body.velocity = {scale * body.velocity.x, scale * body.velocity.y};
    }
    return scene;
}

std::vector<double> run_elastic(Stepper& stepper, const Scene&, int) {
    const double start = stepper.kinetic_energy();
    double flatness = 0;
    int looks = 0;
    for (double time = 4; time <= 8;
         time += 0.5, ++looks) {  // s: some twenty collisions a disc, then three a look
        stepper.advance_to(time);
        double squares = 0, fourths = 0;
        for (std::size_t i = 0; i < kDiscs; ++i) {
            const Vec2 v = stepper.state(i).velocity;
            const double v2 = v.x * v.x + v.y * v.y;
            squares += v2, fourths += v2 * v2;
        }
        flatness += fourths * kDiscs / (squares * squares);
    }
    // Of n discs with one energy together: 2 n / (n + 1), for n without end Maxwell's 2.
    const double exact = 2.0 * kDiscs / (kDiscs + 1);
    return {stepper.kinetic_energy() / start - 1, flatness / looks / exact - 1};
}

/// What a gas does in a while, as other starts of the exact solver have it on average.
struct Behaviour {
    double pressure = 0;  // N/m
    double rate = 0;      // collisions a second
    double energy = 0;    // J, in the end
};

Behaviour watch(Stepper& stepper, const Scene& scene) {
    constexpr double kStart = 1, kEnd = 9;  // s
    stepper.advance_to(kStart);
    const double impulse = stepper.simulation().ledger().wall_impulse,
                 impacts = count_impacts(stepper, false);
    stepper.advance_to(kEnd);
    const double side = scene.walls->max.x - scene.walls->min.x, time = kEnd - kStart;
    return {(stepper.simulation().ledger().wall_impulse - impulse) / (4 * side * time),
            (count_impacts(stepper, false) - impacts) / time, stepper.kinetic_energy()};
}

Behaviour reference_of(Scene (*scene)(int)) {
    constexpr int kStarts = 128, kFirst = 1000;  // none of those that are compared with it
    static std::map<Scene (*)(int), Behaviour> known;
    if (const auto found = known.find(scene); found != known.end()) return found->second;
    Behaviour mean;
    for (int member = kFirst; member < kFirst + kStarts; ++member) {
        const Scene start = scene(member);
        Stepper stepper(start, {.solver = Solver::event, .precision = Precision::double_, .dt = 0.5},
                        kForever);
        const Behaviour one = watch(stepper, start);
        mean.pressure += one.pressure / kStarts, mean.rate += one.rate / kStarts;
        mean.energy += one.energy / kStarts;
    }
    return known[scene] = mean;
}

Scene dense_gas(int member) {
    return gas_of(kDiscs, 0.3, 1, member);
}

std::vector<double> run_pressure(Stepper& stepper, const Scene& scene, int) {
    const Behaviour found = watch(stepper, scene), exact = reference_of(dense_gas);
    return {found.pressure / exact.pressure - 1, found.rate / exact.rate - 1};
}

constexpr double kCoolingRestitution = 0.95;

Scene dissipating_gas(int member) {
    Scene scene = gas_of(kDiscs, 0.2, kCoolingRestitution, member);
    scene.walls->material = bouncy(1);
    return scene;
}

std::vector<double> run_cooling(Stepper& stepper, const Scene& scene, int) {
    const double start = stepper.kinetic_energy();
    const Behaviour found = watch(stepper, scene), exact = reference_of(dissipating_gas);
    const double collisions_a_disc = 2 * count_impacts(stepper, false) / kDiscs;
    const double lost = (1 - kCoolingRestitution * kCoolingRestitution) / 2;
    return {found.energy / exact.energy - 1,
            found.energy / (start * std::exp(-lost * collisions_a_disc)) - 1};
}

}  // namespace

Case elastic_gas() {
    return {.id = "A19",
            .title = "Elastic gas of 256 discs, packing fraction 0.4",
            .kind = "gas",
            .effects = "N R",
            .exact =
                "energy constant; speeds that were all equal take Maxwell's distribution: <v^4>/<v^2>^2 = "
                "2n/(n+1)",
            .errors = {{"energy", "change of the kinetic energy in 8 s, over the first"},
                       {"distribution", "<v^4>/<v^2>^2 over its exact value, less 1", true}},
            .solvers = {"event", "impulse", "soft", "pairwise"},
            .steps = kSteps,
            .members = kEnsemble,
            .scene = equal_speeds,
            .run = run_elastic};
}

Case gas_pressure() {
    return {.id = "A20",
            .title = "Pressure and collision rate of a gas, packing fraction 0.3",
            .kind = "gas",
            .effects = "N R",
            .exact =
                "the mean of 128 other starts of the exact solver, itself within 0.5 % of Henderson's "
                "equation of state",
            .errors = {{"pressure", "pressure on the walls over the exact one, less 1", true},
                       {"collision rate", "collisions a second over the exact number, less 1", true}},
            .solvers = {"event", "impulse", "soft", "pairwise"},
            .steps = kSteps,
            .members = kEnsemble,
            .counts = true,
            .scene = dense_gas,
            .run = run_pressure};
}

Case cooling_gas() {
    return {.id = "A21",
            .title = "Cooling granular gas, restitution 0.95, packing fraction 0.2",
            .kind = "gas",
            .effects = "N R",
            .exact =
                "the mean of 128 other starts of the exact solver; E = E0 exp(-(1 - e²) τ/2), τ collisions a "
                "disc",
            .errors = {{"energy", "energy after 9 s over the exact one, less 1", true},
                       {"energy by collisions", "energy over E0 exp(-(1 - e²) τ/2), less 1", true}},
            .solvers = {"event", "impulse", "soft", "pairwise"},
            .steps = kSteps,
            .members = kEnsemble,
            .counts = true,
            .scene = dissipating_gas,
            .run = run_cooling};
}

}  // namespace carom::accuracy
