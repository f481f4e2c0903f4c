#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "accuracy/case.hpp"

namespace carom::accuracy {

/// A solver as the sweeps take it.
struct SweptSolver {
    Solver solver;
    std::vector<Precision> precisions;
    bool has_steps;               ///< whether its error depends on the step length
    std::vector<int> substeps;    ///< at the case's middle step; the first is the one of the other sweeps
    std::vector<int> iterations;  ///< likewise
    std::string_view why;         ///< what it is good and bad at, a sentence for the advice
};

/// All solvers, in the order in which they are listed. A new one is one line here.
std::span<const SweptSolver> swept_solvers();

/// Every setting in which a case is computed; `quick`: fewer of them.
std::vector<Setting> settings_of(const Case& asked, bool quick);

}  // namespace carom::accuracy
