#include "isa/make_convex_tables.hpp"

namespace carom {

extern const ConvexKernelTables kAvx512ConvexKernels;
constexpr ConvexKernelTables kAvx512ConvexKernels = make_convex_tables<xsimd::avx512bw>();

}  // namespace carom
