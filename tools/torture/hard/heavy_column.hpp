#pragma once

#include <carom/scene.hpp>

#include "torture/hard/discs.hpp"
#include "torture/hard/hard_case.hpp"

namespace carom::torture {

/// A heavy disc on light ones of 1 kg in a shaft.
struct HeavyColumn {
    int light = 1;
    double ratio = 10;  ///< mass of the one on top
    double drop = 0;    ///< m, from how high above them it starts
    double friction = 0;
};

Scene scene_of(const HeavyColumn& column);
/// How deep the heavy one ever sinks in ten seconds, in diameters; it never passes one of them.
Measures sink_in(HardRun& run, const HeavyColumn& column, double mark);

/// A box on `light` ones of 1 kg on each other, all with sides of 1 m.
Scene box_on_boxes(int light, double ratio);
Measures sink_of_box(HardRun& run);

}  // namespace carom::torture
