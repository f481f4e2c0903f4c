#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "torture/options.hpp"
#include "torture/outcome.hpp"

namespace carom::torture {

/// A run, described before it runs, so that one that never ends has a name.
struct Task {
    std::string case_id, scene, solver, precision;
    std::function<Outcome()> run;
};

/// Scenes that break engines, each under several solvers, with marks. Each is a file in cases/; the table of
/// them is in cases.cpp.
struct Case {
    std::string_view id;
    std::string_view title;
    bool is_summed_up = false;  ///< printed as one line a solver, with the failing rows in full
    bool is_matrix = false;     ///< a column a solver; what a solver refuses is a cell that says so
    std::vector<Task> (*tasks)(const Options& asked);
};

Case passive();
Case random_worlds();
Case drop();
Case rest();
Case impacts();
Case hard();
Case envelopes();

/// All of them, in order. A new case is a file, a line above and a line in cases.cpp.
std::span<const Case> all_cases();

}  // namespace carom::torture
