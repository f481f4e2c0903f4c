#include "make_lane_probe.hpp"

extern const LaneProbes kLanesOnSse2;
constexpr LaneProbes kLanesOnSse2 = make_lane_probes<xsimd::sse2>("sse2");
