#pragma once

#include <carom/scene.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>

// Scenes of boxes and polygons.

namespace carom::torture {

inline constexpr double kBoxGravity = 9.81;  // m/s²

/// A world under gravity with a flat static box as its ground; its top is y = 0.
inline Scene box_ground(double friction, double half_width = 50) {
    Scene scene;
    scene.gravity = {0, -kBoxGravity};
    scene.add({.type = BodyType::static_body,
               .shape = Box{2 * half_width, 10},
               .position = {0, -5},
               .material = {.friction = friction}});
    return scene;
}

inline Body box_at(double x, double y, double width, double height, double friction, double angle = 0) {
    return {
        .shape = Box{width, height}, .position = {x, y}, .angle = angle, .material = {.friction = friction}};
}

/// Numbers of [-1, 1], the same on every machine.
inline double jitter_of(std::uint64_t number) {
    std::uint64_t z = number + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) % 2001) / 1000 - 1;
}

/// A tower of unit boxes, each up to `offset` [m] aside.
inline Scene tower(int boxes, double offset, std::uint64_t seed, double friction = 0.6) {
    Scene scene = box_ground(friction);
    for (int i = 0; i < boxes; ++i)
        scene.add(box_at(offset * jitter_of(seed + static_cast<std::uint64_t>(i)), i + 0.5, 1, 1, friction));
    return scene;
}

/// Rows of unit boxes, `base` at the bottom, gaps of `gap` [m] between them.
inline Scene box_pyramid(int base, double gap = 0.05, double friction = 0.6) {
    Scene scene = box_ground(friction, 3.0 * base);
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            scene.add(box_at((i - (base - row - 1) / 2.0) * (1 + gap), row + 0.5, 1, 1, friction));
    return scene;
}

/// Blocks 1 m long, each jutting out over the one below by `share` of the most that can stand:
/// 1 / (2 k) m for the k-th from the top. The table's edge is x = 0.
inline Scene overhang(int blocks, double share, double friction = 0.6) {
    Scene scene;
    scene.gravity = {0, -kBoxGravity};
    scene.add({.type = BodyType::static_body,
               .shape = Box{10, 10},
               .position = {-5, -5},
               .material = {.friction = friction}});
    double edge = 0;
    for (int k = blocks, row = 0; k >= 1; --k, ++row) {
        edge += share / (2.0 * k);
        scene.add(box_at(edge - 0.5, 0.25 * row + 0.125, 1, 0.25, friction));
    }
    return scene;
}

/// Voussoirs of one angle each in a half circle, whose middle line has the radius 5 m.
inline Scene arch(double thickness_over_radius, int voussoirs) {
    const double friction = 1, radius = 5, half = 0.5 * thickness_over_radius * radius;
    Scene scene = box_ground(friction);
    for (int i = 0; i < voussoirs; ++i) {
        Polygon stone;
        for (const int side : {0, 1})
            for (const int face : {0, 1}) {
                const double angle = std::numbers::pi * (i + side) / voussoirs;
                const double r = radius + (face == side ? -half : half);
                stone.vertices.push_back({r * std::cos(angle), r * std::sin(angle)});
            }
        scene.add({.shape = stone,
                   .position = mass_properties_of(stone).centroid,
                   .material = {.friction = friction}});
    }
    return scene;
}

/// Three storeys of pairs of cards 1 m long that lean on each other at `slope` [rad] to the ground, a card
/// flat on each storey but the last.
inline Scene card_house(double slope, double friction) {
    const double thickness = 0.05, apart = 1.02, c = std::cos(slope), s = std::sin(slope);
    Scene scene = box_ground(friction);
    double floor = 0;
    for (int pairs = 3; pairs >= 1; --pairs) {
        const double middle = floor + 0.5 * (s + thickness * c), aside = 0.5 * (c + thickness * s);
        for (int i = 0; i < pairs; ++i)
            for (const double side : {-1.0, 1.0})
                scene.add(box_at((i - 0.5 * (pairs - 1)) * apart + side * aside, middle, 1, thickness,
                                 friction, -side * slope));
        floor += s + thickness * c;
        if (pairs == 1) break;
        scene.add(box_at(0, floor + 0.5 * thickness, (pairs - 1) * apart + 0.3, thickness, friction));
        floor += thickness;
    }
    return scene;
}

}  // namespace carom::torture
