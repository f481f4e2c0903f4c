#pragma once

#include <carom/scene.hpp>

namespace carom::torture {

/// A disc with a mass of its own [m, kg].
inline Body heavy_disc(double radius, double mass, Vec2 position, const Material& material = {}) {
    return {.shape = Disc{radius}, .position = position, .mass = mass, .material = material};
}

/// A shaft hardly wider than the discs in it, open at the top.
inline Walls shaft_of(double radius, const Material& material = {}) {
    constexpr double kPlay = 1.001, kHeight = 100;  // of the radius; m
    return {
        .min = {-kPlay * radius, 0}, .max = {kPlay * radius, kHeight}, .top = false, .material = material};
}

}  // namespace carom::torture
