#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "torture/case.hpp"

// What several cases share: solvers and precisions to run, discs, walls.

namespace carom::torture {

inline constexpr double kGravity = 9.81;  // m/s²

/// The solvers asked for, or these.
inline std::vector<Solver> solvers_of(const Options& asked, const std::vector<Solver>& otherwise) {
    return asked.solvers.empty() ? otherwise : asked.solvers;
}

/// Those that a scene is for: `rattle` has no contacts, and nothing to do without joints.
inline std::vector<Solver> every_solver_for(const Scene& scene) {
    std::vector<Solver> all{Solver::automatic, Solver::soft, Solver::impulse, Solver::event};
    if (!scene.joints.empty()) all.push_back(Solver::rattle);
    all.push_back(Solver::pairwise);
    return all;
}

/// Whether a row of the matrix, or an envelope, is among those asked for.
inline bool is_named(const Options& asked, const std::string& row) {
    return asked.rows.empty() || std::find(asked.rows.begin(), asked.rows.end(), row) != asked.rows.end();
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
