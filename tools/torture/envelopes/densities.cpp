// How dense a gas may be, by restitution.
#include <cmath>
#include <numbers>

#include "measure/text.hpp"
#include "torture/envelopes/envelope.hpp"
#include "torture/hard/passive_rule.hpp"
#include "torture/random.hpp"

namespace carom::torture {
namespace {

constexpr double kLargestDensity = 0.88;     // of the area; touching in hexagons they fill .907 without walls
constexpr double kRadius = 0.5, kSpeed = 3;  // m, m/s rms

/// Discs of any density: rows in hexagons, as far apart as the density asks, in a closed box.
Scene gas_of(double density, double restitution, std::uint64_t seed) {
    constexpr int kColumns = 20, kRows = 20;
    const Material material{.restitution = restitution};
    const double pitch = 2 * kRadius * std::sqrt(std::numbers::pi / (2 * std::numbers::sqrt3) / density);
    const double row = 0.5 * std::numbers::sqrt3 * pitch;
    Random random(seed, 4);
    Scene scene;
    scene.walls = Walls{
        .min = {0, 0}, .max = {(kColumns + 0.5) * pitch, (kRows - 1) * row + pitch}, .material = material};
    for (int i = 0; i < kRows; ++i)
        for (int j = 0; j < kColumns; ++j) {
            Body disc{.shape = Disc{kRadius}, .material = material};
            disc.position = {(j + (i % 2 == 0 ? 0.5 : 1)) * pitch, 0.5 * pitch + i * row};
            disc.velocity.x = kSpeed / std::numbers::sqrt2 * random.normal();
            disc.velocity.y = kSpeed / std::numbers::sqrt2 * random.normal();
            scene.add(disc);
        }
    return scene;
}

Measures gas(HardRun& run) {
    constexpr double kLargestOverlap = 0.1;  // of the radius
    EnergyRise rise(run);
    PassiveRule rule(run.scene());
    Largest overlap;
    for (int i = 0; i < 600 && run.step(); ++i) {
        rise.look(run), rule.look(run);
        if (i % 10 == 0) overlap.take(run.overlap());
    }
    Measures measures{rise.measure(), {"overlap", overlap.value(), kLargestOverlap}};
    for (const Measure& measure : rule.measures(run))
        if (measure.name != "speed/fall") measures.push_back(measure);  // in a gas some get faster
    return measures;
}

}  // namespace

Envelopes densities() {
    Envelopes all;
    for (const double restitution : {0., 0.3, 0.5, 0.7, 0.9, 0.99, 1.})
        all.push_back(
            {.name = "density",
             .title = measure::format("share of the area, a gas of 400 discs of restitution %g", restitution),
             .criterion = "in 10 s energy keeps the rule, no overlap above 10 % of the radius, none outside "
                          "or disabled",
             .range =
                 {.first = 0.1, .last = kLargestDensity, .stride = 0.13, .narrow = 0.02, .is_linear = true},
             .seeds = {1, 2},
             .make = [=](double density, std::uint64_t seed) { return gas_of(density, restitution, seed); },
             .run = [](HardRun& run, double) { return gas(run); },
             .at = restitution});
    return all;
}

}  // namespace carom::torture
