#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace carom::torture {

/// On which side of its mark a number passes.
enum class Sense { at_most, at_least };

/// A number that a run gave and, where there is one, the mark that it has to keep.
struct Measure {
    std::string name;
    double value = 0;
    std::optional<double> mark{};  ///< none: the number is told, and passes whatever it is
    Sense sense = Sense::at_most;

    bool passes() const {  // not a number fails
        return !mark || (sense == Sense::at_least ? value >= *mark : value <= *mark);
    }
    /// What share of its mark the number takes up: 1 at the mark, more beyond it; infinite where the mark is
    /// 0 and the number is not, or there is no number.
    double share() const {
        if (!mark || std::isnan(value)) return mark ? std::numeric_limits<double>::infinity() : 0;
        const double share = sense == Sense::at_least ? *mark / std::fmax(value, 0) : value / *mark;
        return std::isnan(share) ? 0 : std::fmax(share, 0);  // 0 / 0 is a mark of 0 that is kept
    }
};

/// Where a solver stops holding as one thing gets harder and harder.
struct Bracket {
    std::optional<double> holds{};  ///< the hardest that held; none: not even the easiest did
    std::optional<double> fails{};  ///< the easiest above it that did not; none: it holds as far as was asked
    std::string reason{};           ///< what failed there
    bool is_out_of_time = false;    ///< the budget was used up before the bracket was narrow
    int runs = 0;
};

enum class Status {
    ran,
    refused,  ///< by the solver; `failure` says why
    as_auto,  ///< this solver is what `auto` takes: it was run there
};

/// What a run gave.
struct Outcome {
    std::vector<Measure> measures{};
    std::string failure{};  ///< empty, or why the run did not end, or what else is wrong
    Status status = Status::ran;
    std::optional<Bracket> bracket{};  ///< of an envelope

    bool passes() const {
        for (const Measure& measure : measures)
            if (!measure.passes()) return false;
        return failure.empty();
    }
};

/// One line of the result: a scene under a solver.
struct Row {
    std::string case_id, scene, solver, precision;
    Outcome outcome{};

    bool has_run() const { return outcome.status == Status::ran; }
    bool has_failed() const { return has_run() && !outcome.passes(); }
};

}  // namespace carom::torture
