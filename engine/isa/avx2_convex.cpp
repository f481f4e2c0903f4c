#include "isa/make_convex_tables.hpp"

namespace carom {

extern const ConvexKernelTables kAvx2ConvexKernels;
constexpr ConvexKernelTables kAvx2ConvexKernels = make_convex_tables<xsimd::avx2>();

}  // namespace carom
