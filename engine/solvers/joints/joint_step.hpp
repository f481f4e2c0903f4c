#pragma once

#include "solvers/joints/spring_loads.hpp"
#include "solvers/substeps/body_records.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/world_state.hpp"

namespace carom {

/// The radius of the disc that has a body's mass and inertia, sqrt(2 I / m) [m]: what rim speeds refer to.
template <class Real>
double rim_of(const Bodies<Real>& bodies, std::size_t row) {
    return static_cast<double>(bodies.rim(row));
}

/// What a moment turns a body by [1/(kg m²)]; 0: nothing turns it.
template <class Real>
double inverse_inertia_of(const Bodies<Real>& bodies, std::size_t row) {
    if (!bodies.has_rotation || (bodies.flags_of(row) & kFixedAngle) != 0) return 0;
    const double rim = rim_of(bodies, row);
    return 2 * bodies.inverse_mass(row) / (rim * rim);
}

/// What the joints are told of a step.
template <class Real>
struct JointStep {
    WorldState<Real>& world;
    BodyRecords<Real>& records;
    const SubstepTerms& terms;
    double& gravity_work;        ///< J, of this step, on velocities: solvers/soft/books.hpp
    const SpringLoads& springs;  ///< that are too stiff together
};

}  // namespace carom
