#pragma once

#include <carom/scene.hpp>

#include <vector>

#include "torture/hard/hard_case.hpp"

namespace carom::torture {

/// Ten discs of 1 m between walls, `slack` [m] wider than they are and leaning left and right by as much.
Scene stack_between_walls(double restitution, double slack);
/// The discs stay where they were put, but for the slop of ten contacts on top of each other, at rest, in
/// their order, and energy does not grow.
Measures stack_after(HardRun& run, const std::vector<double>& steps);

}  // namespace carom::torture
