#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "accuracy/results.hpp"

namespace carom::accuracy {

/// Errors that a table says the time for.
inline constexpr std::array kTargets{1e-2, 1e-3, 1e-4};

/// A solver or another engine, in one precision.
struct Contender {
    std::string name;
    Precision precision;

    friend bool operator==(const Contender&, const Contender&) = default;
};
std::string in_words(const Contender& contender);

/// Those that a case has points of, in the order of the points.
std::vector<Contender> contenders_in(const CaseResult& result);

/// How the error falls with the step: it goes as step^order, from the longest step until it stops falling.
struct Order {
    double order = 0;
    double from = 0, to = 0;  ///< s, the steps it was fitted over
};
/// Nothing if the error does not fall over three steps: round-off, or no convergence.
std::optional<Order> observed_order(const CaseResult& result, const Contender& contender, std::size_t error);

/// Where an error comes from, for what has a residual: the step with all the work that is swept, the work at
/// one step, and what is left where both are at their end - softness, round-off, or too long a step still.
struct Sources {
    struct Part {
        double dt = 0;  ///< s
        int substeps = 1, iterations = 1;
        double error = 0;
    };
    std::vector<Part> step;      ///< longest step first, with the most work
    std::vector<Part> residual;  ///< at the middle step, least work first
};
/// Nothing if there are fewer than two points of either sweep.
std::optional<Sources> sources_of(const CaseResult& result, const Contender& contender, std::size_t error);

/// The cheapest point of a contender whose first error is at most `target`, of a statistic with its standard
/// error; null if none is.
const Point* cheapest(const CaseResult& result, const Contender& contender, double target);
/// The same of all.
const Point* cheapest(const CaseResult& result, double target);

/// Points than which none is both faster and nearer the exact answer.
std::vector<const Point*> frontier_of(const CaseResult& result);

/// Which solver to choose for which kind of scene and why, in words, from what was measured.
std::vector<std::string> advice_from(const std::vector<CaseResult>& results);

}  // namespace carom::accuracy
