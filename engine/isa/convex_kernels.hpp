#pragma once

#include "kernels/broadphase/broadphase_arguments.hpp"
#include "kernels/manifolds/manifold_arguments.hpp"
#include "kernels/paths/path_arguments.hpp"

namespace carom {

/// The kernels that solve contacts along paths, of bundles first ... last.
template <class Real>
struct PathKernels {
    using Pass = PathCounts (*)(const SolvePaths<Real>&, std::size_t first, std::size_t last);
    Pass carry, warm_start, solve, sweep;
    Pass watch, watch_again, settle;  // of contacts beside the paths; watch_again has the floors of watch
    Pass sum_loads, scale_loads, retain_loads;
    Pass find_fast;
};

/// The kernels of convex shapes of one instruction set in one precision. They are compiled in files of their
/// own (<isa>_convex.cpp), so that what the compiler inlines there changes nothing for discs.
template <class Real>
struct ConvexKernels {
    using Find = std::size_t (*)(const FindManifolds<Real>&, std::size_t first, std::size_t last);
    Find find_manifolds;      // of any convex shapes
    Find find_box_manifolds;  // of boxes, see is_box() in narrowphase/box_box.hpp
    void (*turn_angles)(const double* angles, double* cosines, double* sines);     // of a block, in rad
    std::uint32_t (*question_gaps)(const QuestionGaps<Real>&, std::size_t first);  // of a block
    bool (*watch_poses)(const WatchPoses<Real>&, std::size_t first, std::size_t last);
    std::size_t (*find_approached)(const FindApproached<Real>&, std::size_t first, std::size_t last);
    std::size_t (*drop_parted)(const DropParted<Real>&);
    bool (*find_thrown)(const FindThrown<Real>&, std::size_t first, std::size_t last);
    PathKernels<Real> paths;
};

struct ConvexKernelTables {
    ConvexKernels<float> single_precision;
    ConvexKernels<double> double_precision;
};

}  // namespace carom
