#include "make_lane_probe.hpp"

extern const LaneProbes kLanesOnScalar;
constexpr LaneProbes kLanesOnScalar = make_lane_probes<carom::simd::Scalar>("scalar");
