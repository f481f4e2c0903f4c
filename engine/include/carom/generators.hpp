#pragma once

#include <carom/scene.hpp>

#include <cstdint>
#include <optional>

namespace carom {

/// Radii drawn uniformly from [min, max].
struct RadiusRange {
    double min = 0.5;  ///< m, kSmallestRadius <= min <= max
    double max = 0.5;  ///< m, <= kLargestRadius
};

/// Bodies on a lattice, row by row from the bottom, each row from the left.
struct Lattice {
    std::int64_t count_x = 1;  ///< bodies a row, >= 1
    std::int64_t count_y = 1;  ///< rows, >= 1
    Vec2 origin{};             ///< m, centre of the first body
    Vec2 spacing{1, 1};        ///< m, from centre to centre, each >= 0
    double jitter = 0;         ///< m, >= 0: every centre moves by up to this much in x and in y
    bool stagger = false;      ///< odd rows move right by half of spacing.x: hexagonal rows
    std::optional<RadiusRange> radius_range{};  ///< in place of the radius of `body`, a disc
    double velocity_rms = 0;  ///< m/s, root mean square speed, >= 0; needs two dynamic bodies
    std::uint64_t seed = 0;
    Body body{};  ///< what every body is like; it has no name, its position is not used
};

/// Bodies on top of each other, from the lowest up: each above the next by its height, as it is turned, and
/// the gap.
struct Stack {
    std::int64_t count = 1;  ///< >= 1
    Vec2 origin{};           ///< m, centre of the lowest body
    double gap = 0;          ///< m, clear distance between neighbours, >= 0
    Body body{};             ///< what every body is like; it has no name, its position is not used
};

/// Rows of boxes, each shorter by one than the row below and on the gaps of it: base (base + 1) / 2 boxes,
/// row by row from the bottom, each row from the left.
struct Pyramid {
    std::int64_t base = 1;  ///< boxes of the bottom row, >= 1
    Vec2 origin{};          ///< m, centre of the first box
    double gap = 0;         ///< m, clear distance between neighbours in a row and between rows, >= 0
    Body body{.shape =
                  Box{}};  ///< what every box is like: not turned; it has no name, its position is not used
};

/// Discs spread over the box of the scene's walls, without overlap, in rows from the bottom. Packing
/// fractions up to 0.70 fit whatever the radii once there are some hundred discs; other bodies of the scene
/// are not looked at.
struct Gas {
    std::int64_t count = 1;   ///< >= 1
    RadiusRange radius{};     ///< m
    double velocity_rms = 0;  ///< m/s, root mean square speed, >= 0; needs two dynamic bodies
    std::uint64_t seed = 0;
    Body body{};  ///< what every disc is like; it has no name, its position and radius are not used
};

/// Bodies in a row, each joined to the next: a chain.
struct BodyChain {
    std::int64_t count = 1;            ///< >= 1
    Vec2 origin{};                     ///< m, centre of the first body
    Vec2 direction{1, 0};              ///< from each to the next, of any length but 0
    double spacing = 1;                ///< m, from centre to centre, > 0
    JointKind link = RevoluteJoint{};  ///< hinges and welds are midway between two bodies
    bool pinned = true;  ///< whether the first hangs on the world: by such a link half a spacing before it,
                         ///< by a hinge at its centre if links are rods
    Body body{};         ///< what every body is like; it has no name, its position is not used
};

/// Bodies on a square lattice, joined to their neighbours, that do not touch each other: a net or a cloth.
/// Row by row from the bottom.
struct Net {
    enum class Pinned : std::uint8_t { none, corners, top };

    std::int64_t count_x = 2;  ///< bodies a row, >= 1
    std::int64_t count_y = 2;  ///< rows, >= 1
    Vec2 origin{};             ///< m, centre of the first body
    Vec2 spacing{1, 1};        ///< m, > 0
    JointKind link = DistanceJoint{};
    Pinned pinned = Pinned::corners;  ///< which bodies are static: the two upper corners, or the top row
    Body body{};  ///< what every body is like; it has no name, its position and group are not used
};

/// Appends the bodies of a generator to a scene. The same description gives the same bits on every machine:
/// numbers come from a generator of our own, and from +, -, *, / and square roots alone.
///
/// Random velocities are normally distributed in x and in y; the root mean square of the speeds is exactly
/// velocity_rms and the total momentum zero, both to rounding. The velocity of `body` is added to all.
///
/// @return the handle of the first body; the others follow by index.
/// @throws Error naming the setting that is wrong, its value, the limit and the remedy; the scene is then
/// unchanged. Cost: O(count), O(count log count) for a dense gas of mixed radii; 1,000,000 discs take about
/// half a second.
BodyId add_lattice(Scene& scene, const Lattice& lattice);
BodyId add_stack(Scene& scene, const Stack& stack);
BodyId add_pyramid(Scene& scene, const Pyramid& pyramid);
BodyId add_gas(Scene& scene, const Gas& gas);
BodyId add_chain(Scene& scene, const BodyChain& chain);
BodyId add_net(Scene& scene, const Net& net);

/// What is wrong with a generator, with pointers as in the scene file ("/spacing/0"); nothing if all is well.
/// A gas that does not fit its box is found by `add_gas`.
std::optional<Problem> find_problem(const Lattice& lattice);
std::optional<Problem> find_problem(const Stack& stack);
std::optional<Problem> find_problem(const Pyramid& pyramid);
std::optional<Problem> find_problem(const Gas& gas, const Scene& scene);
std::optional<Problem> find_problem(const BodyChain& chain);
std::optional<Problem> find_problem(const Net& net);

}  // namespace carom
