#include "isa/make_table.hpp"

namespace carom {

extern const ConvexKernelTables kSse2ConvexKernels;
extern const KernelTables kSse2Kernels;
constexpr KernelTables kSse2Kernels = make_tables<xsimd::sse2>("sse2", kSse2ConvexKernels);

}  // namespace carom
