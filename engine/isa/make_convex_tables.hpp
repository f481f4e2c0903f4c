#pragma once

#include "isa/convex_kernels.hpp"
#include "kernels/broadphase/drop_parted.hpp"
#include "kernels/manifolds/find_approached.hpp"
#include "kernels/manifolds/find_manifolds.hpp"
#include "kernels/manifolds/question_gaps.hpp"
#include "kernels/manifolds/turn_angles.hpp"
#include "kernels/manifolds/watch_poses.hpp"
#include "kernels/paths/find_fast.hpp"
#include "kernels/paths/find_thrown.hpp"
#include "kernels/paths/path_loads.hpp"
#include "kernels/paths/solve_paths.hpp"
#include "kernels/paths/sweep_paths.hpp"
#include "kernels/paths/warm_start_paths.hpp"
#include "kernels/paths/watch_paths.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

template <class Real, class Isa>
constexpr ConvexKernels<Real> make_convex_kernels() {
    return {.find_manifolds = &find_manifolds<Real, Isa>,
            .find_box_manifolds = &find_box_manifolds<Real, Isa>,
            .turn_angles = &turn_angles<Isa>,
            .question_gaps = &question_gaps<Real, Isa>,
            .watch_poses = &watch_poses<Real, Isa>,
            .find_approached = &find_approached<Real, Isa>,
            .drop_parted = &drop_parted<Real, Isa>,
            .find_thrown = &find_thrown<Real, Isa>,
            .paths = {&carry_paths<Real, Isa>, &warm_start_paths<Real, Isa>, &solve_paths<Real, Isa>,
                      &sweep_all_paths<Real, Isa>, &watch_paths<Real, Isa, true>,
                      &watch_paths<Real, Isa, false>, &settle_watched<Real>, &sum_path_loads<Real, Isa>,
                      &scale_path_loads<Real, Isa>, &retain_path_loads<Real, Isa>, &find_fast<Real, Isa>}};
}

/// The kernels of convex shapes, instantiated for each instruction set by its file.
template <class Isa>
constexpr ConvexKernelTables make_convex_tables() {
    return {make_convex_kernels<float, Isa>(), make_convex_kernels<double, Isa>()};
}

}  // namespace
}  // namespace carom
