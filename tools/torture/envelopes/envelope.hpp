#pragma once

#include <carom/scene.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "torture/envelopes/bracket.hpp"
#include "torture/hard/hard_case.hpp"

namespace carom::torture {

/// One thing that gets harder: a value holds if all measures keep their marks, for every seed.
struct Envelope {
    std::string name;       ///< for the command line, too: "mass-ratio"
    std::string title;      ///< "mass of a disc over that of the one it lies on"
    std::string criterion;  ///< in words
    Range range;
    std::vector<std::uint64_t> seeds;
    std::function<Scene(double value, std::uint64_t seed)> make;
    std::function<Measures(HardRun& run, double value)> run;
    std::optional<double> at{};  ///< of those with one name: where on the axis of their chart
};

using Envelopes = std::vector<Envelope>;

Envelopes heights();
Envelopes mass_ratios();
Envelopes step_lengths();
Envelopes size_ratios();
Envelopes speeds();
Envelopes densities();
Envelopes distances();

/// All of them.
Envelopes all_envelopes();

}  // namespace carom::torture
