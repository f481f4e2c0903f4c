#include "make_lane_probe.hpp"

extern const LaneProbes kLanesOnAvx2;
constexpr LaneProbes kLanesOnAvx2 = make_lane_probes<xsimd::avx2>("avx2");
