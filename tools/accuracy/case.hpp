#pragma once

#include <carom/scene.hpp>

#include <span>
#include <string_view>
#include <vector>

#include "accuracy/stepper.hpp"

namespace carom::accuracy {

/// What is compared with the exact answer. Errors are relative and signed; what is shown is their size.
struct ErrorMeasure {
    std::string_view name;
    std::string_view meaning;
    /// Over perturbed starts: the size of the mean with its standard error, in place of the median size with
    /// its 10-90 % band. For averages of chaotic motion.
    bool is_statistic = false;
};

/// One case whose answer is known. Each is one file in cases/; the table of them is in cases.cpp.
struct Case {
    std::string_view id;  ///< as in docs/accuracy.md: "A5"
    std::string_view title;
    std::string_view kind;     ///< of scene, for the advice: "gas", "bouncing under gravity", ...
    std::string_view effects;  ///< "G N R": gravity, normal contact, restitution, friction, rotation, drag
    std::string_view exact;    ///< the exact answer, in words
    std::vector<ErrorMeasure> errors;       ///< charts and tables of time use the first
    std::vector<std::string_view> solvers;  ///< it makes sense for, by name
    std::string_view note{};                ///< what to know when reading its charts; may be empty
    std::vector<double> steps;              ///< s, the longest first
    int members = 1;                        ///< starts: more than 1 where motion is chaotic
    bool counts = false;  ///< whether it asks how many impacts there were, and the walls' impulse
    Scene (*scene)(int member);
    /// Takes a start to its end. @return the errors, as many as `errors`; not a number where the solver does
    /// not say what is compared, as one that counts no impacts.
    std::vector<double> (*run)(Stepper& stepper, const Scene& scene, int member);
};

/// Starts of chaotic cases, so that medians and bands mean something.
inline constexpr int kEnsemble = 32;

}  // namespace carom::accuracy
