#pragma once

#include <carom/accuracy.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace carom::torture {

/// What the command line asks of the cases; what is left out is the case's own.
struct Options {
    std::optional<std::int64_t> scenes{};  ///< random scenes of `passive`, random worlds of `random`
    std::uint64_t seed = 1;                ///< of random scenes
    std::optional<std::int64_t> only{};    ///< the one random scene of that index
    std::optional<std::int64_t> steps{};   ///< of each run
    std::optional<std::int64_t> bodies{};  ///< of a crowd; of random scenes: at most
    std::vector<Solver> solvers{};         ///< empty: those that a case asks for
    std::optional<Precision> precision{};
    std::vector<std::string> rows{};  ///< codes of `hard`, names of `envelopes`; empty: all
    bool has_joints = true;           ///< `random`: else lone bodies are in place of mechanisms
    bool is_quick = false;            ///< `hard` and `envelopes` do a part
    double limit = 20;  ///< s of processor time: a run that takes longer is given up, and has failed
};

}  // namespace carom::torture
