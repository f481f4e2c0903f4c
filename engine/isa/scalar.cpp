#include "isa/make_table.hpp"

namespace carom {

extern const ConvexKernelTables kScalarConvexKernels;
extern const KernelTables kScalarKernels;
constexpr KernelTables kScalarKernels = make_tables<simd::Scalar>("scalar", kScalarConvexKernels);

}  // namespace carom
