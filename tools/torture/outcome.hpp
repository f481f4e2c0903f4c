#pragma once

#include <optional>
#include <string>
#include <vector>

namespace carom::torture {

/// A number that a run gave and, where there is one, the largest that passes.
struct Measure {
    std::string name;
    double value = 0;
    std::optional<double> mark{};  ///< none: the number is told, and passes whatever it is

    bool passes() const { return !mark || value <= *mark; }  // not a number fails
};

/// What a run gave.
struct Outcome {
    std::vector<Measure> measures{};
    std::string failure{};    ///< empty, or why the run did not end, or what else is wrong
    bool is_skipped = false;  ///< the solver refuses the scene, or another run is the same one
};

/// One line of the result: a scene under a solver.
struct Row {
    std::string case_id, scene, solver, precision;
    Outcome outcome{};

    bool passes() const {
        for (const Measure& measure : outcome.measures)
            if (!measure.passes()) return false;
        return outcome.failure.empty();
    }
};

}  // namespace carom::torture
