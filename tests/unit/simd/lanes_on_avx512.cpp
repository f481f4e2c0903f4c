#include "make_lane_probe.hpp"

extern const LaneProbes kLanesOnAvx512;
constexpr LaneProbes kLanesOnAvx512 = make_lane_probes<xsimd::avx512bw>("avx512");
