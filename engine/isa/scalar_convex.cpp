#include "isa/make_convex_tables.hpp"

namespace carom {

extern const ConvexKernelTables kScalarConvexKernels;
constexpr ConvexKernelTables kScalarConvexKernels = make_convex_tables<simd::Scalar>();

}  // namespace carom
