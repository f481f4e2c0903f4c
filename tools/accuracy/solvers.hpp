#pragma once

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

#include "accuracy/case.hpp"

namespace carom::accuracy {

/// A solver, or another engine, as the sweeps take it.
struct SweptSolver {
    Solver solver;
    std::vector<Precision> precisions;
    bool has_steps;               ///< whether its error depends on the step length
    std::vector<int> substeps;    ///< at the case's middle step; the first is the one of the other sweeps
    std::vector<int> iterations;  ///< likewise
    std::string why;              ///< what it is good and bad at, a sentence for the advice
    bool has_residual = false;    ///< whether substeps or iterations leave something unsolved
    std::string engine{};         ///< another engine, in place of the solver

    int most_substeps() const { return *std::max_element(substeps.begin(), substeps.end()); }
    int most_iterations() const { return *std::max_element(iterations.begin(), iterations.end()); }
    std::string name() const { return engine.empty() ? std::string(name_of(solver)) : engine; }
};

/// All solvers, in the order in which they are listed, then the other engines there are. A new one is one
/// line.
std::span<const SweptSolver> swept_solvers();

/// Engines that a case is not computed with, and why.
struct LeftOut {
    std::string engine, why;
};
std::vector<LeftOut> left_out_of(const Case& asked);

/// Every setting in which a case is computed; `quick`: fewer of them.
std::vector<Setting> settings_of(const Case& asked, bool quick);

}  // namespace carom::accuracy
