#include "isa/make_convex_tables.hpp"

namespace carom {

extern const ConvexKernelTables kSse2ConvexKernels;
constexpr ConvexKernelTables kSse2ConvexKernels = make_convex_tables<xsimd::sse2>();

}  // namespace carom
