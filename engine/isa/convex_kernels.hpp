#pragma once

#include "kernels/manifold_arguments.hpp"

namespace carom {

/// The kernels of convex shapes of one instruction set in one precision. They are compiled in files of their
/// own (<isa>_convex.cpp), so that what the compiler inlines there changes nothing for discs.
template <class Real>
struct ConvexKernels {
    using Find = std::size_t (*)(const FindManifolds<Real>&, std::size_t first, std::size_t last);
    Find find_manifolds;  // of any convex shapes
};

struct ConvexKernelTables {
    ConvexKernels<float> single_precision;
    ConvexKernels<double> double_precision;
};

}  // namespace carom
