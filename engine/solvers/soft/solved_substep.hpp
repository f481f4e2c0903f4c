#pragma once

#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "solvers/soft/joints/soft_joints.hpp"

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
