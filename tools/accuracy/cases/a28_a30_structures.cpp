#include <algorithm>

#include "accuracy/cases/parts.hpp"

// Structures at their threshold: one a little above it, which has to stand, beside one a little below, which
// has to fall.

namespace carom::accuracy {
namespace {

constexpr double kTime = 10;    // s
constexpr double kApart = 40;   // m, from the one that stands to the one that falls
constexpr double kFell = 0.25;  // m, by which it is lower when it has

constexpr int kBlocks = 10;
constexpr double kLength = 1, kThick = 0.25, kOverhangs = 0.99, kOverturns = 1.01;  // m, m, of the limit

constexpr double kLadder = 4, kRung = 0.05, kLeans = 1;  // m, m, rad
constexpr double kHolds = 1.03, kSlips = 0.97;           // of the least friction

constexpr int kStones = 31;
constexpr double kRadius = 5, kThickArch = 0.115, kThinArch = 0.100;  // m, over the radius

Scene under_gravity() {
    Scene scene;
    scene.gravity = {0, -kGravity};
    return scene;
}

/// Blocks on a table whose edge is at x, each beyond the one below by a share of the most that can stand.
void add_overhang(Scene& scene, double x, double share) {
    constexpr double kFriction = 0.6;
    scene.add(block(10, 10, {x - 5, -5}, 0, kFriction));
    double edge = x;
    for (int k = kBlocks, row = 0; k >= 1; --k, ++row) {
        edge += share * kLength / (2.0 * k);
        scene.add(box(kLength, kThick, {edge - 0.5 * kLength, (row + 0.5) * kThick}, 0, kFriction));
    }
}

Scene overhangs(int) {
    Scene scene = under_gravity();
    add_overhang(scene, 0, kOverhangs), add_overhang(scene, kApart, kOverturns);
    return scene;
}

/// A ladder between the ground and a smooth wall at x.
void add_ladder(Scene& scene, double x, double share) {
    // Its corners touch, so the weight is half a thickness nearer to the foot.
    const double friction = share * (0.5 / std::tan(kLeans) - 0.5 * kRung / kLadder);
    scene.add(ground(x - 15, x + 2, friction));
    scene.add(block(2, 20, {x + 1, 10}, 0, 0));
    const double c = std::cos(kLeans), s = std::sin(kLeans);
    scene.add(box(kLadder, kRung, {x - 0.5 * (kLadder * c + kRung * s), 0.5 * (kLadder * s + kRung * c)},
                  kLeans, friction));
}

Scene ladders(int) {
    Scene scene = under_gravity();
    add_ladder(scene, 0, kHolds), add_ladder(scene, kApart, kSlips);
    return scene;
}

/// Stones of one angle each in a half circle about x.
void add_arch(Scene& scene, double x, double thickness) {
    constexpr double kFriction = 1;
    scene.add(ground(x - 15, x + 15, kFriction));
    for (int i = 0; i < kStones; ++i) {
        Polygon stone;
        for (const int side : {0, 1})
            for (const int face : {0, 1}) {
                const double angle = std::numbers::pi * (i + side) / kStones;
                const double r = kRadius * (1 + (face == side ? -0.5 : 0.5) * thickness);
                stone.vertices.push_back({r * std::cos(angle), r * std::sin(angle)});
            }
        const Vec2 centre = mass_properties_of(stone).centroid;
        scene.add(box(1, 1, {x + centre.x, centre.y}, 0, kFriction));
        scene.bodies.back().shape = std::move(stone);
    }
}

Scene arches(int) {
    Scene scene = under_gravity();
    add_arch(scene, 0, kThickArch), add_arch(scene, kApart, kThinArch);
    return scene;
}

/// Farthest that a body of the first structure has moved, over `length`; 0 if a body of the second fell.
std::vector<double> run_pair(Stepper& stepper, const Scene& scene, double length) {
    stepper.advance_to(kTime);
    double moved = 0, fell = 0;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Vec2 at = stepper.state(i).position, start = scene.bodies[i].position;
        if (i < scene.bodies.size() / 2)
            moved = std::max(moved, distance(at, start) / length);
        else
            fell = std::max(fell, start.y - at.y);
    }
    return {moved, fell > kFell ? 0.0 : 1.0};
}

Case structure(std::string_view id, std::string_view title, std::string_view exact, std::string_view over) {
    return {.id = id,
            .title = title,
            .kind = "structures at their threshold",
            .effects = "G N F W",
            .exact = exact,
            .errors = {{"creep", over}, {"falls", "0 if the one that has to fall did, 1 if it stands"}},
            .solvers = {"soft"},
            .steps = steps_of_structures(),
            .scene = nullptr,
            .run = nullptr};
}

}  // namespace

Case harmonic_overhang() {
    Case overhang = structure("A28", "Ten blocks that hang over, 1 % less and 1 % more than what stands",
                              "a pile stands up to an overhang of (l/2) Σ 1/k; after 10 s",
                              "farthest way of a block of the one that stands, over a block's length");
    overhang.scene = overhangs;
    overhang.run = [](Stepper& stepper, const Scene& scene, int) {
        return run_pair(stepper, scene, kLength);
    };
    return overhang;
}

Case leaning_ladder() {
    Case ladder = structure("A29", "Ladders on a smooth wall, friction 3 % more and 3 % less than what holds",
                            "a ladder stands if μ ≥ cot(θ)/2 - t/(2 l), t its thickness; after 10 s",
                            "way of the one that stands, over its length");
    ladder.scene = ladders;
    ladder.run = [](Stepper& stepper, const Scene& scene, int) { return run_pair(stepper, scene, kLadder); };
    return ladder;
}

Case arch() {
    Case arch = structure("A30", "Half-circle arches of 31 stones, thickness over radius 0.115 and 0.100",
                          "an arch stands if its thickness is 0.1075 R or more; after 10 s",
                          "farthest way of a stone of the one that stands, over the radius");
    arch.scene = arches;
    arch.run = [](Stepper& stepper, const Scene& scene, int) { return run_pair(stepper, scene, kRadius); };
    return arch;
}

}  // namespace carom::accuracy
