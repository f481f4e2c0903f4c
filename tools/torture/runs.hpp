#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "torture/case.hpp"

// What several cases share: solvers and precisions to run, discs, walls.

namespace carom::torture {

inline constexpr double kGravity = 9.81;  // m/s²

/// The solvers asked for, or these.
inline std::vector<Solver> solvers_of(const Options& asked, std::initializer_list<Solver> otherwise) {
    return asked.solvers.empty() ? std::vector<Solver>(otherwise) : asked.solvers;
}

inline std::vector<Precision> precisions_of(const Options& asked) {
    if (asked.precision) return {*asked.precision};
    return {Precision::single_, Precision::double_};
}

inline std::string name_of(Precision precision) {
    return precision == Precision::single_ ? "float" : "double";
}

/// Calls fn(index) for each random scene asked for: the only one, or so many from the first on.
template <class Fn>
void for_each_scene(const Options& asked, std::int64_t otherwise, const Fn& fn) {
    const std::int64_t first = asked.only.value_or(0),
                       last = asked.only ? first + 1 : asked.scenes.value_or(otherwise);
    for (std::int64_t index = first; index < last; ++index) fn(static_cast<std::uint64_t>(index));
}

inline Material material_of(double restitution, double friction = 0) {
    Material material;
    material.restitution = restitution, material.friction = friction;
    return material;
}

inline Body disc_of(double radius, Vec2 position, Vec2 velocity, const Material& material) {
    Body body;
    body.shape = Disc{radius};
    body.position = position, body.velocity = velocity, body.material = material;
    return body;
}

}  // namespace carom::torture
