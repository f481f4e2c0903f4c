#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr int kRow = 15;
constexpr double kRadius = 0.1, kSpacing = 0.21, kJitter = 1e-3, kTime = 10;  // m, m, m, s

/// 15 × 15 discs that fall into a box a little wider than they are.
Scene lattice_of(double height, double restitution, int member) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = Walls{.min = {-0.2, 0}, .max = {kRow * kSpacing, 20}, .material = bouncy(restitution)};
    Lattice lattice;
    lattice.count_x = lattice.count_y = kRow;
    lattice.origin = {0, height + kRadius};
    lattice.spacing = {kSpacing, kSpacing};
    lattice.jitter = kJitter;
    lattice.seed = static_cast<std::uint64_t>(member) + 1;
    lattice.body = disc(kRadius, 1, {}, {}, bouncy(restitution));
    add_lattice(scene, lattice);
    return scene;
}

/// Overlaps of touching pairs, and of discs with the floor, over the radius.
void add_overlaps(const Stepper& stepper, std::vector<double>& overlaps) {
    const std::size_t count = stepper.simulation().body_count();
    std::vector<Vec2> x(count);
    for (std::size_t i = 0; i < count; ++i) x[i] = stepper.state(i).position;
    const auto add = [&](double separation) {
        if (separation < 0) overlaps.push_back(-separation / kRadius);
    };
    for (std::size_t i = 0; i < count; ++i) {
        add(x[i].y - kRadius);
        for (std::size_t j = 0; j < i; ++j)
            if (std::abs(x[i].x - x[j].x) < 2 * kRadius && std::abs(x[i].y - x[j].y) < 2 * kRadius)
                add(std::hypot(x[i].x - x[j].x, x[i].y - x[j].y) - 2 * kRadius);
    }
}

struct Overlaps {
    double rms = 0, percentile = 0;  // 99.9 %
};

Overlaps statistics_of(std::vector<double>& overlaps) {
    if (overlaps.empty()) return {};
    RootMeanSquare rms;
    for (const double overlap : overlaps) rms.add(overlap);
    const auto place = static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(overlaps.size() - 1));
    std::nth_element(overlaps.begin(), overlaps.begin() + place, overlaps.end());
    return {rms.value(), overlaps[static_cast<std::size_t>(place)]};
}

std::vector<double> run_resting(Stepper& stepper, const Scene&, int) {
    std::vector<double> overlaps;
    for (int i = 1; 0.1 * i <= kTime + 1e-9; ++i) {
        stepper.advance_to(0.1 * i);
        add_overlaps(stepper, overlaps);
    }
    const Overlaps found = statistics_of(overlaps);
    return {found.rms, found.percentile};
}

std::vector<double> run_bouncing(Stepper& stepper, const Scene&, int) {
    const double floor = kRow * kRow * kGravity * kRadius, start = stepper.energy() - floor;
    RootMeanSquare energy;
    std::vector<double> overlaps;
    for (int i = 1; 0.1 * i <= kTime + 1e-9; ++i) {
        stepper.advance_to(0.1 * i);
        energy.add((stepper.energy() - floor) / start - 1);
        add_overlaps(stepper, overlaps);
    }
    return {energy.value(), statistics_of(overlaps).percentile};
}

const std::vector<double> kSteps{0.02, 0.01, 0.004, 0.002, 0.001};

}  // namespace

Case resting_lattice() {
    return {
        .id = "A6",
        .title = "15 × 15 discs fall on each other and rest",
        .kind = "coming to rest",
        .effects = "G N",
        .exact = "hard discs never overlap; looked at every 0.1 s for 10 s",
        .errors = {{"overlap (rms)", "root mean square overlap of touching pairs, over the radius"},
                   {"overlap (99.9 %)",
                    "overlap that one in a thousand touching pairs exceeds, over the radius"}},
        .solvers = {"impulse", "soft", "pairwise"},
        .note =
            "`impulse` takes impacts one by one, and what comes to rest without restitution has no end of "
            "them: it is given up. That is why `auto` takes `soft` here.",
        .steps = kSteps,
        .scene = [](int member) { return lattice_of(0.3, 0, member); },
        .run = run_resting};
}

Case bouncing_lattice() {
    return {.id = "A7",
            .title = "15 × 15 discs bounce off each other, restitution 1, dropped from 1.1 m",
            .kind = "bouncing under gravity",
            .effects = "G N R",
            .exact = "energy constant; looked at every 0.1 s for 10 s",
            .errors = {{"energy", "root mean square change of the energy above the floor, over the first"},
                       {"overlap (99.9 %)",
                        "overlap that one in a thousand touching pairs exceeds, over the radius"}},
            .solvers = {"event", "impulse", "soft", "pairwise"},
            .steps = kSteps,
            .scene = [](int member) { return lattice_of(1.1, 1, member); },
            .run = run_bouncing};
}

}  // namespace carom::accuracy
