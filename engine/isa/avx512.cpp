#include "isa/make_table.hpp"

namespace carom {

extern const ConvexKernelTables kAvx512ConvexKernels;
extern const KernelTables kAvx512Kernels;
constexpr KernelTables kAvx512Kernels = make_tables<xsimd::avx512bw>("avx512", kAvx512ConvexKernels);

}  // namespace carom
