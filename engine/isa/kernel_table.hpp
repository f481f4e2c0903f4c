#pragma once

#include "kernels/broadphase_arguments.hpp"

#include <string_view>

namespace carom {

/// The kernels of one instruction set in one precision. A new kernel: an argument struct in kernels/, a line
/// here, a line in make_table.hpp.
template <class Real>
struct KernelTable {
    std::string_view isa;  // "scalar", "sse2", "avx2", "avx512": the value CAROM_ISA takes
    void (*find_bounds)(FindBounds<Real>&);
    void (*find_cells)(const FindCells<Real>&);
    std::size_t (*find_candidates)(FindCandidates<Real>&);
    std::size_t (*find_near)(const GridLevel<Real>&, const FindNear<Real>&);
};

struct KernelTables {
    KernelTable<float> single_precision;
    KernelTable<double> double_precision;

    template <class Real>
    const KernelTable<Real>& of() const {
        if constexpr (sizeof(Real) == sizeof(float))
            return single_precision;
        else
            return double_precision;
    }
};

}  // namespace carom
