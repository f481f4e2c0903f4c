#pragma once

#include "constraints/contact_graph.hpp"
#include "constraints/contact_rows.hpp"
#include "solvers/soft/contacts/contact_settings.hpp"
#include "solvers/substeps/body_records.hpp"
#include "solvers/substeps/step_terms.hpp"

namespace carom {

/// The step that the parts of solver `soft` work on: its contacts, its bodies, and what holds for all of
/// them. SoftSolver owns what is referred to.
template <class Real>
struct StepView {
    ContactGraph<Real>& graph;    ///< all that may come to touch; pairs are solved where they stand in it
    ContactRows<Real>& supports;  ///< those of graph.supports that can touch in this step
    BodyRecords<Real>& records;
    const ContactSettings& settings;
    const SubstepTerms& terms;
    const StepLoops<Real>& loops;
};

}  // namespace carom
