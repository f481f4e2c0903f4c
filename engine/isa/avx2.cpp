#include "isa/make_table.hpp"

namespace carom {

extern const ConvexKernelTables kAvx2ConvexKernels;
extern const KernelTables kAvx2Kernels;
constexpr KernelTables kAvx2Kernels = make_tables<xsimd::avx2>("avx2", kAvx2ConvexKernels);

}  // namespace carom
