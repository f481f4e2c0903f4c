#pragma once

#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/joints/soft_joints.hpp"
#include "solvers/soft/step_view.hpp"

namespace carom {

/// What was solved in a substep.
template <class Real>
struct SolvedSubstep {
    const JointStep<Real>& step;
    const StepView<Real>& contacts;
    PathSolver<Real>& paths;
    SoftJoints<Real>& joints;
};

}  // namespace carom
